// Sums that do not depend on the thread count: fixed blocks are summed in parallel, the blocks' sums in order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace sim {

// Sum of term(i) for i in [0, count), the same for any number of threads. `zero`: of the sum's type, a number or an array of them.
template <class Sum, class Term>
Sum ordered_total(std::size_t count, const Sum& zero, Term&& term) {
  constexpr std::size_t block = 2048;
  const std::ptrdiff_t blocks = static_cast<std::ptrdiff_t>((count + block - 1) / block);
  std::vector<Sum> partial(static_cast<std::size_t>(blocks), zero);
#pragma omp parallel for schedule(static) if (blocks > 4)
  for (std::ptrdiff_t b = 0; b < blocks; ++b) {
    const std::size_t end = std::min(count, (static_cast<std::size_t>(b) + 1) * block);
    Sum sum = zero;
    for (std::size_t i = static_cast<std::size_t>(b) * block; i < end; ++i) sum += term(i);
    partial[static_cast<std::size_t>(b)] = sum;
  }
  Sum total = zero;
  for (const Sum& sum : partial) total += sum;
  return total;
}
template <class Term>
double ordered_sum(std::size_t count, Term&& term) {
  return ordered_total(count, 0.0, term);
}

// Largest of value(i), at least `floor`.
template <class Value>
double largest(std::size_t count, double floor, Value&& value) {
  double result = floor;
#pragma omp parallel for schedule(static) reduction(max : result) if (count > 8192)
  for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(count); ++i) {
    const double v = value(static_cast<std::size_t>(i));
    if (v > result) result = v;
  }
  return result;
}

}  // namespace sim
