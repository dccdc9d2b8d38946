#include "withy/bindings/fmi/instance.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "withy/bindings/fmi/model_exchange.hpp"
#include "withy/bindings/fmi/resources.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/integrator_call.hpp"
#include "withy/plugins/host/static_plugins.hpp"

namespace withy::fmi {
namespace {

/// The plugins linked in; threads share them.
Registry& registry() {
  static Registry plugins = [] {
    Registry all;
    enroll_static_plugins(all);
    return all;
  }();
  return plugins;
}

/// Two times of a host are one where they differ by less, of 1 s or of the greater.
constexpr double same_time = 1e-9;

/// "gravity" of "gravity.1"; empty where the parameter is no element of a vector.
std::string_view vector_of(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos || name.find_first_not_of("0123456789", dot + 1) != std::string_view::npos)
    return {};
  return name.substr(0, dot);
}

}  // namespace

Instance::Instance(Kind kind, std::string name, std::string_view token, const std::string& resources, Log log)
    : kind_(kind), name_(std::move(name)), log_(std::move(log)), values_(read_resources(resources)) {
  const auto prepared = std::make_shared<const study::Prepared>(study::prepare(values_, registry()));
  variables_ = variables_of(*prepared, registry());
  token_ = token_of(*prepared, variables_);
  if (token != token_)
    throw std::runtime_error("the model description is of another FMU: its token is '" + std::string(token) +
                             "'; that of these resources is '" + token_ + "'");
  if (kind_ == Kind::model_exchange) refuse_model_exchange(*prepared);
  dynamics_ = std::make_unique<Dynamics>(prepared, prepared->scene.initial.time);
  reset();
  stale_ = false;
}

Instance::~Instance() {
  *const_cast<volatile std::uint64_t*>(&kind_of_handle) = 0;
  for (const SavedState* state : saved_) delete state;
}

const char* Instance::mode_name() const {
  switch (mode_) {
    case Mode::instantiated:
      return "instantiated";
    case Mode::initialization:
      return "initialization";
    case Mode::event:
      return "event";
    case Mode::continuous:
      return "continuous-time";
    case Mode::step:
      return "step";
    case Mode::intermediate:
      return "intermediate update";
    case Mode::terminated:
      return "terminated";
  }
  return "";
}

void Instance::say(Status status, const char* category, const std::string& message) const {
  if (!log_.write) return;
  const bool fault = status != Status::ok;
  if (!fault && (!log_.on || (!log_.categories.empty() && !log_.categories.contains(category) &&
                              !log_.categories.contains(log_all))))
    return;
  log_.write(status, category, message.c_str());
}

void Instance::reset() {
  const auto of_kind = [&](std::size_t first, std::size_t count) {
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; ++i) values[i] = variables_.all[first + i].start;
    return values;
  };
  parameters_ = of_kind(variables_.parameter(0), variables_.parameters);
  starts_ = of_kind(variables_.state(0), variables_.states);
  inputs_ = of_kind(variables_.input(0), variables_.inputs);
  is_started_.assign(starts_.size(), 0);
  is_input_set_.assign(inputs_.size(), 0);
  tolerance_.reset();
  stop_.reset();
  start_ = dynamics_->prepared().scene.initial.time;
  session_.reset();
  stale_ = true;
  mode_ = Mode::instantiated;
}

void Instance::set_experiment(std::optional<double> tolerance, double start, std::optional<double> stop) {
  if (!std::isfinite(start) || (tolerance && !(*tolerance > 0 && std::isfinite(*tolerance))))
    throw std::invalid_argument("the start time is to be finite, a tolerance finite and above 0");
  if (stop && !(*stop >= start))
    throw std::invalid_argument("the stop time " + brief(*stop) + " s lies before the start time " + brief(start) +
                                " s");
  stale_ = stale_ || start != start_ || tolerance != tolerance_;
  start_ = start;
  stop_ = stop;
  tolerance_ = tolerance;
}

void Instance::check_stop(double time) const {
  // Hosts add up their steps.
  if (stop_ && time > *stop_ + same_time * std::max(1.0, std::abs(*stop_)))
    throw std::invalid_argument("the time " + brief(time) + " s lies beyond the stop time that was set, " +
                                brief(*stop_) + " s");
}

/// The scene with the parameters and the tolerance that were set.
std::shared_ptr<const study::Prepared> Instance::with_parameters() const {
  SceneValues values = values_;
  const auto parameter = [&](std::size_t i) -> const Variable& { return variables_.all[variables_.parameter(i)]; };
  for (std::size_t i = 0; i < parameters_.size();) {
    const std::string_view vector = vector_of(parameter(i).name);
    std::size_t end = i + 1;
    while (!vector.empty() && end < parameters_.size() && vector_of(parameter(end).name) == vector) ++end;
    std::size_t other = i;
    while (other < end && parameters_[other] == parameter(other).start) ++other;
    if (other < end) {
      const std::string origin = "parameter '" + parameter(other).name + "'";
      // Whole vectors: the file may have none, or an orientation as an axis and an angle.
      if (vector.empty())
        values.set(parameter(i).name, Value(parameters_[i]), origin);
      else
        values.set(vector, Value::list(std::vector<Value>(&parameters_[i], &parameters_[i] + (end - i))), origin);
    }
    i = end;
  }
  const Value* rtol = values.find("integrator.rtol");
  if (tolerance_ && variables_.parameters > 0) {
    for (std::size_t i = 0; i < variables_.parameters; ++i)
      if (variables_.all[variables_.parameter(i)].name == "integrator.rtol" &&
          (rtol == nullptr || rtol->kind() != Value::Kind::number || rtol->number() != *tolerance_))
        values.set("integrator.rtol", Value(*tolerance_), "tolerance");
  }
  auto prepared = std::make_shared<const study::Prepared>(study::prepare(std::move(values), registry()));
  if (prepared->model().layout().moving() != variables_.states)
    throw std::runtime_error("with these parameters the model has " +
                             std::to_string(prepared->model().layout().moving()) + " states; the FMU has " +
                             std::to_string(variables_.states));
  return prepared;
}

