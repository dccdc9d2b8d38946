#include "withy/core/tangents/continuous_tangents.hpp"

#include "withy/core/plugin/refined_difference.hpp"
#include "withy/core/tangents/displacements.hpp"
#include "withy/core/tangents/load_derivatives.hpp"
#include "withy/core/tangents/load_wrenches.hpp"

namespace withy {
namespace {

using Moving = std::function<void(std::span<double>, std::size_t, double)>;

/// Adds the derivatives of a function of y, efforts on all speeds and then rates from `first` on, `count` of them, to
/// the columns of displacements, speeds and the states `from`, `states` of them.
template <class Function>
void add_differences(Function&& of, const Layout& layout, std::span<const double> y, const Moving& displace,
                     Eigen::Index first, Eigen::Index count, std::size_t from, std::size_t states,
                     ContinuousTangents& to) {
  const auto n = static_cast<Eigen::Index>(layout.speeds);
  const auto slope = [&](auto&& move) -> Eigen::VectorXd {
    return refined_difference(
        [&](double h) -> Eigen::VectorXd {
          std::vector<double> moved(y.begin(), y.end());
          move(moved, h);
          return of(moved);
        },
        analysis::difference_step, greatest_moved(y, move));
  };
  const auto add = [&](const Eigen::VectorXd& of_both, auto&& efforts, auto&& rates) {
    efforts += of_both.head(n);
    if (count > 0) rates.segment(first, count) += of_both.tail(count);
  };
  for (std::size_t s = 0; s < layout.speeds; ++s) {
    const auto j = static_cast<Eigen::Index>(s);
    add(slope([&](std::vector<double>& moved, double h) { displace(moved, s, h); }), to.effort_by_position.col(j),
        to.rate_by_position.col(j));
    add(slope([&](std::vector<double>& moved, double h) { moved[layout.positions + s] += h; }),
        to.effort_by_speed.col(j), to.rate_by_speed.col(j));
  }
  for (std::size_t k = from; k < from + states; ++k) {
    const auto j = static_cast<Eigen::Index>(k);
    add(slope([&](std::vector<double>& moved, double h) { moved[layout.positions + layout.speeds + k] += h; }),
        to.effort_by_state.col(j), to.rate_by_state.col(j));
  }
}

/// Whether the rates of a load's continuous part change with accelerations a, of which its add_derivatives has nothing
/// to say. The last bit counts: what does not read them gives the same.
bool feels_accelerations(const LoadNode& node, LoadView view, std::span<const double> a) {
  const auto rates_with = [&](double change) {
    std::vector<double> accelerations(a.begin(), a.end()), rates(node.continuous_slot.count);
    for (std::size_t i = 0; i < a.size(); ++i)
      accelerations[i] += change * (1 + golden_section * static_cast<double>(i));
    view.accelerations = accelerations;
    node.continuous->rates(view, rates);
    return rates;
  };
  return rates_with(0) != rates_with(1);
}

}  // namespace

ContinuousTangents continuous_tangents(const Model& model, double t, std::span<const double> y,
                                       std::span<const double> a, const Moving& displace,
                                       const std::function<Eigen::VectorXd(std::span<const double>)>& of_wrenches,
                                       std::vector<bool>& differenced) {
  const Layout& layout = model.layout();
  const auto n = static_cast<Eigen::Index>(layout.speeds), z = static_cast<Eigen::Index>(layout.continuous);
  const auto zero = [](Eigen::Index rows, Eigen::Index columns) { return Eigen::MatrixXd::Zero(rows, columns).eval(); };
  ContinuousTangents all{zero(n, n), zero(n, n), zero(n, z), zero(z, n), zero(z, n), zero(z, z), zero(z, n)};
  std::vector<double> scratch(model.load_scratch());
  for (const LoadSlot& slot : layout.continuous_slots) {
    const LoadNode& node = model.loads()[slot.load];
    const std::size_t from = slot.first - layout.positions - layout.speeds;
    const auto first = static_cast<Eigen::Index>(from), count = static_cast<Eigen::Index>(slot.count);
    ContinuousDerivatives to{all.effort_by_position,
                             all.effort_by_speed,
                             all.effort_by_state.middleCols(first, count),
                             all.rate_by_position.middleRows(first, count),
                             all.rate_by_speed.middleRows(first, count),
                             all.rate_by_state.block(first, first, count, count)};
    if (of_wrenches && !node.load->frames().empty()) differenced[slot.load] = true;
    if (!feels_accelerations(node, node.view(t, y, layout, scratch), a) && derivatives_call(node.name, [&] {
          return node.continuous->add_derivatives(node.view(t, y, layout, scratch), to);
        }))
      continue;
    differenced[slot.load] = true;
    const auto part = [&](std::span<const double> at) {
      Eigen::VectorXd both = Eigen::VectorXd::Zero(n + count);
      LoadView view = node.view(t, at, layout, scratch);
      view.accelerations = a;
      node.continuous->add(view, {both.data(), layout.speeds});
      node.continuous->rates(view, {both.data() + n, slot.count});
      return both;
    };
    // Rates are linear in the accelerations, but for limits.
    const auto by_acceleration = [&](Eigen::Index j) {
      return refined_difference(
          [&](double h) -> Eigen::VectorXd {
            std::vector<double> moved(a.begin(), a.end());
            moved[static_cast<std::size_t>(j)] += h;
            Eigen::VectorXd rates(count);
            LoadView view = node.view(t, y, layout, scratch);
            view.accelerations = moved;
            node.continuous->rates(view, {rates.data(), slot.count});
            return rates;
          },
          analysis::difference_step, a[static_cast<std::size_t>(j)]);
    };
    // What it measures may be given by any load: its states are all among the columns.
    add_differences(part, layout, y, displace, first, count, 0, layout.continuous, all);
    for (Eigen::Index j = 0; j < n; ++j) all.rate_by_acceleration.col(j).segment(first, count) = by_acceleration(j);
  }
  if (of_wrenches) add_differences(of_wrenches, layout, y, displace, 0, 0, 0, layout.continuous, all);
  return all;
}

}  // namespace withy
