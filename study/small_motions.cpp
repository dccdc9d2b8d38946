#include "withy/study/small_motions.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "withy/core/analysis/modes.hpp"
#include "withy/core/model/compiled_model.hpp"
#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/study/displaced_command.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/load_efforts.hpp"

namespace withy::study {
namespace {

/// Holds a hinge at its coordinates or its rate: its acceleration is zero, and that is all that a single state shows.
class HeldStill final : public Motion {
 public:
  bool locks() const override { return true; }
  MotionPoint at(double /*t*/) const noexcept override { return {}; }
  std::vector<double> discontinuities() const override { return {}; }
  double end() const override { return 0; }
};

/// An effort on every speed, its discrete states, and one that others look at.
class BoundPush final : public BoundLoad, public DiscretePart {
 public:
  explicit BoundPush(std::size_t speeds) : speeds_(speeds) {}
  std::size_t scratch() const override { return 0; }
  void add(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
           std::span<double> /*efforts*/, std::span<double> /*scratch*/) const noexcept override {}
  std::vector<double> discontinuities() const override { return {}; }
  const DiscretePart* discrete() const override { return this; }
  double end() const override { return 0; }
  void begin(State& /*state*/) const override {}
  std::size_t states() const override { return speeds_ + 1; }
  void renew(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
             const withy::Crossing& /*crossing*/, std::span<double> /*discrete*/,
             std::span<double> /*scratch*/) const noexcept override {}
  void add(double /*t*/, std::span<const double> discrete, std::span<double> efforts) const noexcept override {
    for (std::size_t s = 0; s < speeds_; ++s) efforts[s] += discrete[s];
  }

 private:
  std::size_t speeds_;
};

class Push final : public Load {
 public:
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    return std::make_unique<BoundPush>(model.layout().speeds);
  }
};

}  // namespace

SmallMotions::SmallMotions(const Configuration& c, std::vector<SensorNode> sensors, std::optional<std::size_t> command)
    : dynamics_(c.dynamics()), work_(0), state_(c.state()), free_(free_speeds(c.held())) {
  auto model = std::make_shared<Model>(c.prepared().model());
  hold(c, *model, !sensors.empty());
  model->add_load("effort", Push());
  // The discrete states that push are the last, before the work.
  push_ = model->loads().back().slot.first;
  if (command)
    model->replace_load(
        *command, std::make_shared<DisplacedCommand>(model->loads()[*command].load, push_ + model->layout().speeds));
  model_ = model;
  equations_ = compile_model(*c.prepared().scene.formulation, model_);
  reader_ = std::make_unique<SensorReader>(std::move(sensors), *equations_);
  work_ = equations_->make_work();
  state_.y.insert(state_.y.begin() + static_cast<std::ptrdiff_t>(push_), model_->layout().speeds + 1, 0.0);
  if (c.sampled()) {
    // What loads tell may be of a sample at another state, from which this one was found.
    Renewal renewal(*model_, *equations_);
    state_ = told_at(*model_, renewal, std::move(state_));
  }

  accelerations_ = accelerations_of(c);
  const Tangents tangents = dynamics_.tangents(c.state().time, c.state().y, accelerations_);
  derivatives_ = derivatives_text(tangents);
  FirstOrderForm form = whole_first_order_form(tangents, c.held());
  A_ = std::move(form.A);
  by_effort_ = dynamics_.whole(c.state().y, form.B.transpose()).transpose();
  for (const Eigen::Index s : free_) names_.push_back(model_->layout().speed_names[static_cast<std::size_t>(s)]);
  for (std::size_t i = 0; i < free_.size(); ++i) names_.push_back(names_[i] + ".rate");
  const std::vector<std::string>& of_loads = model_->layout().continuous_names;
  names_.insert(names_.end(), of_loads.begin(), of_loads.end());
  find_steps(c);
}

void SmallMotions::hold(const Configuration& c, Model& model, bool needed) {
  const Held kept = c.kept();
  for (std::size_t h = 0; h < c.layout().hinges.size(); ++h) {
    const Slot& slot = c.layout().hinges[h];
    const auto first = kept.begin() + static_cast<std::ptrdiff_t>(slot.speed);
    const auto held = std::count(first, first + static_cast<std::ptrdiff_t>(slot.speeds), true);
    if (held == 0 || model.driven(h)) continue;
    if (static_cast<std::size_t>(held) == slot.speeds) {
      model.add_motion("hold " + slot.name, slot.name, std::make_shared<HeldStill>());
      continue;
    }
    if (needed)
      throw InputError("one rate of several of hinge '" + slot.name +
                       "' is held, and sensors do not know of that: hold all of it, or choose other outputs");
    for (std::size_t i = 0; i < slot.speeds; ++i)
      if (first[static_cast<std::ptrdiff_t>(i)]) held_alone_.push_back(static_cast<Eigen::Index>(slot.speed + i));
  }
}

