#include "withy/results/linear_files.hpp"

#include <nlohmann/json.hpp>

#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> names_of(const std::vector<Column>& columns) {
  std::vector<std::string> names;
  for (const Column& c : columns) names.push_back(c.name);
  return names;
}

std::vector<std::string> units_of(const std::vector<Column>& columns) {
  std::vector<std::string> units;
  for (const Column& c : columns) units.push_back(c.unit);
  return units;
}

}  // namespace

Json rows_json(const Eigen::MatrixXd& m) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    const Eigen::VectorXd row = m.row(i);
    rows.push_back(std::vector<double>(row.data(), row.data() + row.size()));
  }
  return rows;
}

Json turning_json(const study::LinearModel& linear) {
  return {{"loads", linear.turning_loads},
          {"inputs", linear.turning_inputs},
          {"outputs", linear.turning_outputs},
          {"timed_outputs", linear.timed_outputs},
          {"moving_outputs", linear.moving_outputs}};
}

Json linear_model_json(const study::Configuration& c, const study::LinearModel& linear) {
  Json accelerations = Json::object();
  for (const auto& [name, value] : linear.accelerations) accelerations[name] = value;
  const LinearSystem& s = linear.system;
  Json j;
  j["scene"] = c.prepared().scene.file;
  j["formulation"] = c.prepared().scene.formulation_name;
  j["state"] = Json::parse(write_state(c.prepared().model(), c.state()));
  if (!c.closing().empty()) j["closing"] = c.closing();
  j["held"] = c.held_names();
  j["period"] = s.period;
  j["states"] = linear.states;
  j["inputs"] = names_of(linear.inputs);
  j["input_units"] = units_of(linear.inputs);
  j["outputs"] = names_of(linear.outputs);
  j["output_units"] = units_of(linear.outputs);
  j["output_values"] = linear.output_values;
  j["A"] = rows_json(s.A);
  j["B"] = rows_json(s.B);
  j["C"] = rows_json(s.C);
  j["D"] = rows_json(s.D);
  j["accelerations"] = accelerations;
  j["equilibrium"] = linear.equilibrium;
  j["frozen"] = linear.frozen;
  j["shaking"] = linear.shaking;
  j["turning"] = turning_json(linear);
  j["changing"] = linear.changing;
  j["limited"] = linear.limited;
  j["derivatives"] = linear.derivatives;
  j["output_derivatives"] = linear.output_derivatives;
  return j;
}

std::vector<NamedArray> linear_model_arrays(const study::LinearModel& linear) {
  const LinearSystem& s = linear.system;
  return {{"A", s.A},
          {"B", s.B},
          {"C", s.C},
          {"D", s.D},
          {"period", Eigen::MatrixXd(Eigen::MatrixXd::Constant(1, 1, s.period))},
          {"states", linear.states},
          {"inputs", names_of(linear.inputs)},
          {"input_units", units_of(linear.inputs)},
          {"outputs", names_of(linear.outputs)},
          {"output_units", units_of(linear.outputs)},
          {"output_values", Eigen::MatrixXd(Eigen::Map<const Eigen::VectorXd>(
                                linear.output_values.data(), static_cast<Eigen::Index>(linear.output_values.size())))}};
}

std::vector<std::string> linear_model_content() { return {"linear.json", "linear.mat", "linear.npz"}; }

void write_linear_model(const std::filesystem::path& folder, const Json& content, const study::LinearModel& linear) {
  const std::vector<NamedArray> arrays = linear_model_arrays(linear);
  write_file(folder / "linear.json", json_text(content));
  write_file(folder / "linear.mat", mat_file(arrays));
  write_file(folder / "linear.npz", npz_file(arrays));
}

}  // namespace withy
