/// \file
/// A scene in a program: read, varied, run, and studied.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "withy/host/library.hpp"
#include "withy/host/questions.hpp"
#include "withy/scene/scene_error.hpp"

namespace withy::study {
struct Prepared;
}

namespace withy::host {

/// How a call that takes long is followed; both may be empty. They are called by the thread of the caller, but for
/// `trade`, where they are called by one thread at a time.
struct Follow {
  std::function<bool()> interrupted;                      ///< asked often: true ends the call soon
  std::function<void(double done, double all)> progress;  ///< time [s] of a run, or points of a study
};

/// What a run gave. The columns are those of results.csv.
struct Result {
  std::string status;   ///< as in run.json: "completed", "diverged", "load-failed" and others
  std::string message;  ///< the physical reason of a bad end; else what a completed run should not keep to itself
  std::vector<Port> columns;
  std::vector<double> values;  ///< row after row, as many numbers in each as there are columns, SI units
  std::string json;            ///< of run.json peaks, events, final state, certificate

  [[nodiscard]] std::size_t rows() const { return columns.empty() ? 0 : values.size() / columns.size(); }
  /// The numbers of a column. \throws std::out_of_range with the nearest name where there is none of this.
  [[nodiscard]] std::vector<double> column(std::string_view name) const;
};

/// What the motors of driven hinges would have to give.
struct Inverse {
  /// The effort on one driven speed, at the times of the outputs.
  struct Drive {
    Port effort_on;                    ///< name of the speed, unit of the effort: "N m" or "N"
    std::vector<double> effort, rate;  ///< [N m, N], [rad/s, m/s]
  };
  std::string json;           ///< what the program prints with `--json`: peaks, rms, power and work of each drive
  std::vector<double> times;  ///< [s]
  std::vector<Drive> drives;
  Result run;
};

/// A scene as a value: a copy is a scene of its own. Functions that need it made report every problem of the text and
/// of `set` at once. \throws SceneError; study::InputError where a choice cannot be; PluginError where a library is
/// refused: all of them std::runtime_error with the located text.
class Scene {
 public:
  /// \throws SceneError where the text cannot be read; std::system_error where the file cannot.
  static Scene read(const Library& library, const std::string& file);
  /// \param name stands for the file in messages; relative names of other files begin at its folder
  static Scene parse(const Library& library, std::string_view text, const std::string& name = "scene");
  /// The same with the folder that relative names of other files begin at, from the root on: folder() of a scene that
  /// was made of this text and name, in another process or where the working directory has changed since.
  static Scene parse(const Library& library, std::string_view text, const std::string& name, const std::string& folder);
  Scene(const Scene& other);
  Scene& operator=(const Scene& other);
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

  /// Sets a value by its path of keys, as "loads.slew.time_scale" or "gravity.1".
  Scene& set(std::string_view path, double value);
  /// The same with the value as a file has it: "25 mm", "[0, 0, 1]", "{name: rk4, step: 0.01}", "true".
  Scene& set(std::string_view path, std::string_view text);
  Scene& set(std::string_view path, const char* text) { return set(path, std::string_view(text)); }
  Scene& formulation(const std::string& id);
  Scene& integrator(const std::string& id);
  /// From now on runs, simulations and equations made of the scene evaluate the branches of its tree on that many
  /// threads, where it has some: the same results to the last bit, sooner where branches are large. Without a
  /// formulation that can, one thread evaluates all. \param count 1: no other thread; at most 256 \throws
  /// study::InputError where it is none of these
  Scene& threads(std::size_t count);
  /// Checks it, and that a run of it can begin, as the program's command `check` does. \throws as above.
  void check() const;

  /// What the scene was read from, and what was changed since, in its order: to make the same scene elsewhere.
  [[nodiscard]] const std::string& text() const;
  [[nodiscard]] const std::string& name() const;
  [[nodiscard]] const std::vector<std::string>& changes() const;  ///< "path=value"
  /// Where relative names of other files begin, whatever the working directory has become since.
  [[nodiscard]] const std::string& folder() const;
  /// Everything as it was written and set, without defaults, as JSON text: a scene again.
  /// \throws SceneError where the text or what was set cannot be understood
  [[nodiscard]] std::string values() const;

