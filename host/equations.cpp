#include "withy/host/equations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "withy/core/equations/lane_equations.hpp"
#include "withy/core/model/acting_event.hpp"
#include "withy/core/model/columns.hpp"
#include "withy/core/model/hosted_motion.hpp"
#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/plugin/foreign_law.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/host/names.hpp"
#include "withy/host/stopped.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/prepared.hpp"

namespace withy::host {
namespace {

/// The elements of y by the names of the result columns: positions, speeds, continuous states of loads.
std::vector<Port> state_ports(const Model& model) {
  const Layout& layout = model.layout();
  std::vector<Port> ports(layout.moving());
  const auto put = [&](std::size_t first, const std::vector<Column>& columns) {
    for (std::size_t i = 0; i < columns.size(); ++i) ports[first + i] = {columns[i].name, columns[i].unit};
  };
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    put(layout.hinges[h].position, coordinate_columns(model.hinges()[h]));
    put(layout.positions + layout.hinges[h].speed, rate_columns(model.hinges()[h]));
  }
  for (const Slot& body : layout.bodies) {
    for (std::size_t i = 0; i < body.speeds; ++i) {
      const std::string& mode = layout.speed_names[body.speed + i];
      ports[body.position + i] = {mode, ""};
      ports[layout.positions + body.speed + i] = {mode + ".rate", "1/s"};
    }
  }
  for (std::size_t i = 0; i < layout.continuous; ++i)
    ports[layout.positions + layout.speeds + i] = {layout.continuous_names[i], ""};
  return ports;
}

std::shared_ptr<const study::Prepared> continuous(const Scene& scene, const std::string& formulation) {
  std::shared_ptr<const study::Prepared> prepared =
      formulation.empty() ? scene.prepare() : Scene(scene).formulation(formulation).prepare();
  study::check_one_formulation(*prepared, "an integrator of your own");
  if (const std::string acting = acting_event(prepared->model()); !acting.empty())
    throw study::InputError(
        fmt::format("{}: /events/{}: an event acts on the motion, which an integrator of your own does not know; step "
                    "a Simulation, or leave the event out",
                    prepared->scene.file, acting));
  for (const LoadNode& load : prepared->model().loads())
    if (load.slot.count > 0 && load.load->input() == nullptr && load.name != name_of_event_states)
      throw study::InputError(
          fmt::format("{}: load '{}' changes at instants (sampled, or a relay), which an integrator of your own does "
                      "not know; step "
                      "a Simulation, or leave out its 'sample', or the load",
                      prepared->scene.file, load.name));
  return prepared;
}

}  // namespace

namespace {
/// Tables of loads would give numbers at a time that is not finite, as if it lay beyond their end.
constexpr Evaluation no_instant = {Evaluation::Outcome::nonfinite};

/// Vectorizes, unlike a search for the first that is not.
bool all_finite(std::span<const double> numbers) {
  double nothing = 0;  // or NaN
  for (const double number : numbers) nothing += 0.0 * number;
  return nothing == 0;
}
}  // namespace

struct Equations::Parts {
  /// Equations with lanes, and what each lane works in.
  struct InLanes {
    explicit InLanes(const EquationsOfMotion& equations) : together(lane_equations(equations)) {
      for (std::size_t k = 0; together != nullptr && k < lane_count(); ++k)
        lanes.push_back(
            {std::vector<double>(equations.size()), std::vector<double>(equations.size()), equations.make_work(), {}});
    }

    struct One {
      std::vector<double> y, y_dot;
      Work work;
      LaneCall call;
    };
    std::unique_ptr<LaneEquations> together;  ///< null: there are none
    std::vector<One> lanes;
  };

  explicit Parts(std::shared_ptr<const study::Prepared> from)
      : prepared(std::move(from)),
        equations(*prepared->equations),
        size(equations.layout().moving()),
        full(prepared->scene.initial.y),
        full_dot(full.size()),
        work(equations.make_work()) {}
  Parts(const Parts& other) : Parts(other.prepared) {
    full = other.full;
    states = other.states;
    y0 = other.y0;
    inputs = other.inputs;
    input_loads = other.input_loads;
  }

