#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "withy/apps/withy/analysis.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/core/analysis/modes.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/results/json_text.hpp"

namespace withy::app {
namespace {

using Json = nlohmann::ordered_json;

/// An output y = value + row · (δ, δu) of all speeds.
struct Output {
  std::string name;
  double value = 0;
  Eigen::RowVectorXd row;
};

/// Every output there is: hinge coordinates and rates by the names of their speeds, tips by those of result tables.
std::vector<Output> all_outputs(const Configuration& c) {
  const Layout& layout = c.layout();
  const State& state = c.state();
  const auto n = static_cast<Eigen::Index>(layout.speeds);
  std::vector<Output> outputs;
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
  for (const std::size_t s : c.hinge_speeds())
    add(layout.speed_names[s] + ".rate", state.y[layout.positions + s])[n + static_cast<Eigen::Index>(s)] = 1;
  const char* axes = "xyz";
  for (const Tip& tip : tips(c.engine().model())) {
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
std::vector<Output> chosen_outputs(std::vector<Output> all, const std::vector<std::string>& names) {
  if (names.empty()) return all;
  std::vector<Output> chosen;
  for (const std::string& name : names) {
    const std::size_t before = chosen.size();
    for (const Output& o : all) {
      if (o.name == name || o.name.starts_with(name + '.')) chosen.push_back(o);
    }
    if (chosen.size() > before) continue;
    std::string known;
    for (const Output& o : all) known += (known.empty() ? "" : ", ") + o.name;
    throw InputError("--outputs: no '" + name + "'; known: " + known);
  }
  return chosen;
}

std::vector<std::size_t> chosen_inputs(const Configuration& c, const std::vector<std::string>& names) {
  std::vector<std::size_t> inputs;
  if (names.size() == 1 && names[0] == "all") {
    for (std::size_t s = 0; s < c.layout().speeds; ++s) inputs.push_back(s);
  } else if (names.empty()) {
    inputs = c.hinge_speeds();
  } else {
    for (const std::string& name : names) {
      for (const std::size_t s : c.speeds_of(name, "--inputs")) inputs.push_back(s);
    }
    for (const std::size_t s : inputs) {
      if (c.held()[s]) throw InputError("--inputs: " + c.layout().speed_names[s] + " is held: no effort moves it");
    }
  }
  std::erase_if(inputs, [&](std::size_t s) { return c.held()[s]; });
  return inputs;
}

Json rows_json(const Eigen::MatrixXd& m) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    const Eigen::VectorXd row = m.row(i);
    rows.push_back(std::vector<double>(row.data(), row.data() + row.size()));
  }
  return rows;
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

/// What rounding leaves of accelerations in equilibrium: of terms M⁻¹ K q, to four digits more than they have.
double acceleration_tolerance(const Configuration& c, const FirstOrderForm& form) {
  double greatest = 0;
  for (std::size_t i = 0; i < c.layout().positions; ++i) greatest = std::max(greatest, std::abs(c.state().y[i]));
  return 1e-9 + (form.A.size() > 0 ? 1e-12 * form.A.cwiseAbs().maxCoeff() * greatest : 0.0);
}

}  // namespace

ExitStatus linearize(const LinearizeArguments& arguments) {
  const Configuration c(arguments);
  const Layout& layout = c.layout();
  const std::vector<std::size_t> inputs = chosen_inputs(c, arguments.inputs);
  const std::vector<Output> outputs = chosen_outputs(all_outputs(c), arguments.outputs);
  Eigen::VectorXd a;
  Tangents tangents;
  FirstOrderForm form;
  try {
    a = accelerations(c.dynamics(), c.state(), c.held());
    tangents = c.dynamics().tangents(c.state().time, c.state().y, a);
    form = first_order_form(tangents, c.held());
  } catch (const std::domain_error& e) {
    complain(e.what());
    return ExitStatus::stopped;
  }
  const std::vector<Eigen::Index> free = free_speeds(c.held());
  const auto m = static_cast<Eigen::Index>(free.size());

  std::vector<std::string> states, input_names, output_names;
  for (const Eigen::Index s : free) states.push_back(layout.speed_names[static_cast<std::size_t>(s)]);
  for (Eigen::Index i = 0; i < m; ++i) states.push_back(states[static_cast<std::size_t>(i)] + ".rate");
  Eigen::MatrixXd B(2 * m, static_cast<Eigen::Index>(inputs.size()));
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    input_names.push_back(layout.speed_names[inputs[k]]);
    B.col(static_cast<Eigen::Index>(k)) = form.B.col(static_cast<Eigen::Index>(inputs[k]));
  }
  Eigen::MatrixXd C(static_cast<Eigen::Index>(outputs.size()), 2 * m);
  Json values = Json::array();
  const auto n = static_cast<Eigen::Index>(layout.speeds);
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    output_names.push_back(outputs[k].name);
    values.push_back(outputs[k].value);
    for (Eigen::Index i = 0; i < m; ++i) {
      C(row, i) = outputs[k].row[free[static_cast<std::size_t>(i)]];
      C(row, m + i) = outputs[k].row[n + free[static_cast<std::size_t>(i)]];
    }
  }

  Json residual = Json::object();
  double greatest = 0;
  for (const Eigen::Index s : free) {
    residual[layout.speed_names[static_cast<std::size_t>(s)]] = a[s];
    greatest = std::max(greatest, std::abs(a[s]));
  }
  Json j;
  j["scene"] = c.engine().scene().file;
  j["formulation"] = c.engine().scene().formulation_name;
  j["state"] = Json::parse(write_state(c.engine().model(), c.state()));
  j["held"] = held_names(c);
  j["states"] = states;
  j["inputs"] = input_names;
  j["outputs"] = output_names;
  j["output_values"] = values;
  j["A"] = rows_json(form.A);
  j["B"] = rows_json(B);
  j["C"] = rows_json(C);
  j["D"] = rows_json(Eigen::MatrixXd::Zero(C.rows(), B.cols()));
  j["accelerations"] = residual;
  j["equilibrium"] = at_rest(c) && greatest <= acceleration_tolerance(c, form);
  j["derivatives"] = derivatives_text(tangents);
  print(json_text(j));
  return ExitStatus::done;
}

}  // namespace withy::app