  /// Simulates to the end of the scene. A bad end is a status, not an exception.
  [[nodiscard]] Result run(const Follow& follow = {}) const;

  /// Studies as JSON text, in the form that the program's `--json` has.
  /// In all of them `outputs` names what errors are measured on, outputs that the scene does not define too
  /// (`"link1.tip"`, `"shoulder.effort"`); empty: the usual ones.
  /// Runs in several formulations and the distances of each from the reference. \param formulations empty: of the usual
  /// ones those that can treat the scene; `left_out` has the others
  [[nodiscard]] std::string compare(const std::vector<std::string>& formulations, const std::string& reference,
                                    const Follow& follow = {}, const std::vector<std::string>& outputs = {}) const;
  /// What `trade` and `advise` go over; empty: what the commands go over.
  struct Axes {
    std::vector<std::string> formulations, families;
    std::vector<int> modes;
    std::vector<std::string> integrators;
    std::vector<double> tolerances;
  };
  /// Error against cost; every point with whether it is on the front.
  [[nodiscard]] std::string trade(const Axes& axes, std::size_t jobs = 0, const Follow& follow = {},
                                  const std::vector<std::string>& outputs = {}) const;
  /// The cheapest model that holds an accuracy, "1%" or "1 mm, 0.1 deg"; "advice" is null where none does.
  [[nodiscard]] std::string advise(const std::string& accuracy, const std::vector<std::string>& outputs = {},
                                   const Axes& axes = {}, const Follow& follow = {}) const;
  /// \param seconds of CPU time that the search may cost; nothing, as above: 20 runs of the scene in `quadratic`, or
  /// 10 s if that is more
  [[nodiscard]] std::string advise(const std::string& accuracy, const std::vector<std::string>& outputs,
                                   const Axes& axes, const Follow& follow, std::optional<double> seconds) const;
  /// Modes about the steady state of the scene's initial state, hinges in `lock` held.
  [[nodiscard]] std::string modes(const std::vector<std::string>& lock = {}, const Follow& follow = {}) const;
  /// The same of what is wished: an element of the list `runs` that the command has, with `effective_mass` and
  /// `damping` where they are asked for.
  [[nodiscard]] std::string modes(const std::vector<std::string>& lock, const Follow& follow,
                                  const ModesWish& wish) const;
  /// The linear model of small motions about the scene's initial state: A, B, C, D with names and units.
  /// \param inputs loads of the type input, hinges whose efforts are inputs, or "all"; empty: every input load or,
  /// where there is none, every hinge \param outputs names or their beginnings; empty: the scene's, or all \param lock
  /// hinges that are held \throws SimulationStopped where the mass matrix of what is free is singular, or something is
  /// not finite
  [[nodiscard]] std::string linearize(const std::vector<std::string>& inputs = {},
                                      const std::vector<std::string>& outputs = {},
                                      const std::vector<std::string>& lock = {}) const;
  /// The same at a place.
  [[nodiscard]] std::string linearize(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs,
                                      const std::vector<std::string>& lock, const Place& place) const;
  /// Transfer function, poles, zeros, peaks and margins from one input to one output. \throws SimulationStopped as
  /// linearize; study::InputError too where the output does not feel the input
  [[nodiscard]] std::string response(const ResponseWish& wish, const std::vector<std::string>& lock = {},
                                     const Place& place = {}) const;
  /// The state that stays as it is, at rest or spinning steadily; "converged" is false and "message" says why where
  /// none is found. \throws SimulationStopped where something is not finite
  [[nodiscard]] std::string equilibrium(const std::vector<std::string>& lock = {}, const Place& place = {}) const;
  /// Simulates to the end of the scene and finds what its motions take. A bad end is a status.
  /// \param motion a table with columns t[s] and hinge coordinates in the place of the scene's motions
  [[nodiscard]] Inverse inverse(const Given& motion = {}, const Follow& follow = {}) const;

  [[nodiscard]] const Library& library() const;
  /// Made and compiled, for Simulation, Equations and the functions of `withy::study`.
  [[nodiscard]] std::shared_ptr<const study::Prepared> prepare() const;

 private:
  struct Parts;
  explicit Scene(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace withy::host
