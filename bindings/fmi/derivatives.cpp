/// \file
/// Derivatives of an instance along directions, exact: of derivatives of states and outputs by states and inputs.
#include <algorithm>
#include <stdexcept>

#include "withy/bindings/fmi/instance.hpp"

namespace withy::fmi {

std::vector<double> Instance::jacobian_along(std::span<const std::uint32_t> unknowns,
                                             std::span<const std::uint32_t> knowns, const double* along) {
  std::vector<double> along_states, along_inputs, derivatives, values, result;
  std::vector<std::size_t> inputs, columns;
  for (std::size_t k = 0; k < knowns.size(); ++k) {
    const Variable& v = variable(knowns[k]);
    if (v.kind == Variable::Kind::state) {
      along_states.resize(variables_.states);
      along_states[v.index] += along[k];
    } else if (v.kind == Variable::Kind::input) {
      inputs.push_back(v.index);
      along_inputs.push_back(along[k]);
    } else {
      throw std::invalid_argument(v.quoted() + ": derivatives are with respect to states and inputs");
    }
  }
  for (const std::uint32_t reference : unknowns) {
    const Variable& v = variable(reference);
    if (v.kind == Variable::Kind::derivative) {
      derivatives.resize(variables_.states);
    } else if (v.kind == Variable::Kind::output) {
      columns.push_back(v.index);
    } else if (v.kind != Variable::Kind::state) {
      throw std::invalid_argument(v.quoted() + ": derivatives are those of derivatives of states and of outputs");
    }
  }
  values.resize(columns.size());
  dynamics().sensitivity(along_states, inputs, along_inputs, derivatives, columns, values);
  std::size_t column = 0;
  for (const std::uint32_t reference : unknowns) {
    const Variable& v = variables_.all[reference];
    if (v.kind == Variable::Kind::derivative) {
      result.push_back(derivatives[v.index]);
    } else if (v.kind == Variable::Kind::output) {
      result.push_back(values[column++]);
    } else {
      result.push_back(along_states.empty() ? 0 : along_states[v.index]);
    }
  }
  return result;
}

void Instance::directional(std::span<const std::uint32_t> unknowns, std::span<const std::uint32_t> knowns,
                           const double* along_knowns, double* sensitivity) {
  const std::vector<double> found = jacobian_along(unknowns, knowns, along_knowns);
  std::copy(found.begin(), found.end(), sensitivity);
}

void Instance::adjoint(std::span<const std::uint32_t> unknowns, std::span<const std::uint32_t> knowns,
                       const double* along_unknowns, double* sensitivity) {
  std::vector<double> sums(knowns.size());
  for (std::size_t k = 0; k < knowns.size(); ++k) {
    constexpr double one = 1;
    const std::vector<double> column = jacobian_along(unknowns, knowns.subspan(k, 1), &one);
    for (std::size_t u = 0; u < unknowns.size(); ++u) sums[k] += along_unknowns[u] * column[u];
  }
  std::copy(sums.begin(), sums.end(), sensitivity);
}

}  // namespace withy::fmi
