/// \file
/// The campaign at the extremes: what is measured, against what, and the table it makes.
#pragma once

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"

namespace withy::extremes {

/// A line of the table: a figure measured beside the gate it has to pass.
struct Row {
  std::string extreme;
  std::string oracle;
  std::string gate;
  std::string measured;
  bool met = false;
};

class Campaign {
 public:
  explicit Campaign(bool quick) : quick_(quick) {}
  /// Whether only what takes seconds is asked for.
  [[nodiscard]] bool quick() const { return quick_; }
  /// The extreme that the rows after this belong to.
  void begin(std::string extreme) { extreme_ = std::move(extreme); }
  void row(const std::string& what, const std::string& oracle, const std::string& gate, const std::string& measured,
           bool met);
  /// A figure that has to be at most its gate; NaN is not.
  void at_most(const std::string& what, const std::string& oracle, double measured, double gate);
  /// A gate without a figure: it holds, or `why` says what went wrong.
  void holds(const std::string& what, const std::string& oracle, const std::string& gate, const std::string& why);
  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }

 private:
  bool quick_;
  std::string extreme_;
  std::vector<Row> rows_;
};

/// A named part of the campaign.
struct Extreme {
  const char* id;
  const char* title;
  void (*measure)(Campaign&);
};

/// All parts, in the order of the table.
const std::vector<Extreme>& extremes();

/// A scene made from text, with its equations of motion.
struct Made {
  Registry registry;
  Scene scene;
  std::unique_ptr<EquationsOfMotion> equations;
  explicit Made(const std::string& text, const std::string& formulation = "", std::vector<std::string> overrides = {},
                const std::string& file = "text") {
    enroll_static_plugins(registry);
    scene = parse_scene(text, file, registry, {formulation, "", std::move(overrides)});
    equations = scene.formulation->compile(scene.model);
  }
  [[nodiscard]] const Model& model() const { return *scene.model; }
  [[nodiscard]] const Layout& layout() const { return scene.model->layout(); }
  /// Derivatives of y at the scene's initial state, or at another.
  [[nodiscard]] std::vector<double> rates() const { return rates(scene.initial); }
  [[nodiscard]] std::vector<double> rates(const State& state) const;
  /// The same for the speeds alone.
  [[nodiscard]] std::vector<double> accelerations() const { return accelerations(scene.initial); }
  [[nodiscard]] std::vector<double> accelerations(const State& state) const;
};

/// An integrator with options as a scene gives them: "{name: rk4, step: 0.01}".
std::shared_ptr<const Integrator> integrator(const std::string& options);
/// Ids of all formulations.
inline const std::vector<std::string> formulations = {"ruthless",  "inconsistent", "consistent",
                                                      "quadratic", "linear",       "exact"};
/// Ids of all formulations or integrators that there are.
template <class Plugin>
std::vector<std::string> ids() {
  Registry registry;
  enroll_static_plugins(registry);
  return registry.ids<Plugin>();
}
/// Options of an integrator that make its steps this long whatever the errors; not of `cvode`, which chooses its own.
std::string equal_steps(const std::string& id, double step);
/// Options of an integrator that does as well as the tolerance asks, relative and absolute; empty where it has none.
std::string with_tolerance(const std::string& id, double tolerance);
/// A beam at a wall with one mode: an undamped vibration of frequency ω₁ = 1.875² in `ruthless` and, as nothing but its
/// own mode moves, in `consistent`.
extern const std::string vibration;
/// Kinetic and potential energy [J].
double energy(const Made& made, const State& s);
/// Energy after `steps` steps h over that before, with the given integrator; its logarithm.
double energy_growth(const Made& made, const Integrator& method, double h, std::size_t steps);
/// A beam of two modes with a weight at its tip, swinging from a pivot: bent at the start, nothing damped or driven.
extern const std::string pendulum;
/// Text of a file; of a scene of the project.
std::string text_of(const std::string& file);
std::string scene_text(const std::string& name);
/// Greatest difference of two lists over the greatest element of the second.
double difference(const std::vector<double>& a, const std::vector<double>& b);
/// CPU time of this thread [s].
double cpu_seconds();

// The parts.
void high_modes(Campaign&);
void tip_mass(Campaign&);
void zeros(Campaign&);
void spin(Campaign&);
void spin_up(Campaign&);
void buckling(Campaign&);
void stability(Campaign&);
void rigid_limit(Campaign&);
void long_run(Campaign&);
void reversal(Campaign&);
void chains(Campaign&);
void rotations(Campaign&);
void units(Campaign&);
void units_of_analysis(Campaign&);
void invariance(Campaign&);
void failures(Campaign&);
void jumps(Campaign&);
void stiff_orders(Campaign&);
void checkpoints(Campaign&);
void work_precision(Campaign&);
void detest(Campaign&);
void denormals(Campaign&);
void threads(Campaign&);

}  // namespace withy::extremes
