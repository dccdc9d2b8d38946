/// \file
/// An instance of an FMU, the same in both versions of the standard: its modes, values, states and log.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "withy/bindings/fmi/dynamics.hpp"
#include "withy/core/simulation/session.hpp"

namespace withy::fmi {

/// In the order of both standards.
enum class Status { ok, warning, discard, error, fatal };

/// What of the standards' state machines tells calls apart.
enum class Mode : unsigned {
  instantiated = 1,
  initialization = 2,
  event = 4,
  continuous = 8,
  step = 16,
  intermediate = 32,  ///< inside the callback of a step
  terminated = 64
};
constexpr unsigned operator|(Mode a, Mode b) { return static_cast<unsigned>(a) | static_cast<unsigned>(b); }
constexpr unsigned operator|(unsigned a, Mode b) { return a | static_cast<unsigned>(b); }

enum class Kind { model_exchange, co_simulation };

/// Where the log goes, and whether the host hears what is no error.
struct Log {
  std::function<void(Status, const char* category, const char* message)> write;
  bool on = false;
  std::set<std::string> categories = {};  ///< that the host wants; empty: all
};
inline constexpr const char* log_errors = "logStatusError";
inline constexpr const char* log_discards = "logStatusDiscard";
inline constexpr const char* log_events = "logEvents";
inline constexpr const char* log_all = "logAll";

/// A saved state of an instance, as numbers.
struct SavedState {
  std::vector<double> numbers;
};

/// How a step of co-simulation ended.
struct StepEnd {
  bool reached = true;
  bool early = false;      ///< at the host's own request
  bool failed = false;     ///< it cannot go on from where it stands
  bool terminate = false;  ///< that, or an event of the scene that stops a run
  std::string reason = {};
};

/// Asked between the steps of the integrator: \returns the time at which the host wants the step to return; nothing:
/// it goes on.
using BetweenSteps = std::function<std::optional<double>(double time)>;

class Instance {
 public:
  /// \param resources folder of the FMU's resources
  /// \throws std::runtime_error where the scene in it cannot be had, or `token` is of another FMU.
  Instance(Kind kind, std::string name, std::string_view token, const std::string& resources, Log log);
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;
  virtual ~Instance();

  static constexpr std::uint64_t living = 0x7769746879464d55;
  std::uint64_t kind_of_handle = living;

  [[nodiscard]] Kind kind() const { return kind_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool is_in(unsigned modes) const { return (static_cast<unsigned>(mode_) & modes) != 0; }
  [[nodiscard]] const char* mode_name() const;
  [[nodiscard]] const Variables& variables() const { return variables_; }
  Log& log() { return log_; }
  void say(Status status, const char* category, const std::string& message) const;

  /// Takes effect when initialization begins. \throws std::invalid_argument where a number is not finite, or the stop
  /// lies before the start.
  void set_experiment(std::optional<double> tolerance, double start, std::optional<double> stop);
  /// \throws std::invalid_argument where the simulation would go to a time [s] beyond the host's own stop time
  void check_stop(double time) const;
  void enter_initialization();
  void exit_initialization();
  void enter(Mode mode) { mode_ = mode; }
  void reset();

  /// \throws std::out_of_range where there is no such variable.
  void get(std::span<const std::uint32_t> references, double* values);
  /// All or none. Tunable parameters set between steps act from now on: the scene is made anew, and goes on from where
  /// it stands. \throws std::invalid_argument where one cannot be set now, or to this value.
  void set(std::span<const std::uint32_t> references, const double* values);
  [[nodiscard]] const Variable& variable(std::uint32_t reference) const;

  /// Where it stands, with what was set.
  Dynamics& dynamics();

  /// Columns of the Jacobian times `along_knowns`. \throws std::invalid_argument where a variable has no part in it
  void directional(std::span<const std::uint32_t> unknowns, std::span<const std::uint32_t> knowns,
                   const double* along_knowns, double* sensitivity);
  /// Rows of the Jacobian times `along_unknowns`.
  void adjoint(std::span<const std::uint32_t> unknowns, std::span<const std::uint32_t> knowns,
               const double* along_unknowns, double* sensitivity);

  /// Into an array of a host. \throws std::invalid_argument where it has another size, or is null
  void give(std::span<const double> numbers, double* array, std::size_t count) const;
  void give_indicators(double* array, std::size_t count);
  void set_continuous(std::span<const double> x);

  StepEnd step(double from, double length, const BetweenSteps& between);

  SavedState* save();
  void restore(const SavedState* state);
  void forget(const SavedState* state);
  /// The same where it is one that this instance has saved.
  void forget_if_own(const SavedState* state) {
    if (saved_.contains(state)) forget(state);
  }
  [[nodiscard]] std::vector<unsigned char> serialize(const SavedState* state) const;
  SavedState* deserialize(std::span<const unsigned char> bytes);

 private:
  [[nodiscard]] std::shared_ptr<const study::Prepared> with_parameters() const;
  void remake();
  void begin_loads(Dynamics& dynamics) const;
  [[nodiscard]] std::string settle_start();
  void retune(const std::vector<double>& before);
  void make_session();
  void remember(Memory& memory);
  void set_one(const Variable& v, double value);
  void check_set(const Variable& v, double value);
  [[nodiscard]] const SavedState& own(const SavedState* state) const;
  [[nodiscard]] std::vector<double> jacobian_along(std::span<const std::uint32_t> unknowns,
                                                   std::span<const std::uint32_t> knowns, const double* along);

  Kind kind_;
  std::string name_;
  Log log_;
  SceneValues values_;
  Variables variables_;
  std::string token_;
  Mode mode_ = Mode::instantiated;
  std::optional<double> tolerance_;
  double start_ = 0;
  std::optional<double> stop_;  ///< [s]; nothing: the host has not said
  std::vector<double> parameters_;
  std::vector<double> starts_;  ///< of states, where `is_started_`
  std::vector<char> is_started_;
  std::vector<double> inputs_;  ///< values set last, where `is_input_set_`
  std::vector<char> is_input_set_;
  bool stale_ = true;  ///< parameters, start time or tolerance are not those that `dynamics_` was made with
  bool open_ = true;   ///< start values were set since loops were last closed around them
  std::unique_ptr<Dynamics> dynamics_;
  std::unique_ptr<Session> session_;  ///< of co-simulation, once initialized
  const BetweenSteps* between_ = nullptr;
  std::optional<double> early_;
  double step_began_ = 0;
  std::set<const SavedState*> saved_;
};

}  // namespace withy::fmi