  /// \throws std::invalid_argument where the host's array has another size.
  static void expect(std::size_t got, std::size_t needed, const char* what) {
    if (got != needed) throw std::invalid_argument(fmt::format("{}: got {} numbers; need {}", what, got, needed));
  }
  Evaluation evaluate(double t, std::span<const double> y) {
    expect(y.size(), size, "y");
    std::copy(y.begin(), y.end(), full.begin());
    // A number that nothing depends on would go by unseen.
    if (!std::isfinite(t) || !all_finite(y)) return no_instant;
    return equations.derivatives(t, full, full_dot, work);
  }
  [[nodiscard]] const LoadNode& load_of_input(std::size_t index) const {
    return prepared->model().loads()[input_loads.at(index)];
  }

  std::shared_ptr<const study::Prepared> prepared;
  const EquationsOfMotion& equations;
  std::size_t size;                    ///< of the host's y
  std::vector<double> full, full_dot;  ///< as State::y, with the inputs
  Work work;
  std::vector<Port> states, inputs;
  std::vector<double> y0;
  std::vector<std::size_t> input_loads;
  std::optional<InLanes> in_lanes;  ///< once many states have been asked for
};

Equations::Equations(const Scene& scene, const std::string& formulation)
    : parts_(std::make_unique<Parts>(continuous(scene, formulation))) {
  Parts& p = *parts_;
  const Model& model = p.prepared->model();
  p.states = state_ports(model);
  p.y0.assign(p.full.begin(), p.full.begin() + static_cast<std::ptrdiff_t>(p.size));
  for (std::size_t l = 0; l < model.loads().size(); ++l) {
    const InputPort* input = model.loads()[l].load->input();
    const HostedMotion* motion = hosted_motion(*model.loads()[l].load);
    if (input == nullptr || (motion != nullptr && !motion->jumps())) continue;  // what cannot be set at once
    p.inputs.push_back({model.loads()[l].name, input->unit()});
    p.input_loads.push_back(l);
  }
}

Equations::Equations(const Equations& other) : parts_(std::make_unique<Parts>(*other.parts_)) {}
Equations& Equations::operator=(const Equations& other) {
  if (this != &other) parts_ = std::make_unique<Parts>(*other.parts_);
  return *this;
}
Equations::Equations(Equations&&) noexcept = default;
Equations& Equations::operator=(Equations&&) noexcept = default;
Equations::~Equations() = default;

std::size_t Equations::size() const { return parts_->size; }
const std::vector<Port>& Equations::states() const { return parts_->states; }
const std::vector<double>& Equations::y0() const { return parts_->y0; }
double Equations::t0() const { return parts_->prepared->scene.initial.time; }
const std::vector<Port>& Equations::inputs() const { return parts_->inputs; }

double Equations::input(std::size_t index) const {
  const LoadNode& load = parts_->load_of_input(index);
  return load.load->input()->value(t0(), load.discrete(std::span<const double>(parts_->full)));
}

void Equations::set_input(std::size_t index, double value) {
  const LoadNode& load = parts_->load_of_input(index);
  if (!std::isfinite(value))
    throw std::invalid_argument(fmt::format("input '{}': got {}; need a finite number", load.name, value));
  load.load->input()->set(t0(), t0(), value, load.discrete(std::span(parts_->full)));
}

void Equations::set_input(std::string_view name, double value) { set_input(index_of(inputs(), name, "input"), value); }

Evaluation Equations::derivatives(double t, std::span<const double> y, std::span<double> y_dot) {
  Parts& p = *parts_;
  Parts::expect(y_dot.size(), p.size, "y_dot");
  const Evaluation evaluation = p.evaluate(t, y);
  std::copy_n(p.full_dot.begin(), p.size, y_dot.begin());
  return evaluation;
}