void SmallMotions::find_steps(const Configuration& c) {
  double length = 0;
  for (const Tip& tip : tips(c.prepared().model())) length = std::max(length, tip.length);
  if (!(length > 0)) length = 1;
  const Layout& layout = c.layout();
  std::vector<double> of_speeds(layout.speeds, 1e-3 * length);
  for (std::size_t h = 0; h < layout.hinges.size(); ++h) {
    const std::vector<HingeRate> rates = hinge_rates(*model_->hinges()[h].hinge);
    for (std::size_t i = 0; i < rates.size(); ++i)
      of_speeds[layout.hinges[h].speed + i] = rates[i].angular ? 1e-2 : 1e-2 * length;
  }
  for (std::size_t s = 0; s < layout.speeds; ++s)
    if (layout.speed_names[s].find(".torsion[") != std::string::npos) of_speeds[s] = 1e-2;
  // A speed's step is that of its displacement.
  for (int half = 0; half < 2; ++half)
    for (const Eigen::Index s : free_) steps_.push_back(of_speeds[static_cast<std::size_t>(s)]);
  for (std::size_t i = layout.positions + layout.speeds; i < layout.moving(); ++i)
    steps_.push_back(1e-2 * std::max(1.0, std::abs(c.state().y[i])));
}

State SmallMotions::displaced(Eigen::Index i, double h) const {
  State moved = state_;
  const auto m = static_cast<Eigen::Index>(free_.size());
  if (i >= 2 * m) {
    const Layout& layout = model_->layout();
    moved.y[layout.positions + layout.speeds + static_cast<std::size_t>(i - 2 * m)] += h;
    return moved;
  }
  const Eigen::VectorXd by = h * Eigen::VectorXd::Unit(by_effort_.cols(), free_[static_cast<std::size_t>(i % m)]);
  if (i < m)
    dynamics_.displace(moved.y, by);
  else
    Eigen::Map<Eigen::VectorXd>(moved.y.data() + model_->layout().positions, by.size()) +=
        dynamics_.whole(state_.y, by);
  return moved;
}

double SmallMotions::step(Eigen::Index i) const { return steps_[static_cast<std::size_t>(i)]; }

double SmallMotions::place(Eigen::Index i) const {
  const State moved = displaced(i, 1);
  double greatest = 0;
  for (std::size_t k = 0; k < moved.y.size(); ++k)
    if (moved.y[k] != state_.y[k]) greatest = std::max(greatest, std::abs(state_.y[k]));
  return greatest;
}

double SmallMotions::step(const Eigen::VectorXd& efforts) const {
  const Eigen::VectorXd rates = by_effort_ * efforts;  // none where nothing is free
  const double moved = rates.size() > 0 ? rates.cwiseAbs().maxCoeff() : 0.0;
  return moved > 0 ? 1 / moved : 1.0;
}

State SmallMotions::pushed(const Eigen::VectorXd& efforts) const {
  State state = state_;
  std::copy_n(efforts.data(), efforts.size(), state.y.begin() + static_cast<std::ptrdiff_t>(push_));
  return state;
}

State SmallMotions::commanded(double more) const {
  State state = state_;
  state.y[push_ + model_->layout().speeds] = more;
  return state;
}

Eigen::VectorXd SmallMotions::moved(const State& state) const {
  const Layout& layout = model_->layout();
  std::vector<double> y_dot(layout.size());
  if (!equations_->derivatives(state.time, state.y, y_dot, work_).ok())
    throw std::domain_error("the accelerations near this state are not finite");
  Eigen::VectorXd z_dot = Eigen::VectorXd::Zero(size());
  const auto m = static_cast<Eigen::Index>(free_.size());
  for (Eigen::Index i = 0; i < m; ++i)
    z_dot[m + i] = y_dot[layout.positions + static_cast<std::size_t>(free_[static_cast<std::size_t>(i)])];
  z_dot.tail(size() - 2 * m) = Eigen::Map<const Eigen::VectorXd>(y_dot.data() + layout.positions + layout.speeds,
                                                                 static_cast<Eigen::Index>(layout.continuous));
  return z_dot;
}

Eigen::VectorXd SmallMotions::efforts(const State& state, std::size_t load) const {
  return load_efforts(*equations_, state.time, state, static_cast<int>(load), work_);
}

Eigen::VectorXd SmallMotions::efforts(const State& state) const {
  return load_efforts(*equations_, state.time, state, EquationsOfMotion::all_loads, work_);
}

Eigen::VectorXd SmallMotions::rates(const State& state) const {
  const Layout& layout = model_->layout();
  std::vector<double> y_dot(layout.size()), scratch(model_->load_scratch());
  std::copy_n(accelerations_.data(), accelerations_.size(),
              y_dot.begin() + static_cast<std::ptrdiff_t>(layout.positions));
  // Of states that are not finite the derivative is not finite, and says so where the system is put together.
  static_cast<void>(model_->continuous_rates(state.time, state.y, y_dot, scratch));
  return Eigen::Map<const Eigen::VectorXd>(y_dot.data() + layout.positions + layout.speeds,
                                           static_cast<Eigen::Index>(layout.continuous));
}

Eigen::VectorXd SmallMotions::sensed(const State& state) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(columns().size()));
  if (!reader_->read(state, {values.data(), columns().size()}))
    throw std::domain_error("the accelerations that sensors look at are not finite near this state");
  return values;
}

}  // namespace withy::study
