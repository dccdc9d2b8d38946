/// \file
/// How what an FMU computes changes along directions of its states and inputs.
#include <algorithm>
#include <cmath>
#include <limits>

#include "withy/bindings/fmi/dynamics.hpp"
#include "withy/core/plugin/central_difference.hpp"
#include "withy/core/plugin/refined_difference.hpp"
#include "withy/core/simulation/diagnosis.hpp"

namespace withy::fmi {

/// Where the state as seen goes where that of the host goes along a direction: a quaternion of any length along the
/// unit sphere.
std::vector<double> Dynamics::seen_along(std::span<const double> along_states) const {
  std::vector<double> along(along_states.begin(), along_states.end());
  if (along.empty()) return along;
  for (std::size_t h = 0; h < model().hinges().size(); ++h) {
    const Slot& slot = model().layout().hinges[h];
    const auto count = static_cast<Eigen::Index>(slot.positions);
    if (slot.positions == slot.speeds) continue;
    const Eigen::Map<const Eigen::VectorXd> x(&state_.y[slot.position], count);
    Eigen::Map<Eigen::VectorXd> v(&along[slot.position], count);
    const double length = v.norm();
    if (length == 0) continue;
    const auto scaled = [&](double step) {
      Eigen::VectorXd y = x + step * v;
      model().hinges()[h].hinge->normalize({y.data(), slot.positions});
      return y;
    };
    v = central_difference(scaled, 0.01 / length).eval();
  }
  return along;
}

State Dynamics::moved(double h, std::span<const double> along_states, std::span<const std::size_t> inputs,
                      std::span<const double> along_inputs) {
  State state = seen();
  for (std::size_t i = 0; i < along_states.size(); ++i) state.y[i] += h * along_states[i];
  if (quaternions_) equations_.normalize(state.y);
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const LoadNode& node = model().loads()[inputs[k]];
    const InputPort& port = *node.load->input();
    const std::span<double> held = node.discrete(std::span(state.y));
    port.set(state.time, state.time, port.value(state.time, held) + h * along_inputs[k], held);
  }
  return state;
}

void Dynamics::differences(std::span<const double> along_states, std::span<const std::size_t> inputs,
                           std::span<const double> along_inputs, std::span<const std::size_t> columns,
                           std::span<double> values) {
  double longest = 0, place = 0;
  for (std::size_t i = 0; i < along_states.size(); ++i) {
    longest = std::max(longest, std::abs(along_states[i]));
    if (along_states[i] != 0) place = std::max(place, std::abs(state_.y[i]));
  }
  if (longest == 0)
    for (const double rate : along_inputs) longest = std::max(longest, std::abs(rate));
  if (longest == 0) return std::fill(values.begin(), values.end(), 0.0);
  const double h = 1e-3 * (1 + 1e-3 * place) / longest;
  row_ = nullptr;
  const auto at = [&](double step) {
    const std::vector<double>& row = table_.row(moved(step, along_states, inputs, along_inputs));
    Eigen::VectorXd numbers(static_cast<Eigen::Index>(columns.size()));
    for (std::size_t c = 0; c < columns.size(); ++c) numbers[static_cast<Eigen::Index>(c)] = row[columns[c]];
    return numbers;
  };
  const Eigen::VectorXd found = refined_difference(at, h, place / longest);
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (!std::isfinite(found[static_cast<Eigen::Index>(c)]))
      throw Discarded("t = " + brief(state_.time) + " s: output '" + table_.columns()[columns[c]].name +
                      "' has no finite derivative");
  std::copy(found.begin(), found.end(), values.begin());
}

/// By inputs, at the state as seen: difference quotients of the longest step that a shorter one agrees with. What is
/// affine in the inputs, as efforts enter the equations, has no error but rounding with any; a law that measures an
/// acceleration or an input needs to be affine in neither.
void Dynamics::add_along_inputs(std::span<const std::size_t> inputs, std::span<const double> along_inputs,
                                std::span<double> derivatives) {
  double longest = 0;
  for (const double rate : along_inputs) longest = std::max(longest, std::abs(rate));
  if (longest == 0) return;
  derivatives_are_now_ = false;  // y_dot_ is that of other inputs
  const auto at = [&](double step) {
    Eigen::VectorXd rates(static_cast<Eigen::Index>(states_));
    // An input so far away may be none that the equations can have: a shorter step tells.
    if (evaluate(moved(step, {}, inputs, along_inputs)).ok())
      std::copy_n(y_dot_.begin(), states_, rates.begin());
    else
      rates.setConstant(std::numeric_limits<double>::quiet_NaN());
    return rates;
  };
  const Eigen::VectorXd found = refined_difference(at, 1 / longest);
  if (!found.allFinite())
    throw Discarded("t = " + brief(state_.time) + " s: the derivatives of states have no finite ones by these inputs");
  for (std::size_t i = 0; i < states_; ++i) derivatives[i] += found[static_cast<Eigen::Index>(i)];
}

/// By states, at the state as seen.
void Dynamics::add_along_states(std::span<const double> along, std::span<double> derivatives) {
  const Linearization* linearization = equations_.linearization();
  if (linearization == nullptr) throw std::invalid_argument(study::why_no_derivatives(*prepared_));
  static_cast<void>(this->derivatives());
  // At a jump that has not been dealt with the state is seen before it.
  if (!jacobian_is_now_ && !linearization->jacobian(seen().time, seen().y, y_dot_, jacobian_).ok())
    throw Discarded("t = " + brief(state_.time) + " s: the mass matrix cannot be solved");
  jacobian_is_now_ = true;
  for (std::size_t j = 0; j < states_; ++j)
    if (along[j] != 0)
      for (std::size_t i = 0; i < states_; ++i) derivatives[i] += jacobian_[j * states_ + i] * along[j];
}

void Dynamics::sensitivity(std::span<const double> along_states, std::span<const std::size_t> inputs,
                           std::span<const double> along_inputs, std::span<double> derivatives,
                           std::span<const std::size_t> columns, std::span<double> values) {
  const std::vector<double> along = seen_along(along_states);
  if (!columns.empty()) differences(along, inputs, along_inputs, columns, values);
  if (derivatives.empty()) return;
  std::fill(derivatives.begin(), derivatives.end(), 0.0);
  if (!along.empty()) add_along_states(along, derivatives);
  add_along_inputs(inputs, along_inputs, derivatives);
}

}  // namespace withy::fmi
