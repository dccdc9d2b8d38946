#include "withy/study/linear_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "withy/core/analysis/modes.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

/// An output y = value + row · (δ, δu) of all speeds.
struct LinearOutput {
  std::string name;
  double value = 0;
  Eigen::RowVectorXd row;
};

/// Every output there is: hinge coordinates and rates by the names of their speeds, tips by those of result tables.
std::vector<LinearOutput> all_outputs(const Configuration& c) {
  const Layout& layout = c.layout();
  const State& state = c.state();
  const auto n = static_cast<Eigen::Index>(layout.speeds);
  std::vector<LinearOutput> outputs;
  const auto add = [&](std::string name, double value) -> Eigen::RowVectorXd& {
    outputs.push_back({std::move(name), value, Eigen::RowVectorXd::Zero(2 * n)});
    return outputs.back().row;
  };
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    const Slot& slot = layout.hinges[h];
    for (std::size_t i = 0; i < slot.speeds; ++i) {
      // Where coordinates are a quaternion the output is the rotation from it, zero here.
      const double value = slot.positions == slot.speeds ? state.y[slot.position + i] : 0.0;
      add(layout.speed_names[slot.speed + i], value)[static_cast<Eigen::Index>(slot.speed + i)] = 1;
    }
  }
  for (const std::size_t s : hinge_speeds(c.layout()))
    add(layout.speed_names[s] + ".rate", state.y[layout.positions + s])[n + static_cast<Eigen::Index>(s)] = 1;
  const char* axes = "xyz";
  for (const Tip& tip : tips(c.prepared().model())) {
    const FrameTangent t = c.dynamics().frame(state.y, tip.tip.body, tip.tip.frame);
    // Of a body in segments the deflection of the last one says little: its tip is among the positions.
    for (Eigen::Index i = 0; i < 3 && tip.flexible && !tip.in_segments(); ++i)
      add(fmt::format("{}.tip.deflection_{}", tip.body, axes[i]), t.deflection[i]).head(n) =
          t.deflection_by_position.row(i);
    for (Eigen::Index i = 0; i < 3; ++i)
      add(fmt::format("{}.tip.{}", tip.body, axes[i]), t.position[i]).head(n) = t.by_position.row(i);
  }
  return outputs;
}

/// The outputs asked for: by their names, or by the beginnings of names up to a dot ("shoulder", "link1.tip").
std::vector<LinearOutput> chosen_outputs(std::vector<LinearOutput> all, const std::vector<std::string>& names) {
  if (names.empty()) return all;
  std::vector<LinearOutput> chosen;
  for (const std::string& name : names) {
    const std::size_t before = chosen.size();
    for (const LinearOutput& o : all) {
      if (o.name == name || o.name.starts_with(name + '.')) chosen.push_back(o);
    }
    if (chosen.size() > before) continue;
    std::string known;
    for (const LinearOutput& o : all) known += (known.empty() ? "" : ", ") + o.name;
    throw OptionError("outputs", "no '" + name + "'; known: " + known);
  }
  return chosen;
}

std::vector<std::size_t> chosen_inputs(const Configuration& c, const std::vector<std::string>& names) {
  std::vector<std::size_t> inputs;
  if (names.size() == 1 && names[0] == "all") {
    for (std::size_t s = 0; s < c.layout().speeds; ++s) inputs.push_back(s);
  } else if (names.empty()) {
    inputs = hinge_speeds(c.layout());
  } else {
    for (const std::string& name : names) {
      for (const std::size_t s : speeds_of(c.prepared().model(), name, "inputs")) inputs.push_back(s);
    }
    for (const std::size_t s : inputs) {
      if (c.held()[s]) throw OptionError("inputs", c.layout().speed_names[s] + " is held: no effort moves it");
    }
  }
  std::erase_if(inputs, [&](std::size_t s) { return c.held()[s]; });
  return inputs;
}

