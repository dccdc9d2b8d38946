#include "withy/bindings/fmi/variables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "withy/bindings/fmi/scene_numbers.hpp"
#include "withy/core/model/acting_event.hpp"
#include "withy/core/model/closing.hpp"
#include "withy/core/model/hosted_motion.hpp"
#include "withy/core/simulation/instants.hpp"
#include "withy/results/result_columns.hpp"
#include "withy/scene/sha256.hpp"
#include "withy/study/input_error.hpp"

namespace withy::fmi {
namespace {

using Kind = Variable::Kind;

/// The names of the numbers in y that move, as the tables have them: positions, speeds, continuous states of loads.
std::vector<Column> state_columns(const Model& model) {
  const Layout& layout = model.layout();
  std::vector<Column> all(layout.moving());
  const auto put = [&](std::size_t first, const std::vector<Column>& columns) {
    for (std::size_t i = 0; i < columns.size(); ++i) all[first + i] = columns[i];
  };
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    put(layout.hinges[h].position, coordinate_columns(model.hinges()[h]));
    put(layout.positions + layout.hinges[h].speed, rate_columns(model.hinges()[h]));
  }
  for (const Slot& body : layout.bodies) {
    for (std::size_t i = 0; i < body.speeds; ++i) {
      all[body.position + i] = {layout.speed_names[body.speed + i], "1"};
      all[layout.positions + body.speed + i] = {layout.speed_names[body.speed + i] + ".rate", "1/s"};
    }
  }
  for (std::size_t i = 0; i < layout.continuous; ++i)
    all[layout.positions + layout.speeds + i] = {layout.continuous_names[i], ""};
  return all;
}

std::string per_second(const std::string& unit) {
  if (unit.empty() || unit == "1") return unit.empty() ? "" : "1/s";
  return unit.ends_with("/s") ? unit + "^2" : unit + "/s";
}

void add_states(Variables& v, const Model& model, const State& initial) {
  const std::vector<Column> columns = state_columns(model);
  v.states = columns.size();
  State begun = initial;
  model.begin_continuous(begun);
  for (std::size_t i = 0; i < v.states; ++i) {
    v.all.push_back({Kind::state, i, columns[i].name, columns[i].unit, {}, initial.y[i]});
    v.all.back().begun = i >= v.states - model.layout().continuous && begun.y[i] == initial.y[i];
  }
  if (!loops_of(model).empty()) {
    const Layout& layout = model.layout();
    const auto closes = [&](const Slot& slot) {
      for (std::size_t i = 0; i < slot.positions; ++i) v.all[v.state(slot.position + i)].closes = true;
      for (std::size_t i = 0; i < slot.speeds; ++i) v.all[v.state(layout.positions + slot.speed + i)].closes = true;
    };
    for (std::size_t h = 0; h < layout.hinges.size(); ++h)
      if (!model.driven(h)) closes(layout.hinges[h]);
    std::for_each(layout.bodies.begin(), layout.bodies.end(), closes);
  }
  for (std::size_t i = 0; i < v.states; ++i)
    v.all.push_back({Kind::derivative, i, "der(" + columns[i].name + ")", per_second(columns[i].unit), {}});
}

void add_inputs(Variables& v, const Model& model, const State& initial) {
  for (std::size_t l = 0; l < model.loads().size(); ++l) {
    const LoadNode& load = model.loads()[l];
    const InputPort* port = load.load->input();
    if (port == nullptr) continue;
    const double value = port->value(initial.time, load.discrete(std::span(initial.y)));
    const char* kind = hosted_motion(*load.load) != nullptr ? "motion '" : "load '";
    v.all.push_back({Kind::input, l, load.name, port->unit(), kind + load.name + "'", value});
    ++v.inputs;
  }
}

/// Columns that are no states: what tables show of a state, then the sensors. Work is what a run integrates beside.
void add_outputs(Variables& v, const study::Prepared& prepared) {
  const ResultColumns table(prepared.model(), *prepared.equations, prepared.scene.outputs);
  const std::size_t own = ResultColumns(prepared.model(), *prepared.equations).columns().size();
  std::set<std::string> known;
  for (const Variable& variable : v.all) known.insert(variable.name);
  for (std::size_t c = 0; c < table.columns().size(); ++c) {
    const Column& column = table.columns()[c];
    if (c < own && (known.contains(column.name) || column.name == "work")) continue;
    Variable output{Kind::output, c, column.name, column.unit, {}};
    output.of_state_alone = c < own && column.name.find(".motion_effort") == std::string::npos;
    v.all.push_back(std::move(output));
    ++v.outputs;
  }
}

/// Numbers of loads change nothing but efforts, and may be changed at any time: but not where a function of them
/// switches the load, which would jump, nor what its clock is made of.
bool is_tunable(const Model& model, const std::string& path) {
  if (!path.starts_with("loads.") || path.ends_with(".sample") || path.ends_with(".delay")) return false;
  const auto named = [&](const LoadNode& load) { return path.starts_with("loads." + load.name + '.'); };
  const auto load = std::find_if(model.loads().begin(), model.loads().end(), named);
  if (load == model.loads().end()) return false;
  const DiscretePart* part = load->load->discrete();
  return part == nullptr || part->switches() == 0;
}

}  // namespace

