#include "withy/apps/withy/engine.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "withy/program/log.hpp"
#include "withy/program/progress.hpp"
#include "withy/results/scene_edit.hpp"
#include "withy/scene/asked_outputs.hpp"

namespace withy::app {
namespace {

/// A file that cannot be read is bad input.
template <class Function>
auto as_input(Function&& function) {
  try {
    return function();
  } catch (const std::system_error& e) {
    throw InputError(e.what());
  }
}

void log_what_there_is(const Engine& engine, const PluginHost& host) {
  const auto& bodies = engine.model().bodies();
  program::log(fmt::format("{}: {} bodies, {} generalized speeds", engine.scene().file, bodies.size(),
                           engine.model().layout().speeds));
  for (const PluginRecord& p : host.plugins()) {
    const std::string file = p.file.string();
    if (p.state == PluginRecord::State::loaded) program::log(fmt::format("plugin {}/{} from {}", p.kind, p.id, file));
    if (p.state == PluginRecord::State::refused) program::log(fmt::format("refused {}: {}", file, p.reason));
  }
  for (const std::string& saving : engine.equations().savings()) program::log("compiled: " + saving);
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
  host_.attach(*registry_);
}

void check_write(const std::string& file, const SceneArguments& arguments, const Engine& engine,
                 const std::string& also_read) {
  if (file.empty()) return;
  if (!arguments.options.overrides.empty())
    throw InputError("--write takes the scene as its file has it: put what --set changes into the file first");
  check_written(engine.prepared(), file, also_read, engine.registry());
}

SceneValues read_values(const SceneArguments& arguments) {
  return as_input([&] {
    SceneValues values = SceneValues::read(arguments.scene);
    ask_outputs(values.apply(arguments.options), arguments.outputs);
    return values;
  });
}

Engine::Engine(const SceneArguments& arguments, std::size_t threads)
    : plugins_(arguments), prepared_(study::prepare(read_values(arguments), registry())) {
  if (arguments.verbose) log_what_there_is(*this, plugins_.host());
  const std::string refusal = threads > 1 ? study::use_threads(prepared_, threads) : "";
  if (!refusal.empty()) complain("--threads: one evaluates all: " + refusal);
}

State Engine::state(const std::string& file) const { return read_state(prepared_, file).state; }

StateAsGiven read_state(const study::Prepared& prepared, const std::string& file) {
  if (file.empty()) return prepared.scene.initial;
  return as_input([&] { return read_state_as_given(file, prepared.scene); });
}

study::Control run_control(const std::string& label) {
  program::watch_for_interrupt();
  const auto progress = std::make_shared<program::Progress>(label);
  return {program::interrupted, [progress](double done, double all) { progress->at(done, all); }};
}

std::pair<study::Control, std::function<void(const std::string&)>> told_control(const std::string& label) {
  program::watch_for_interrupt();
  const auto progress = std::make_shared<program::Progress>(label);
  progress->begin();
  return {{program::interrupted, [progress](double done, double all) { progress->of_points(done, all); }},
          [progress](const std::string& text) { progress->note(text); }};
}
study::Control study_control(const std::string& label) { return told_control(label).first; }

}  // namespace withy::app
