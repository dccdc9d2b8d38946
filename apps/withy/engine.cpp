#include "withy/apps/withy/engine.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <filesystem>
#include <system_error>

#include "withy/apps/withy/progress.hpp"

namespace withy::app {
namespace {

/// A file that cannot be read is bad input, as is a formulation that cannot treat the model.
template <class Function>
auto as_input(const std::string& what, Function&& function) {
  try {
    return function();
  } catch (const std::system_error& e) {
    throw InputError(e.what());
  } catch (const std::invalid_argument& e) {
    throw InputError(what + ": " + e.what());
  }
}

/// Standard output carries results alone, so the log goes to standard error.
void start_log(bool verbose) {
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("withy", std::make_shared<spdlog::sinks::stderr_color_sink_mt>()));
  spdlog::set_pattern("%T.%e %v");
  spdlog::set_level(verbose ? spdlog::level::debug : spdlog::level::off);
}

std::vector<std::filesystem::path> plugin_folders(const CommonArguments& arguments) {
  std::vector<std::filesystem::path> folders;
  for (const std::string& folder : arguments.plugin_directories) {
    if (!std::filesystem::is_directory(folder)) throw InputError("--plugins: " + folder + " is no folder");
    folders.emplace_back(folder);
  }
  folders.push_back(PluginHost::default_directory());
  return folders;
}

}  // namespace

Plugins::Plugins(const CommonArguments& arguments)
    : host_(plugin_folders(arguments)), registry_(std::make_unique<Registry>()) {
  start_log(arguments.verbose);
  host_.attach(*registry_);
}

Engine::Engine(const SceneArguments& arguments)
    : plugins_(arguments),
      scene_(as_input(arguments.scene, [&] { return read_scene(arguments.scene, registry(), arguments.options); })),
      equations_(as_input(arguments.scene + ": formulation " + scene_.formulation_name,
                          [&] { return scene_.formulation->compile(scene_.model); })) {
  spdlog::debug("{}: {} bodies, {} generalized speeds", scene_.file, model().bodies().size(), model().layout().speeds);
  for (const PluginRecord& p : plugins_.host().plugins()) {
    if (p.state == PluginRecord::State::loaded) spdlog::debug("plugin {}/{} from {}", p.kind, p.id, p.file.string());
    if (p.state == PluginRecord::State::refused) spdlog::debug("refused {}: {}", p.file.string(), p.reason);
  }
  for (const std::string& saving : equations_->savings()) spdlog::debug("compiled: {}", saving);
  if (scene_.formulation_name == "auto") make_rungs();
}

void Engine::make_rungs() {
  for (const char* id : {"ruthless", "quadratic", "exact"}) {
    const auto* plugin = registry().find<Formulation>(id);
    if (plugin == nullptr) throw InputError(std::string("formulation auto needs '") + id + "', which is not found");
    Diagnostics diagnostics;
    const auto formulation = plugin->make(Value::map({}), {registry(), diagnostics});
    try {
      rung_equations_.push_back(formulation->compile(scene_.model));
    } catch (const std::invalid_argument&) {
      continue;  // a body without exact kinematics: the ladder ends before it
    }
    rungs_.push_back({id, formulation->terms(), rung_equations_.back().get()});
  }
}

std::string Engine::formulation_summary() const {
  const auto* plugin = registry().find<Formulation>(scene_.formulation_name);
  return plugin != nullptr ? plugin->summary : std::string();
}

State Engine::state(const std::string& file) const {
  if (file.empty()) return scene_.initial;
  return as_input(file, [&] { return read_state(file, *scene_.model, scene_.initial); });
}

RunOptions Engine::run_options() const {
  RunOptions options;
  options.end = end_of_run(scene_);
  options.output = scene_.output;
  options.deflection_limit = scene_.deflection_limit;
  options.interrupted = interrupted;
  options.events = scene_.events;
  return options;
}

EscalatedRun Engine::simulate_escalating(const std::function<void(const State&, std::size_t)>& output) const {
  for (const LoadNode& load : model().loads())
    if (load.load->discrete() != nullptr)
      throw InputError(scene_.file + ": /formulation: got 'auto', which changes the equations along a run; load '" +
                       load.name + "' has discrete states, which do not go over: name a formulation");
  const RunOptions options = run_options();
  watch_for_interrupt();
  Progress progress(scene_.formulation_name, options.end);
  return withy::simulate_escalating(*scene_.model, rungs_, *scene_.integrator, scene_.initial, options,
                                    [&](const State& state, std::size_t rung) {
                                      progress.at(state.time);
                                      output(state, rung);
                                    });
}

RunSummary Engine::simulate(const std::function<void(const State&)>& output, const SimulationExtras& extras) const {
  if (escalates()) return simulate_escalating([&](const State& state, std::size_t) { output(state); }).summary;
  RunOptions options = run_options();
  watch_for_interrupt();
  Progress progress(scene_.formulation_name, options.end);
  options.beyond = extras.beyond;
  options.checkpoint = extras.checkpoint;
  options.resume = extras.resume;
  options.seen = extras.seen;
  using Clock = std::chrono::steady_clock;
  const std::chrono::duration<double> interval(extras.checkpoint_seconds);
  Clock::time_point last = Clock::now();
  if (extras.checkpoint_seconds > 0) {
    options.put_down = [&] {
      const Clock::time_point now = Clock::now();
      if (now - last < interval) return false;
      last = now;
      return true;
    };
  }
  return withy::simulate(*scene_.model, *equations_, *scene_.integrator, scene_.initial, options,
                         [&](const State& state) {
                           progress.at(state.time);
                           output(state);
                         });
}

}  // namespace withy::app
