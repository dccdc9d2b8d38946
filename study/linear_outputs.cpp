#include "withy/study/linear_outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/scene/describe.hpp"
#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

/// Hinge coordinates and rates by the names of their speeds; rates answer to those of result tables too.
void add_hinges(const Configuration& c, std::vector<LinearOutput>& outputs) {
  const Layout& layout = c.layout();
  const auto n = static_cast<Eigen::Index>(layout.speeds);
  std::vector<LinearOutput> rates;
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    const Slot& slot = layout.hinges[h];
    const std::vector<Column> columns = rate_columns(c.prepared().model().hinges()[h]);
    const std::vector<HingeRate> kinds = hinge_rates(*c.prepared().model().hinges()[h].hinge);
    for (std::size_t i = 0; i < slot.speeds; ++i) {
      const std::string& name = layout.speed_names[slot.speed + i];
      const auto speed = static_cast<Eigen::Index>(slot.speed + i);
      // Where coordinates are a quaternion the output is the rotation from it, zero here.
      const double value = slot.positions == slot.speeds ? c.state().y[slot.position + i] : 0.0;
      outputs.push_back({{name, kinds[i].angular ? "rad" : "m"}, -1, value, Eigen::RowVectorXd::Unit(2 * n, speed)});
      rates.push_back({{name + ".rate", kinds[i].angular ? "rad/s" : "m/s"},
                       -1,
                       c.state().y[layout.positions + slot.speed + i],
                       Eigen::RowVectorXd::Unit(2 * n, n + speed),
                       columns[i].name});
    }
  }
  outputs.insert(outputs.end(), rates.begin(), rates.end());
}

/// Deflections and places of tips, by the names of result tables.
void add_tips(const Configuration& c, std::vector<LinearOutput>& outputs) {
  const auto n = static_cast<Eigen::Index>(c.layout().speeds);
  const char* axes = "xyz";
  const auto add = [&](const std::string& name, double value, const Eigen::RowVectorXd& by_position) {
    outputs.push_back({{name, "m"}, -1, value, Eigen::RowVectorXd::Zero(2 * n)});
    outputs.back().row.head(n) = by_position;
  };
  for (const Tip& tip : tips(c.prepared().model())) {
    const FrameTangent t = c.dynamics().frame(c.state().y, tip.tip.body, tip.tip.frame);
    // Of a body in segments the deflection of the last one says little: its tip is among the positions.
    for (Eigen::Index i = 0; i < 3 && tip.flexible && !tip.in_segments(); ++i)
      add(fmt::format("{}.tip.deflection_{}", tip.body, axes[i]), t.deflection[i], t.deflection_by_position.row(i));
    for (Eigen::Index i = 0; i < 3; ++i)
      add(fmt::format("{}.tip.{}", tip.body, axes[i]), t.position[i], t.by_position.row(i));
  }
}

}  // namespace

std::vector<LinearOutput> linear_outputs(const Configuration& c, const std::vector<std::string>& names) {
  std::vector<LinearOutput> all;
  for (const SensorNode& sensor : c.prepared().scene.outputs)
    for (const Column& column : columns_of(sensor)) all.push_back({column, static_cast<int>(all.size())});
  const std::size_t sensors = all.size();
  if (names.empty() && sensors > 0) return all;
  add_hinges(c, all);
  add_tips(c, all);
  if (names.empty()) return all;
  std::vector<LinearOutput> chosen;
  std::vector<std::string> unknown;
  for (const std::string& name : names) {
    const std::size_t before = chosen.size();
    // A coordinate, `elbow.0`, is the beginning of its rate's name too.
    const bool whole =
        std::any_of(all.begin(), all.end(), [&](const LinearOutput& o) { return o.column.name == name; });
    const auto is = [&](const std::string& known) {
      return known == name || (!whole && known.starts_with(name + '.'));
    };
    for (const LinearOutput& o : all)
      if (is(o.column.name) || is(o.in_tables)) chosen.push_back(o);
    if (chosen.size() == before) unknown.push_back(name);
  }
  if (unknown.empty()) return chosen;
  std::vector<std::string> known;
  for (const LinearOutput& o : all) known.push_back(o.column.name);
  throw OptionError("outputs", unknown_names(unknown, known));
}

Eigen::RowVectorXd row_of_free(const LinearOutput& output, const std::vector<Eigen::Index>& free) {
  const auto m = static_cast<Eigen::Index>(free.size());
  Eigen::RowVectorXd row(2 * m);
  for (Eigen::Index i = 0; i < m; ++i) {
    row[i] = output.row[free[static_cast<std::size_t>(i)]];
    row[m + i] = output.row[output.row.size() / 2 + free[static_cast<std::size_t>(i)]];
  }
  return row;
}

SensedDerivatives sensed_derivatives(SmallMotions& motions) {
  SensedDerivatives d;
  d.values = motions.sensed(motions.state());
  const Eigen::Index rows = d.values.size(), size = motions.size();
  d.by_state.resize(rows, size);
  Eigen::MatrixXd change(rows, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const Differenced column =
        adaptive_difference([&](double h) -> Eigen::VectorXd { return motions.sensed(motions.displaced(i, h)); },
                            motions.step(i), motions.place(i));
    d.by_state.col(i) = column.slope;
    // Both in what the state changes over its step, so that states of different units compare.
    change.col(i) = column.change * motions.step(i);
  }
  // What a number of the same unit changes by is what its rounding is to be seen against.
  std::map<std::string, double> greatest;
  for (Eigen::Index k = 0; k < rows; ++k) {
    double& most = greatest[motions.columns()[static_cast<std::size_t>(k)].unit];
    for (Eigen::Index i = 0; i < size; ++i) most = std::max(most, std::abs(d.by_state(k, i)) * motions.step(i));
  }
  for (Eigen::Index k = 0; k < rows; ++k) {
    const double most = greatest[motions.columns()[static_cast<std::size_t>(k)].unit];
    if (most > 0) d.uncertainty = std::max(d.uncertainty, change.row(k).maxCoeff() / most);
  }
  return d;
}

}  // namespace withy::study