/// Makes the scene anew with the parameters, tolerance and start values that were set.
void Instance::remake() {
  auto made = std::make_unique<Dynamics>(with_parameters(), start_);
  for (std::size_t i = 0; i < starts_.size(); ++i)
    if (is_started_[i] != 0) made->set_state(i, starts_[i]);
  for (std::size_t i = 0; i < inputs_.size(); ++i)
    if (is_input_set_[i] != 0) made->set_input(variables_.all[variables_.input(i)].index, inputs_[i]);
  begin_loads(*made);
  made->begin();
  dynamics_ = std::move(made);
  stale_ = false;
  open_ = true;
}

/// A filter begins at what it measures, wherever the host begins: as in a run from there.
void Instance::begin_loads(Dynamics& dynamics) const {
  std::vector<std::size_t> states;
  for (std::size_t i = 0; i < variables_.states; ++i)
    if (variables_.all[variables_.state(i)].begun && is_started_[i] == 0) states.push_back(i);
  dynamics.begin_loads(states);
}

/// Goes on from where it stands with other parameters. \param before those up to now, which stay where it throws
void Instance::retune(const std::vector<double>& before) {
  std::unique_ptr<Session> old_session;
  std::unique_ptr<Dynamics> old_dynamics;
  try {
    Memory memory;
    dynamics_->remember(memory);
    auto made = std::make_unique<Dynamics>(with_parameters(), start_);
    if (made->state().y.size() != dynamics_->state().y.size())
      throw std::invalid_argument("these parameters change how many states the loads have; they are for a new start");
    Memory kept(memory.numbers());
    made->remember(kept);
    const std::optional<Checkpoint> checkpoint =
        session_ == nullptr ? std::nullopt : std::optional(session_->snapshot());
    old_session = std::move(session_);
    old_dynamics = std::exchange(dynamics_, std::move(made));
    if (!checkpoint) return;
    make_session();
    session_->restore(*checkpoint);
    session_->begin_step_anew();
  } catch (...) {
    if (old_dynamics != nullptr) {
      session_ = std::move(old_session);
      dynamics_ = std::move(old_dynamics);
    }
    parameters_ = before;
    throw;
  }
}

Dynamics& Instance::dynamics() {
  if (stale_) remake();
  return *dynamics_;
}

void Instance::enter_initialization() {
  static_cast<void>(dynamics());
  mode_ = Mode::initialization;
}

void Instance::exit_initialization() {
  Dynamics& d = dynamics();
  open_ = true;
  if (const std::string fault = settle_start(); !fault.empty()) throw std::invalid_argument(fault);
  d.begin();
  if (kind_ == Kind::co_simulation) {
    make_session();
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
      const std::size_t load = variables_.all[variables_.input(i)].index;
      if (is_input_set_[i] != 0 && d.is_reached(load)) session_->set_input(load, inputs_[i]);
    }
    d.show(session_->state());
    for (const std::string& remark : remarks_of(session_->stepper()))
      say(Status::ok, log_all, "The integrator: " + remark + ".");
  }
  mode_ = kind_ == Kind::co_simulation ? Mode::step : Mode::event;
}

void Instance::make_session() {
  const study::Prepared& p = dynamics_->prepared();
  const auto between = [this] {
    const double now = session_->state().time;
    if (between_ == nullptr || early_ || now <= step_began_) return false;
    dynamics_->show(session_->state());
    mode_ = Mode::intermediate;
    early_ = (*between_)(now);
    mode_ = Mode::step;
    return early_.has_value();
  };
  session_ = std::make_unique<Session>(p.model(), *p.equations, *p.scene.integrator, dynamics_->start(),
                                       SessionOptions{p.scene.deflection_limit, p.scene.events, between,
                                                      study::has_own_energy(p.scene), span_of(p.scene)});
}

StepEnd Instance::step(double from, double length, const BetweenSteps& between) {
  const double now = session_->state().time;
  if (!std::isfinite(from) || !std::isfinite(length) || length < 0 ||
      std::abs(from - now) > same_time * std::max(1.0, std::abs(now)))
    throw std::invalid_argument("a step of " + brief(length) + " s from " + brief(from) +
                                " s; need one of at least 0 s from where the FMU stands, " + brief(now) + " s");
  check_stop(from + length);
  const double target = std::max(now, from + length);
  step_began_ = now;
  early_.reset();
  between_ = between ? &between : nullptr;
  SessionEnd end = session_->advance(target, true);
  between_ = nullptr;
  const auto say_events = [&] {
    for (const EventTime& e : session_->events())
      say(Status::ok, log_events, "Event '" + e.name + "' at t = " + brief(e.time) + " s.");
  };
  say_events();
  if (end.status == RunStatus::interrupted && early_ && *early_ > session_->state().time) {
    end = session_->advance(std::min(*early_, target), true);
    say_events();
  }
  dynamics_->show(session_->state());
  StepEnd result;
  result.reached = session_->state().time == target;
  result.early = early_.has_value() && !result.reached;
  if (end.halted) {
    result.terminate = true;
    result.reason = "event '" + (session_->events().empty() ? std::string() : session_->events().back().name) +
                    "' ends the simulation at t = " + brief(session_->state().time) + " s";
  } else if (end.status != RunStatus::completed && end.status != RunStatus::interrupted) {
    result.terminate = result.failed = true;
    result.reason = end.message;
  }
  return result;
}

}  // namespace withy::fmi