EvaluatedRows Equations::derivatives_many(double t, std::span<const double> y, std::span<double> y_dot) {
  Parts& p = *parts_;
  const std::size_t n = p.size, count = n == 0 ? 0 : y.size() / n;
  if (y.size() != count * n)
    throw std::invalid_argument(fmt::format("y: got {} numbers; need a multiple of {}", y.size(), n));
  Parts::expect(y_dot.size(), y.size(), "y_dot");
  if (count > 0 && !std::isfinite(t)) return {0, no_instant};
  if (!p.in_lanes) p.in_lanes.emplace(p.equations);
  const std::span<Parts::InLanes::One> lanes = p.in_lanes->lanes;
  if (lanes.empty()) {
    for (std::size_t row = 0; row < count; ++row)
      if (const Evaluation e = derivatives(t, y.subspan(row * n, n), y_dot.subspan(row * n, n)); !e.ok())
        return {row, e};
    return {count, {}};
  }
  for (std::size_t first = 0; first < count; first += lanes.size()) {
    const std::size_t some = std::min(lanes.size(), count - first);
    std::array<LaneCall*, most_lanes> calls{};
    for (std::size_t k = 0; k < some; ++k) {
      Parts::InLanes::One& lane = lanes[k];
      std::copy(p.full.begin(), p.full.end(), lane.y.begin());  // with the inputs
      std::copy_n(y.begin() + static_cast<std::ptrdiff_t>((first + k) * n), n, lane.y.begin());
      lane.call = {t, lane.y, lane.y_dot, &lane.work, {}};
      calls.at(k) = &lane.call;
    }
    p.in_lanes->together->derivatives(std::span(calls).first(lanes.size()));
    for (std::size_t k = 0; k < some; ++k) {
      if (!all_finite(y.subspan((first + k) * n, n))) lanes[k].call.evaluation = no_instant;
      if (!lanes[k].call.evaluation.ok()) {
        std::copy_n(lanes[k].y.begin(), n, p.full.begin());  // for `reason`
        return {first + k, lanes[k].call.evaluation};
      }
      std::copy_n(lanes[k].y_dot.begin(), n, y_dot.begin() + static_cast<std::ptrdiff_t>((first + k) * n));
    }
  }
  return {count, {}};
}

void Equations::jacobian(double t, std::span<const double> y, std::span<double> jacobian) {
  Parts& p = *parts_;
  Parts::expect(jacobian.size(), p.size * p.size, "jacobian");
  const Linearization* linearization = p.equations.linearization();
  if (linearization == nullptr) throw study::InputError(study::why_no_derivatives(*p.prepared));
  Evaluation evaluation = p.evaluate(t, y);
  if (evaluation.ok()) evaluation = linearization->jacobian(t, p.full, p.full_dot, jacobian);
  if (!evaluation.ok()) throw SimulationStopped("singular", reason(t, evaluation), t);
  for (std::size_t i = 0; i < p.size; ++i)  // column after column as it comes
    for (std::size_t j = 0; j < i; ++j) std::swap(jacobian[i * p.size + j], jacobian[j * p.size + i]);
}

void Equations::normalize(std::span<double> y) {
  Parts& p = *parts_;
  Parts::expect(y.size(), p.size, "y");
  std::copy(y.begin(), y.end(), p.full.begin());
  if (const auto* loops = dynamic_cast<const ClosedLoops*>(&p.equations)) {
    if (const Closing closing = loops->close(p.full, p.work); !closing.closed)
      throw std::invalid_argument("y: no state near by closes the loops of the scene");
  } else {
    p.equations.normalize(p.full);
  }
  std::copy_n(p.full.begin(), p.size, y.begin());
}

std::string Equations::reason(double t, const Evaluation& evaluation) const {
  if (evaluation.ok()) return {};
  std::string text = "t = " + brief(t) + " s: ";
  for (const LoadNode& node : parts_->prepared->model().loads())
    if (const auto* law = dynamic_cast<const ForeignLaw*>(node.load.get()))
      if (const std::string words = law->failure({}); !words.empty()) {
        law->forget();
        return text + "load '" + node.name + "': " + words + ".";
      }
  // Whatever the equations came upon: it is the caller's numbers that are wrong.
  if (!std::isfinite(t)) return text + "the time is not finite.";
  for (std::size_t i = 0; i < parts_->size; ++i)
    if (!std::isfinite(parts_->full[i]))
      return text + "the state is not finite: '" + parts_->states[i].name + "' is " +
             (std::isnan(parts_->full[i]) ? "nan" : "infinite") + ".";
  if (evaluation.outcome == Evaluation::Outcome::nonfinite) {
    text += "the derivatives are not finite";
  } else {
    text += "the mass matrix cannot be solved";
  }
  if (evaluation.body >= 0)
    text += " at body '" + parts_->prepared->model().bodies()[static_cast<std::size_t>(evaluation.body)].name + "'";
  return text + ".";
}

}  // namespace withy::host
