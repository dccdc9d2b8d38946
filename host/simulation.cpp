#include "withy/host/simulation.hpp"

#include <stdexcept>

#include "withy/core/simulation/integrator_call.hpp"
#include "withy/core/simulation/session.hpp"
#include "withy/host/names.hpp"
#include "withy/host/snapshot_parts.hpp"
#include "withy/results/result_columns.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/prepared.hpp"
#include "withy/study/run.hpp"

namespace withy::host {
namespace {

std::shared_ptr<const study::Prepared> with_one_formulation(const Scene& scene) {
  std::shared_ptr<const study::Prepared> prepared = scene.prepare();
  study::check_one_formulation(*prepared, "a simulation that is stepped");
  study::check_integrator(*prepared);
  return prepared;
}

}  // namespace

struct Simulation::Parts {
  Parts(const Scene& scene, std::function<bool()> interrupted)
      : library(scene.library()),
        prepared(with_one_formulation(scene)),
        session(prepared->model(), *prepared->equations, *prepared->scene.integrator, prepared->scene.initial,
                {prepared->scene.deflection_limit, prepared->scene.events, std::move(interrupted),
                 study::has_own_energy(prepared->scene), span_of(prepared->scene)}),
        table(prepared->model(), *prepared->equations, prepared->scene.outputs) {
    for (std::size_t l = 0; l < prepared->model().loads().size(); ++l) {
      const LoadNode& load = prepared->model().loads()[l];
      if (load.load->input() == nullptr) continue;
      inputs.push_back({load.name, load.load->input()->unit()});
      input_loads.push_back(l);
    }
    for (const Column& column : table.columns()) outputs.push_back({column.name, column.unit});
    for (const std::string& remark : remarks_of(session.stepper())) library.log("The integrator: " + remark + ".");
  }

  const std::vector<double>& row() {
    if (!row_is_now) values = table.row(session.state());
    row_is_now = true;
    return values;
  }

  SessionEnd go(double t, bool halt) {
    try {
      return session.advance(t, halt);
    } catch (const IntegratorError& e) {
      study::refuse_integrator(*prepared, e.deed());
    }
  }

  /// \returns whether no event has halted it
  bool advance(double t, bool halt) {
    row_is_now = false;
    const SessionEnd end = go(t, halt);
    events.clear();
    for (const EventTime& e : session.events()) events.push_back({e.name, e.time, e.direction});
    if (end.status == RunStatus::completed) return !end.halted;
    refuse(end);
  }

  [[noreturn]] void refuse(const SessionEnd& end) const {
    throw SimulationStopped(std::string(withy::name(end.status)), end.message, session.state().time);
  }

  Library library;
  std::shared_ptr<const study::Prepared> prepared;
  Session session;
  ResultColumns table;
  std::vector<Port> inputs, outputs;
  std::vector<std::size_t> input_loads;  ///< index of each input among the model's loads
  std::vector<double> values;            ///< of the outputs
  bool row_is_now = false;               ///< `values` are of the present state
  std::vector<Event> events;
  OriginOnce origin;
};

Simulation::Simulation(const Scene& scene, std::function<bool()> interrupted)
    : parts_(std::make_unique<Parts>(scene, std::move(interrupted))) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

double Simulation::time() const { return parts_->session.state().time; }
const std::vector<Port>& Simulation::inputs() const { return parts_->inputs; }
const std::vector<Port>& Simulation::outputs() const { return parts_->outputs; }

std::size_t Simulation::input_index(std::string_view name) const { return index_of(inputs(), name, "input"); }
std::size_t Simulation::output_index(std::string_view name) const { return index_of(outputs(), name, "output"); }

double Simulation::input(std::size_t index) const { return parts_->session.input(parts_->input_loads.at(index)); }
double Simulation::input(std::string_view name) const { return input(input_index(name)); }
void Simulation::set_input(std::size_t index, double value) {
  parts_->session.set_input(parts_->input_loads.at(index), value);
}
void Simulation::set_input(std::string_view name, double value) { set_input(input_index(name), value); }

double Simulation::output(std::size_t index) const { return parts_->row().at(index); }
double Simulation::output(std::string_view name) const { return output(output_index(name)); }
std::span<const double> Simulation::output_values() const { return parts_->row(); }

void Simulation::step(double t) { parts_->advance(t, false); }
bool Simulation::advance_to(double t) { return parts_->advance(t, true); }
const std::vector<Event>& Simulation::events() const { return parts_->events; }

Snapshot Simulation::snapshot() const {
  if (const auto& end = parts_->session.ended()) parts_->refuse(*end);
  Snapshot snapshot;
  snapshot.parts_ = std::make_shared<const Snapshot::Parts>(
      Snapshot::Parts{parts_->session.snapshot(), parts_->origin(parts_->prepared->scene)});
  return snapshot;
}

void Simulation::restore(const Snapshot& snapshot) {
  if (snapshot.parts_ == nullptr) throw std::invalid_argument("the snapshot is empty");
  snapshot.parts_->origin.check_against(parts_->origin(parts_->prepared->scene));
  parts_->session.restore(snapshot.parts_->checkpoint);
  parts_->row_is_now = false;
  parts_->events.clear();
}

std::string Simulation::state() const { return write_state(parts_->prepared->model(), parts_->session.state()); }
std::size_t Simulation::evaluations() const { return parts_->session.stepper().statistics().evaluations; }

}  // namespace withy::host
