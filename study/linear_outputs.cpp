#include "withy/study/linear_outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <span>

#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/scene/describe.hpp"
#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

/// A component of a tip's place or deflection.
struct OfTip {
  std::size_t tip = 0;  ///< index in tips()
  Eigen::Index axis = 0;
  bool deflection = false;
};

/// What may be asked for. Tips have value and row only once they are: derivatives of one frame take a walk over the
/// whole tree, and those of all frames of a long chain a hundred times what all else takes.
struct Offered {
  LinearOutput output;
  std::optional<OfTip> of_tip = {};
};

/// Hinge coordinates and rates by the names of their speeds; rates answer to those of result tables too.
void add_hinges(const Configuration& c, std::vector<Offered>& outputs) {
  const Layout& layout = c.layout();
  const auto n = static_cast<Eigen::Index>(layout.speeds);
  std::vector<Offered> rates;
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    const Slot& slot = layout.hinges[h];
    const std::vector<Column> columns = rate_columns(c.prepared().model().hinges()[h]);
    const std::vector<HingeRate> kinds = hinge_rates(*c.prepared().model().hinges()[h].hinge);
    for (std::size_t i = 0; i < slot.speeds; ++i) {
      const std::string& name = layout.speed_names[slot.speed + i];
      const auto speed = static_cast<Eigen::Index>(slot.speed + i);
      // Where coordinates are a quaternion the output is the rotation from it, zero here.
      const std::optional<std::size_t> coordinate =
          slot.positions == slot.speeds ? std::optional(i) : kinds[i].coordinate;
      const double value = coordinate ? c.state().y[slot.position + *coordinate] : 0.0;
      outputs.push_back({{{name, kinds[i].angular ? "rad" : "m"}, -1, value, Eigen::RowVectorXd::Unit(2 * n, speed)}});
      rates.push_back({{{name + ".rate", kinds[i].angular ? "rad/s" : "m/s"},
                        -1,
                        c.state().y[layout.positions + slot.speed + i],
                        Eigen::RowVectorXd::Unit(2 * n, n + speed),
                        columns[i].name}});
    }
  }
  outputs.insert(outputs.end(), rates.begin(), rates.end());
}

/// Deflections and places of tips, by the names of result tables.
void add_tips(const std::vector<Tip>& tips, std::vector<Offered>& outputs) {
  const char* axes = "xyz";
  for (std::size_t k = 0; k < tips.size(); ++k) {
    const Tip& tip = tips[k];
    // Of a body in segments the deflection of the last one says little: its tip is among the positions.
    for (Eigen::Index i = 0; i < 3 && tip.flexible && !tip.in_segments(); ++i)
      outputs.push_back({{{fmt::format("{}.tip.deflection_{}", tip.body, axes[i]), "m"}}, OfTip{k, i, true}});
    for (Eigen::Index i = 0; i < 3; ++i)
      outputs.push_back({{{fmt::format("{}.tip.{}", tip.body, axes[i]), "m"}}, OfTip{k, i, false}});
  }
}

/// The outputs with values and rows, each frame that they need differentiated once.
std::vector<LinearOutput> with_rows(const Configuration& c, const std::vector<Tip>& tips,
                                    std::span<const Offered> asked) {
  const auto n = static_cast<Eigen::Index>(c.layout().speeds);
  std::map<std::size_t, FrameTangent> frames;
  std::vector<LinearOutput> outputs;
  for (const Offered& each : asked) {
    outputs.push_back(each.output);
    if (!each.of_tip) continue;
    const auto [tip, axis, deflection] = *each.of_tip;
    const auto [found, fresh] = frames.try_emplace(tip);
    if (fresh) found->second = c.dynamics().frame(c.state().y, tips[tip].tip.body, tips[tip].tip.frame);
    const FrameTangent& t = found->second;
    LinearOutput& output = outputs.back();
    output.value = deflection ? t.deflection[axis] : t.position[axis];
    output.row = Eigen::RowVectorXd::Zero(2 * n);
    output.row.head(n) = (deflection ? t.deflection_by_position : t.by_position).row(axis);
  }
  for (LinearOutput& output : outputs) {
    if (output.sensed >= 0) continue;
    // What follows in closed loops moves as others do.
    output.row.head(n) = c.dynamics().on_motions(c.state().y, output.row.head(n).transpose()).transpose();
    output.row.tail(n) = c.dynamics().on_motions(c.state().y, output.row.tail(n).transpose()).transpose();
  }
  return outputs;
}

/// Those of the names. \throws OptionError where one is none of them
std::vector<Offered> chosen_of(const std::vector<Offered>& all, const std::vector<std::string>& names) {
  std::vector<Offered> chosen;
  std::vector<std::string> unknown;
  for (const std::string& name : names) {
    const std::size_t before = chosen.size();
    // A coordinate, `elbow.0`, is the beginning of its rate's name too.
    const bool whole =
        std::any_of(all.begin(), all.end(), [&](const Offered& o) { return o.output.column.name == name; });
    const auto is = [&](const std::string& known) {
      return known == name || (!whole && known.starts_with(name + '.'));
    };
    for (const Offered& o : all)
      if (is(o.output.column.name) || is(o.output.in_tables)) chosen.push_back(o);
    if (chosen.size() == before) unknown.push_back(name);
  }
  if (unknown.empty()) return chosen;
  std::vector<std::string> known;
  for (const Offered& o : all) known.push_back(o.output.column.name);
  throw OptionError("outputs", unknown_names(unknown, known));
}

}  // namespace

std::vector<LinearOutput> linear_outputs(const Configuration& c, const std::vector<std::string>& names) {
  std::vector<Offered> all;
  for (const SensorNode& sensor : c.prepared().scene.outputs)
    for (const Column& column : columns_of(sensor)) all.push_back({{column, static_cast<int>(all.size())}});
  const std::vector<Tip> ends = tips(c.prepared().model());
  if (names.empty() && !all.empty()) return with_rows(c, ends, all);
  add_hinges(c, all);
  add_tips(ends, all);
  return with_rows(c, ends, names.empty() ? all : chosen_of(all, names));
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
  d.uncertainty.setZero(rows);
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
    if (most > 0) d.uncertainty[k] = change.row(k).maxCoeff() / most;
  }
  return d;
}

}  // namespace withy::study
