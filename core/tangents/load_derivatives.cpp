#include "withy/core/tangents/load_derivatives.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <sstream>
#include <vector>

#include "withy/core/plugin/refined_difference.hpp"
#include "withy/core/tangents/displacements.hpp"
#include "withy/core/tangents/load_wrenches.hpp"

namespace withy {
namespace {

/// What derivatives are with respect to.
enum Variable : std::size_t { displacement, speed, own_state, variables };

/// Numbers that a load gives at a state, with what it says of their derivatives, a row each.
struct Told {
  std::function<Eigen::VectorXd(std::span<const double>)> numbers;
  std::array<Eigen::MatrixXd, variables> slopes;
  std::size_t first_state = 0;  ///< of the load's own continuous states, in y
};

/// One element that is wrong.
struct WrongSlope {
  Eigen::Index row, column;
  Variable by;
  double said, found;
};

std::optional<Told> told_by_load(const Model& model, const LoadNode& node, double t, std::span<const double> y) {
  const Layout& layout = model.layout();
  const auto n = static_cast<Eigen::Index>(layout.speeds);
  Told told;
  told.slopes = {Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd(n, 0)};
  if (!derivatives_call(node.name, [&] {
        return node.load->add_derivatives(t, y.first(layout.positions), y.subspan(layout.positions, layout.speeds),
                                          told.slopes[displacement], told.slopes[speed]);
      }))
    return {};
  told.numbers = [&model, &node, t](std::span<const double> at) {
    const Layout& order = model.layout();
    Eigen::VectorXd efforts = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(order.speeds));
    std::vector<double> scratch(model.load_scratch());
    node.load->add(t, at.first(order.positions), at.subspan(order.positions, order.speeds),
                   {efforts.data(), order.speeds}, scratch);
    return efforts;
  };
  return told;
}

std::optional<Told> told_by_states(const Model& model, const LoadNode& node, double t, std::span<const double> y) {
  if (node.continuous == nullptr) return {};
  const Layout& layout = model.layout();
  const auto n = static_cast<Eigen::Index>(layout.speeds), z = static_cast<Eigen::Index>(node.continuous_slot.count);
  Told told;
  told.slopes = {Eigen::MatrixXd::Zero(n + z, n), Eigen::MatrixXd::Zero(n + z, n), Eigen::MatrixXd::Zero(n + z, z)};
  told.first_state = node.continuous_slot.first;
  auto& [by_position, by_speed, by_state] = told.slopes;
  ContinuousDerivatives to{by_position.topRows(n),    by_speed.topRows(n),    by_state.topRows(n),
                           by_position.bottomRows(z), by_speed.bottomRows(z), by_state.bottomRows(z)};
  std::vector<double> scratch(model.load_scratch());
  if (!derivatives_call(node.name,
                        [&] { return node.continuous->add_derivatives(node.view(t, y, layout, scratch), to); }))
    return {};
  told.numbers = [&model, &node, t, n, z](std::span<const double> at) {
    Eigen::VectorXd both = Eigen::VectorXd::Zero(n + z);
    std::vector<double> work(model.load_scratch()), still(model.layout().speeds, 0.0);
    LoadView view = node.view(t, at, model.layout(), work);
    node.continuous->add(view, {both.data(), model.layout().speeds});
    view.accelerations = still;
    node.continuous->rates(view, {both.data() + n, static_cast<std::size_t>(z)});
    return both;
  };
  return told;
}

/// Numbers from ½ to 1 of either sign: what is wrong in any element shows along them.
Eigen::VectorXd mixed_direction(Eigen::Index size) {
  const auto fraction = [](double x) { return x - std::floor(x); };
  Eigen::VectorXd v(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const double k = static_cast<double>(i) + 1;
    v(i) = (fraction(0.618034 * k) < 0.5 ? 0.5 : -0.5) * (1 + fraction(0.754878 * k));
  }
  return v;
}

void move_state(const Model& model, const Told& told, Variable by, const Eigen::VectorXd& change, std::span<double> y) {
  const std::span<const double> by_number(change.data(), static_cast<std::size_t>(change.size()));
  if (by == displacement) return displace(model, y, by_number);
  const std::size_t first = by == speed ? model.layout().positions : told.first_state;
  for (std::size_t i = 0; i < by_number.size(); ++i) y[first + i] += by_number[i];
}

/// The rows that are wrong along a direction, with what is said and found of the worst.
struct Comparison {
  Eigen::ArrayX<bool> wrong;
  Eigen::VectorXd said, found;
};

Comparison compare_slopes(const Model& model, const Told& told, Variable by, const Eigen::VectorXd& direction,
                          std::span<const double> y) {
  constexpr double tolerance = 1e-6, rounding = 64 * std::numeric_limits<double>::epsilon();
  Eigen::ArrayXd sizes = Eigen::ArrayXd::Zero(told.slopes[by].rows());
  double shortest = std::numeric_limits<double>::infinity();
  const auto move = [&](std::span<double> moved, double h) { move_state(model, told, by, h * direction, moved); };
  const auto found = refine_difference(
      [&](double h) {
        std::vector<double> moved(y.begin(), y.end());
        move(moved, h);
        Eigen::VectorXd numbers = told.numbers(moved);
        sizes = sizes.max(numbers.array().abs());
        shortest = std::min(shortest, std::abs(h));
        return numbers;
      },
      analysis::difference_step, 8, greatest_moved(y, move));
  Comparison c{{}, told.slopes[by] * direction, found.slope};
  const Eigen::ArrayXd terms = (told.slopes[by].cwiseAbs() * direction.cwiseAbs()).array() + c.found.array().abs();
  const Eigen::ArrayXd allowed =
      tolerance * terms + 10 * found.change.array() + found.rounding.array() + rounding * sizes / shortest;
  const Eigen::ArrayXd off = (c.said - c.found).array().abs();
  // What differences do not tell says nothing; what is said to be no number is wrong where they do.
  c.wrong =
      c.found.array().isFinite() && found.change.array().isFinite() && (off > allowed || !c.said.array().isFinite());
  return c;
}

std::optional<WrongSlope> wrong_slope(const Model& model, const std::array<std::vector<double>, 2>& places,
                                      const std::function<std::optional<Told>(std::span<const double>)>& ask) {
  const std::optional<Told> first = ask(places[0]), second = ask(places[1]);
  if (!first || !second) return {};
  for (const Variable by : {displacement, speed, own_state}) {
    const Eigen::Index count = first->slopes[by].cols();
    if (count == 0) continue;
    const Eigen::VectorXd along = mixed_direction(count);
    if (!(compare_slopes(model, *first, by, along, places[0]).wrong &&
          compare_slopes(model, *second, by, along, places[1]).wrong)
             .any())
      continue;
    std::optional<WrongSlope> worst;
    for (Eigen::Index j = 0; j < count; ++j) {
      const Comparison c = compare_slopes(model, *first, by, Eigen::VectorXd::Unit(count, j), places[0]);
      for (Eigen::Index i = 0; i < c.wrong.size(); ++i)
        if (c.wrong(i) && (!worst || !(std::abs(c.said(i) - c.found(i)) <= std::abs(worst->said - worst->found))))
          worst = {i, j, by, c.said(i), c.found(i)};
    }
    if (worst) return worst;
  }
  return {};
}

std::string in_words(const Model& model, const LoadNode& node, const WrongSlope& wrong) {
  const Layout& layout = model.layout();
  const auto state = [&](Eigen::Index i) {
    return "its state '" + node.continuous->name(static_cast<std::size_t>(i)) + "'";
  };
  const auto speed_name = [&](Eigen::Index i) { return "'" + layout.speed_names[static_cast<std::size_t>(i)] + "'"; };
  const auto n = static_cast<Eigen::Index>(layout.speeds);
  std::ostringstream text;
  text << "load '" << node.name << "' says that "
       << (wrong.row < n ? "its effort on " + speed_name(wrong.row) : "the rate of " + state(wrong.row - n))
       << " changes by " << wrong.said << " with "
       << (wrong.by == displacement ? "a displacement along " + speed_name(wrong.column)
           : wrong.by == speed      ? "the speed " + speed_name(wrong.column)
                                    : state(wrong.column))
       << " (add_derivatives), where it changes by " << wrong.found;
  return text.str();
}

/// The state moved along all that loads see but time.
std::vector<double> state_beside(const Model& model, const State& state, double distance) {
  const Layout& layout = model.layout();
  std::vector<double> y = state.y;
  const Eigen::VectorXd along = distance * mixed_direction(static_cast<Eigen::Index>(layout.speeds));
  displace(model, y, {along.data(), layout.speeds});
  for (std::size_t i = 0; i < layout.speeds; ++i) y[layout.positions + i] -= along[static_cast<Eigen::Index>(i)];
  const Eigen::VectorXd of_states = distance * mixed_direction(static_cast<Eigen::Index>(layout.continuous));
  for (std::size_t i = 0; i < layout.continuous; ++i)
    y[layout.positions + layout.speeds + i] += of_states[static_cast<Eigen::Index>(i)];
  return y;
}

}  // namespace

std::optional<FalseDerivative> false_derivative(const Model& model, const State& state) {
  constexpr std::size_t most_speeds = 200;  // a matrix of theirs is made for each load
  if (model.layout().speeds > most_speeds) return {};
  const std::array<std::vector<double>, 2> places = {state_beside(model, state, 1.7e-3),
                                                     state_beside(model, state, -2.9e-3)};
  for (std::size_t l = 0; l < model.loads().size(); ++l) {
    const LoadNode& node = model.loads()[l];
    try {
      for (const auto& told : {&told_by_load, &told_by_states})
        if (const auto wrong =
                wrong_slope(model, places, [&](std::span<const double> y) { return told(model, node, state.time, y); }))
          return FalseDerivative{l, in_words(model, node, *wrong)};
    } catch (const PluginError& e) {
      return FalseDerivative{l, e.what()};
    }
  }
  return {};
}

}  // namespace withy