/// Whether no mode moves; hinges may turn steadily.
bool at_rest(const Configuration& c) {
  for (const Slot& slot : c.layout().bodies) {
    for (std::size_t i = 0; i < slot.speeds; ++i) {
      if (c.state().y[c.layout().positions + slot.speed + i] != 0) return false;
    }
  }
  return true;
}

/// Whether the continuous states of loads stay what they are.
bool states_rest(const Configuration& c) {
  const Layout& layout = c.layout();
  const EquationsOfMotion& equations = *c.prepared().equations;
  Work work = equations.make_work();
  std::vector<double> y_dot(layout.size());
  if (layout.continuous == 0) return true;
  if (!equations.derivatives(c.state().time, c.state().y, y_dot, work).ok()) return false;
  for (std::size_t i = layout.positions + layout.speeds; i < layout.moving(); ++i)
    if (std::abs(y_dot[i]) > 1e-9 * (1 + std::abs(c.state().y[i]))) return false;
  return true;
}

/// What rounding leaves of accelerations in equilibrium: of terms M⁻¹ K q, to four digits more than they have.
double acceleration_tolerance(const Configuration& c, const FirstOrderForm& form) {
  double greatest = 0;
  for (std::size_t i = 0; i < c.layout().positions; ++i) greatest = std::max(greatest, std::abs(c.state().y[i]));
  return 1e-9 + (form.A.size() > 0 ? 1e-12 * form.A.cwiseAbs().maxCoeff() * greatest : 0.0);
}

/// Rows of all speeds' displacements and rates, for the free ones alone.
Eigen::MatrixXd rows_of_free(const std::vector<LinearOutput>& outputs, const std::vector<Eigen::Index>& free,
                             Eigen::Index states) {
  const auto m = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(outputs.size()), states);
  for (Eigen::Index k = 0; k < C.rows(); ++k) {
    const Eigen::RowVectorXd& row = outputs[static_cast<std::size_t>(k)].row;
    for (Eigen::Index i = 0; i < m; ++i) {
      C(k, i) = row[free[static_cast<std::size_t>(i)]];
      C(k, m + i) = row[row.size() / 2 + free[static_cast<std::size_t>(i)]];
    }
  }
  return C;
}

}  // namespace

LinearModel linear_model(const Configuration& c, const Ports& ports) {
  const std::vector<std::string>& names = c.layout().speed_names;
  const std::vector<std::size_t> inputs = chosen_inputs(c, ports.inputs);
  const std::vector<LinearOutput> outputs = chosen_outputs(all_outputs(c), ports.outputs);
  const Eigen::VectorXd a = accelerations(c.dynamics(), c.state(), c.held());
  const Tangents tangents = c.dynamics().tangents(c.state().time, c.state().y, a);
  const FirstOrderForm form = whole_first_order_form(tangents, c.held());
  const std::vector<Eigen::Index> free = free_speeds(c.held());

  LinearModel linear;
  linear.derivatives = derivatives_text(tangents);
  linear.A = form.A;
  linear.B.resize(form.B.rows(), static_cast<Eigen::Index>(inputs.size()));
  linear.C = rows_of_free(outputs, free, form.A.rows());
  double greatest = 0;
  for (const Eigen::Index s : free) {
    linear.states.push_back(names[static_cast<std::size_t>(s)]);
    linear.accelerations.emplace_back(linear.states.back(), a[s]);
    greatest = std::max(greatest, std::abs(a[s]));
  }
  for (std::size_t i = 0; i < free.size(); ++i) linear.states.push_back(linear.states[i] + ".rate");
  linear.states.insert(linear.states.end(), c.layout().continuous_names.begin(), c.layout().continuous_names.end());
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    linear.inputs.push_back(names[inputs[k]]);
    linear.B.col(static_cast<Eigen::Index>(k)) = form.B.col(static_cast<Eigen::Index>(inputs[k]));
  }
  for (const LinearOutput& o : outputs) {
    linear.outputs.push_back(o.name);
    linear.output_values.push_back(o.value);
  }
  linear.equilibrium = at_rest(c) && states_rest(c) && greatest <= acceleration_tolerance(c, form);
  return linear;
}

}  // namespace withy::study
