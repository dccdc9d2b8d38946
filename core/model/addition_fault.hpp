/// \file
/// Whether loads add their efforts to those of others.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/model/model.hpp"

namespace withy {

/// Why what a load gives at a state is not added to efforts that stand there, or is not of the state alone; empty where
/// it is both: a sentence without a full stop that names the load, the speed and the function. BoundLoad::add,
/// DiscretePart::add and ContinuousPart::add are called on zeros and on other numbers; efforts that are not finite say
/// nothing. \param load index in Model::loads() \param state with the discrete states of a run
inline std::string addition_fault(const Model& model, std::size_t load, const State& state) {
  using Efforts = Eigen::ArrayXd;
  const LoadNode& node = model.loads()[load];
  const Layout& layout = model.layout();
  const std::span<const double> y(state.y);
  std::vector<double> scratch(model.load_scratch());
  std::vector<std::pair<const char*, std::function<void(std::span<double>)>>> parts = {
      {"BoundLoad::add", [&](std::span<double> efforts) {
         node.load->add(state.time, y.first(layout.positions), y.subspan(layout.positions, layout.speeds), efforts,
                        scratch);
       }}};
  if (node.slot.count > 0)
    parts.emplace_back("DiscretePart::add", [&](std::span<double> efforts) {
      node.load->discrete()->add(state.time, node.discrete(y), efforts);
    });
  if (node.continuous != nullptr)
    parts.emplace_back("ContinuousPart::add", [&](std::span<double> efforts) {
      node.continuous->add(node.view(state.time, y, layout, scratch), efforts);
    });
  for (const auto& [function, add] : parts) {
    const auto added_to = [&, &call = add](double start) {
      Efforts efforts = Efforts::Constant(static_cast<Eigen::Index>(layout.speeds), start);
      call({efforts.data(), layout.speeds});
      return efforts;
    };
    const Efforts alone = added_to(0);
    // As large as the efforts, so that their rounding is far below what a load that sets them leaves of it: nothing.
    const double before = 1 + alone.isFinite().select(alone.abs(), 0).sum();
    const Efforts beside = added_to(before), again = added_to(0);
    constexpr double rounding = 1e-6;
    for (Eigen::Index i = 0; i < alone.size(); ++i) {
      const std::string where = "'" + layout.speed_names[static_cast<std::size_t>(i)] + "' (" + function + "): ";
      if (std::abs(again[i] - alone[i]) > rounding * before)
        return "load '" + node.name + "' gives another effort at a second call for the same state on " + where +
               "what it remembers is to stand in its discrete or continuous states";
      if (std::abs(beside[i] - before - alone[i]) > rounding * before)
        return "load '" + node.name + "' does not add its effort on " + where +
               "it sets efforts, and is to add to them";
    }
  }
  return {};
}

}  // namespace withy
