#include "sim/work_memory.h"

#include <stdexcept>

namespace sim {
namespace {

template <int D>
std::vector<double> flat(const std::vector<Vector<D>>& points) {
  std::vector<double> values;
  values.reserve(points.size() * D);
  for (const Vector<D>& point : points) values.insert(values.end(), point.data(), point.data() + D);
  return values;
}

// Empty where the array is missing or empty.
template <int D>
std::vector<Vector<D>> points(const NamedNumbers& memory, const char* name, std::int64_t rows) {
  const auto found = memory.find(name);
  if (found == memory.end() || found->second.empty()) return {};
  if (found->second.size() != static_cast<std::size_t>(rows) * D)
    throw std::runtime_error(std::string("the checkpoint's ") + name + " belongs to another scene; start the run again without --continue");
  std::vector<Vector<D>> result(static_cast<std::size_t>(rows));
  for (std::size_t i = 0; i < result.size(); ++i)
    for (int axis = 0; axis < D; ++axis) result[i][axis] = found->second[i * D + static_cast<std::size_t>(axis)];
  return result;
}

double number(const NamedNumbers& memory, const char* name) {
  const auto found = memory.find(name);
  return found == memory.end() || found->second.empty() ? 0 : found->second.front();
}

}  // namespace

template <int D>
NamedNumbers work_memory(const Workspace<D>& work) {
  NamedNumbers memory;
  memory["coupling_factor_place"] = flat<D>(work.solid_operator.factorised_at());
  memory["coupling_factor_scale"] = {work.solid_operator.factorised_for()};
  memory["coupling_factor_step"] = {work.solid_factor_step};
  memory["coupling_factor_age"] = {static_cast<double>(work.solid_factor_age)};
  memory["implicit_factor_place"] = flat<D>(work.solid_motion.factorised_at);
  memory["implicit_factor_step"] = {work.solid_motion.factorised_for};
  memory["contact_search_place"] = work.contact ? flat<D>(work.contact->searched_position) : std::vector<double>{};
  return memory;
}

template <int D>
void restore_work(const Scene<D>& scene, const NamedNumbers& memory, Workspace<D>& work) {
  if (scene.solids) {
    const std::vector<Vector<D>> coupling = points<D>(memory, "coupling_factor_place", scene.elastic_count);
    if (!coupling.empty()) {
      work.solid_operator.factorise(*scene.solids, coupling, number(memory, "coupling_factor_scale"));
      work.solid_factor_step = number(memory, "coupling_factor_step");
      work.solid_factor_age = static_cast<int>(number(memory, "coupling_factor_age"));
    }
    work.solid_motion.factorised_at = points<D>(memory, "implicit_factor_place", scene.elastic_count);
    if (!work.solid_motion.factorised_at.empty()) {
      work.solid_motion.factorised_for = number(memory, "implicit_factor_step");
      work.solid_motion.factor_lost = true;
    }
  }
  if (scene.contact && scene.shells) {
    const std::vector<Vector<D>> searched = points<D>(memory, "contact_search_place", scene.shell_count);
    if (!searched.empty()) {
      work.contact = scene.contact;
      update_contact_search<D>(*work.contact, *scene.shells, searched);
    }
  }
}

template NamedNumbers work_memory(const Workspace<2>&);
template NamedNumbers work_memory(const Workspace<3>&);
template void restore_work(const Scene<2>&, const NamedNumbers&, Workspace<2>&);
template void restore_work(const Scene<3>&, const NamedNumbers&, Workspace<3>&);

}  // namespace sim
