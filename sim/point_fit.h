// The value of scattered samples at a point by least squares: exact for linear fields wherever the samples lie, for quadratic ones where
// there are enough around the point; never without an answer.
#pragma once

#include <span>
#include <vector>

#include "sim/particles.h"

namespace sim {

// Weights w with value(x) = sum w_k f_k, sum w_k = 1. `offset`: sample minus x, m; `radius`: m, reach of the weight function (samples
// beyond count as at its edge). `quadratic`: allow the second-order fit. Directions in which the samples do not spread are left constant.
template <int D>
std::vector<double> fit_weights(std::span<const Vector<D>> offset, double radius, bool quadratic);

}  // namespace sim
