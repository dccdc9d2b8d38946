/// \file
/// A scene with the plugins it is made of and its equations of motion: what every command starts from.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "withy/apps/withy/command.hpp"
#include "withy/plugins/host/plugin_host.hpp"
#include "withy/scene/state_as_given.hpp"
#include "withy/study/control.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/prepared.hpp"

namespace withy::app {

using study::InputError;

/// The plugins of the folders the command line names and of the program's own.
class Plugins {
 public:
  /// \throws InputError where a folder is none.
  explicit Plugins(const CommonArguments& arguments);
  [[nodiscard]] Registry& registry() const { return *registry_; }
  [[nodiscard]] const PluginHost& host() const { return host_; }

 private:
  PluginHost host_;
  std::unique_ptr<Registry> registry_;
};

/// The values of the scene file, as the command line changes them. \throws SceneError, InputError
SceneValues read_values(const SceneArguments& arguments);

class Engine {
 public:
  /// Reads the scene, loads what it names and compiles it. Where branches of its tree cannot be evaluated on as many
  /// threads as asked for, it says why on standard error.
  /// \throws SceneError, InputError; PluginError where a plugin is refused.
  explicit Engine(const SceneArguments& arguments, std::size_t threads = 1);
  [[nodiscard]] const study::Prepared& prepared() const { return prepared_; }
  [[nodiscard]] const Scene& scene() const { return prepared_.scene; }
  [[nodiscard]] const Model& model() const { return prepared_.model(); }
  [[nodiscard]] const EquationsOfMotion& equations() const { return *prepared_.equations; }
  [[nodiscard]] const Plugins& plugins() const { return plugins_; }
  [[nodiscard]] Registry& registry() const { return plugins_.registry(); }
  /// The state of a file, or the scene's initial state where the name is empty.
  [[nodiscard]] State state(const std::string& file) const;

 private:
  Plugins plugins_;
  study::Prepared prepared_;
};

/// For commands that write the scene anew, as its file has it. \throws InputError, SceneError where --set changes it,
/// or as check_written
void check_write(const std::string& file, const SceneArguments& arguments, const Engine& engine,
                 const std::string& also_read = {});

/// The state of a file for a scene, or the scene's initial state where the name is empty. \throws SceneError,
/// InputError
StateAsGiven read_state(const study::Prepared& prepared, const std::string& file);

/// A simulation of the command line's: shows the time reached on standard error where that is a terminal, and ends at
/// SIGINT.
study::Control run_control(const std::string& label);
/// The same for a study of many points.
study::Control study_control(const std::string& label);
/// The same, and what tells a finding: a line that stays.
std::pair<study::Control, std::function<void(const std::string&)>> told_control(const std::string& label);

}  // namespace withy::app
