#include "withy/study/linear_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "withy/core/model/columns.hpp"
#include "withy/core/model/hosted_motion.hpp"
#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

LinearInput input_of_load(const SmallMotions& motions, std::size_t load) {
  const LoadNode& node = motions.model().loads()[load];
  const InputPort& port = *node.load->input();
  const State& at = motions.state();
  const double value = port.value(at.time, node.discrete(std::span<const double>(at.y)));
  auto state_at = [&motions, &node, &port, value](double h) {
    State state = motions.state();
    port.set(state.time, state.time, value + h, node.discrete(std::span<double>(state.y)));
    return state;
  };
  // What it does is in proportion to its value.
  Eigen::VectorXd efforts = 0.5 * (motions.efforts(state_at(1), load) - motions.efforts(state_at(-1), load));
  return {{node.name, port.unit()}, std::move(efforts), std::move(state_at)};
}

LinearInput input_of_speed(const SmallMotions& motions, std::size_t speed) {
  const Model& model = motions.model();
  const Eigen::VectorXd one = Eigen::VectorXd::Unit(motions.by_effort().cols(), static_cast<Eigen::Index>(speed));
  return {{model.layout().speed_names[speed], unit_of_effort(model, speed)}, one, [&motions, one](double h) {
            return motions.pushed(h * one);
          }};
}

std::vector<std::size_t> input_loads(const Model& model) {
  std::vector<std::size_t> loads;
  for (std::size_t l = 0; l < model.loads().size(); ++l)
    if (model.loads()[l].load->input() != nullptr && hosted_motion(*model.loads()[l].load) == nullptr)
      loads.push_back(l);
  return loads;
}

/// The speeds that names stand for which are no input loads.
std::vector<std::size_t> named_speeds(const Configuration& c, const std::string& name) {
  const Model& model = c.prepared().model();
  std::vector<std::size_t> speeds;
  try {
    speeds = speeds_of(model, name, "inputs");
  } catch (const OptionError& e) {
    std::vector<std::string> inputs;
    for (const std::size_t l : input_loads(model)) inputs.push_back(model.loads()[l].name);
    const std::string problem = std::string(e.what()).substr(std::string("inputs: ").size());
    throw OptionError("inputs", inputs.empty()
                                    ? problem
                                    : fmt::format("{}; loads of the type input: {}", problem, fmt::join(inputs, ", ")));
  }
  const Held kept = c.kept();
  for (const std::size_t s : speeds)
    if (kept[s]) throw OptionError("inputs", c.layout().speed_names[s] + " is held: no effort moves it");
  return speeds;
}

}  // namespace

std::vector<LinearInput> chosen_inputs(const Configuration& c, const SmallMotions& motions,
                                       const std::vector<std::string>& names) {
  const Model& model = c.prepared().model();
  const std::vector<std::size_t> loads = input_loads(model);
  std::vector<LinearInput> drives;
  const Held kept = c.kept();
  const auto add_speeds = [&](const std::vector<std::size_t>& speeds) {
    for (const std::size_t s : speeds)
      if (!kept[s]) drives.push_back(input_of_speed(motions, s));
  };
  if (names.size() == 1 && names[0] == "all") {
    std::vector<std::size_t> every(c.layout().speeds);
    for (std::size_t s = 0; s < every.size(); ++s) every[s] = s;
    add_speeds(every);
  } else if (names.empty()) {
    for (const std::size_t l : loads) drives.push_back(input_of_load(motions, l));
    if (loads.empty()) add_speeds(hinge_speeds(c.layout()));
  }
  for (const std::string& name : names) {
    if (name == "all" && names.size() == 1) break;
    const auto load =
        std::find_if(loads.begin(), loads.end(), [&](std::size_t l) { return model.loads()[l].name == name; });
    if (load != loads.end())
      drives.push_back(input_of_load(motions, *load));
    else
      add_speeds(named_speeds(c, name));
  }
  return drives;
}

}  // namespace withy::study