std::size_t indicator_count(const Scene& scene) {
  std::size_t count = scene.events.size();
  for (const LoadSlot& slot : scene.model->layout().discrete_slots)
    count += scene.model->loads()[slot.load].load->discrete()->switches();
  if (const EventBook book(*scene.model); book.any())
    for (const ActingEvent& event : book.plan().events) count += event.when == ActingEvent::When::passes ? 1 : 0;
  return count;
}

Variables variables_of(const study::Prepared& prepared, Registry& registry) {
  const std::string& file = prepared.scene.file;
  study::check_one_formulation(prepared, "an FMU");
  if (const std::string acting = acting_event(prepared.model()); !acting.empty())
    throw study::InputError(
        fmt::format("{}: /events/{}: an event acts on the motion, which an FMU cannot carry; leave "
                    "it to the importer",
                    file, acting));
  Variables v;
  v.all.push_back({Kind::time, 0, "t", "s", "time"});
  add_states(v, prepared.model(), prepared.scene.initial);
  // Motions of hosts begin where the hinges are.
  add_inputs(v, prepared.model(), begun(prepared.model(), *prepared.equations, prepared.scene.initial));
  add_outputs(v, prepared);
  SignalUnits units;
  for (const Variable& variable : v.all) units.emplace(variable.name, variable.unit);
  for (const SceneNumber& n : scene_numbers(prepared.scene, registry, units)) {
    v.all.push_back(
        {Kind::parameter, v.parameters++, n.path, n.unit == "1" ? "" : n.unit, n.meaning, n.value, n.least, n.most});
    v.all.back().tunable = is_tunable(prepared.model(), n.path);
  }
  v.indicators = indicator_count(prepared.scene);
  for (std::size_t i = 0; i < v.indicators; ++i)
    v.all.push_back({Kind::indicator, i, fmt::format("event_indicator[{}]", i), "", "its zeros are events"});
  std::set<std::string> names;
  for (const Variable& variable : v.all)
    if (!names.insert(variable.name).second)
      throw study::InputError(
          fmt::format("{}: two variables of the FMU would be called '{}': give the load, motion or output another name",
                      file, variable.name));
  return v;
}

std::string token_of(const study::Prepared& prepared, const Variables& variables) {
  Sha256 hash;
  const auto add = [&](std::string_view text) {
    hash.add(text);
    hash.add(std::string_view("\0", 1));
  };
  add("withy " WITHY_VERSION);
  add(prepared.scene.sha256);
  add(prepared.scene.formulation_name);
  add(prepared.scene.integrator_name);
  for (const std::string& setting : prepared.scene.settings) add(setting);
  for (const FileUsed& file : prepared.scene.sources.files) add(file.sha256);
  for (const Variable& v : variables.all) add(fmt::format("{} {} {}", v.name, v.unit, v.start));
  const std::string d = hash.digest();
  return fmt::format("{}-{}-5{}-8{}-{}", d.substr(0, 8), d.substr(8, 4), d.substr(12, 3), d.substr(15, 3),
                     d.substr(18, 12));
}

}  // namespace withy::fmi
