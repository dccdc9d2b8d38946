#include "withy/core/kinematics/signals.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "withy/core/model/signal_source.hpp"
#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/plugin/sensed_fields.hpp"

namespace withy {
namespace {

constexpr std::size_t doubles_of_motion = sizeof(FrameMotion) / sizeof(double);
constexpr std::size_t doubles_of_acceleration = sizeof(FrameAcceleration) / sizeof(double);
constexpr std::size_t doubles_of_line = 8;  // 64 bytes, to which the work of paths is aligned

}  // namespace

/// A state of which positions and speeds are known, and accelerations where the view has them. What else is asked for
/// is a given number.
class Signals::Seen final : public SensedState, public SensedLoops, public SensedFields {
 public:
  Seen(const Signals& signals, const LoadView& view, Unknown unknown, std::vector<FrameIndex>* asked)
      : signals_(signals), view_(view), unknown_(unknown), unavailable_(unknown.effort), asked_(asked) {
    energies_.kinetic = energies_.potential = unavailable_;
    energies_.linear_momentum.fill(unavailable_);
    energies_.angular_momentum.fill(unavailable_);
    if (asked_ == nullptr) return;
    probed_.assign(view.layout.speeds, unavailable_);
    accelerating_.assign(view.layout.speeds, unknown.acceleration);
  }
  bool observe(const State& /*state*/) noexcept override { return true; }
  const Layout& layout() const noexcept override { return view_.layout; }
  double time() const noexcept override { return view_.t; }
  std::span<const double> y() const noexcept override { return view_.y; }
  std::span<const double> accelerations() noexcept override {
    if (asked_ != nullptr) return accelerating_;
    return view_.accelerations.empty() ? std::span<const double>(signals_.zeros_) : view_.accelerations;
  }
  Vector3 gravity() const noexcept override { return signals_.model_->gravity(); }
  Vector3 field(FrameIndex frame) noexcept override {
    if (asked_ != nullptr) return Vector3::Zero();
    return signals_.fields_.acceleration(view_.t, view_.y, motion(frame));
  }
  FrameMotion motion(FrameIndex frame) noexcept override {
    const std::size_t i = place_of(frame);
    if (i == signals_.frames_.size()) return {};
    return reinterpret_cast<const FrameMotion*>(view_.scratch.data() + signals_.numbers_)[i];
  }
  FrameAcceleration acceleration(FrameIndex frame) noexcept override {
    const std::size_t i = place_of(frame);
    if (frame.body < 0) return {};
    if (asked_ != nullptr) return {Vector3::Constant(unknown_.acceleration), Vector3::Constant(unknown_.acceleration)};
    if (i == signals_.frames_.size() || view_.accelerations.empty()) return {};
    const double* const first = view_.scratch.data() + signals_.numbers_ + signals_.frames_.size() * doubles_of_motion;
    return reinterpret_cast<const FrameAcceleration*>(first)[i];
  }
  std::span<const double> load_efforts(int /*load*/) noexcept override { return of_speeds(); }
  std::span<const double> motion_efforts() noexcept override { return of_speeds(); }
  Wrench reaction(int /*hinge*/) noexcept override {
    return {Vector3::Constant(unavailable_), Vector3::Constant(unavailable_)};
  }
  Wrench closing_reaction(std::size_t /*loop*/) noexcept override { return reaction(0); }
  SectionLoad section(std::size_t /*index*/) noexcept override {
    const Vector3 none = Vector3::Constant(unavailable_);
    return {{none, none}, none, none};
  }
  BodyEnergies energies(int /*body*/) noexcept override {
    const Vector3 none = Vector3::Constant(unavailable_);
    return {unavailable_, unavailable_, unavailable_, none, none};
  }
  const Energies& energies() noexcept override { return energies_; }

 private:
  [[nodiscard]] std::span<const double> of_speeds() const {
    return asked_ != nullptr ? std::span<const double>(probed_) : std::span<const double>(signals_.zeros_);
  }

  /// Among the frames whose motion is found; their count where it is none of them, which is noted.
  [[nodiscard]] std::size_t place_of(FrameIndex frame) {
    const std::vector<FrameIndex>& known = signals_.frames_;
    std::size_t i = 0;
    while (i < known.size() && (known[i].body != frame.body || known[i].frame != frame.frame)) ++i;
    if (i == known.size() && frame.body >= 0 && asked_ != nullptr) asked_->push_back(frame);
    return i;
  }

  const Signals& signals_;
  const LoadView& view_;
  Unknown unknown_;
  double unavailable_;
  std::vector<FrameIndex>* asked_;  ///< null in a run, which allocates nothing
  std::vector<double> probed_, accelerating_;
  Energies energies_;
};

Signals::Signals(const Model& model, const Terms& terms, std::vector<std::string> names) : names_(std::move(names)) {
  zeros_.assign(model.layout().speeds, 0.0);
  for (const std::string& name : names_) sources_.push_back(find(model, name));
  choose_readings(model, terms);
}
Signals::Signals(Signals&&) noexcept = default;
Signals::~Signals() = default;

bool Signals::of_loads() const {
  return std::any_of(sources_.begin(), sources_.end(), [](const Source& s) { return s.load != nullptr; });
}

bool Signals::needs_accelerations(std::size_t signal) const {
  const Source& s = sources_[signal];
  return s.accelerated || (s.load != nullptr && s.load->output()->needs_accelerations());
}

Signals::Source Signals::find(const Model& model, const std::string& name) {
  const SignalSource found = find_signal(model, name);
  Source source;
  switch (found.kind) {
    case SignalSource::Kind::position:
    case SignalSource::Kind::rate:
      source.element = Element{found.kind == SignalSource::Kind::rate, found.index};
      break;
    case SignalSource::Kind::load:
      source.load = model.loads()[found.index].load;
      source.index = found.index;
      source.output = found.number;
      source.continuous = model.loads()[found.index].continuous_slot;
      break;
    case SignalSource::Kind::output:
      source.number = found.index;
      break;
    case SignalSource::Kind::unbound:
      throw std::invalid_argument("signal '" + name +
                                  "' depends on efforts of loads, and so on this load's own: the loop " + name +
                                  " -> this load -> " + name +
                                  " would be algebraic; measure positions and rates, or give this load a 'sample'");
  }
  return source;
}

std::size_t Signals::paths_doubles() const {
  return paths_ == nullptr ? 0 : doubles_of_line + (paths_->work_size() + sizeof(double) - 1) / sizeof(double);
}

void Signals::lay_out() {
  own_ = numbers_ + frames_.size() * doubles_of_motion;
  if (accelerates_) own_ += frames_.size() * (doubles_of_acceleration + doubles_of_motion);
  own_ += paths_doubles();
  scratch_ = own_;
  for (const Source& s : sources_) {
    if (s.load != nullptr) scratch_ = std::max(scratch_, own_ + s.load->output()->outputs() + s.load->scratch());
  }
}

void Signals::read_sensors(const LoadView& view, Unknown unknown, std::vector<FrameIndex>* asked) const noexcept {
  const std::span<double> numbers = view.scratch.first(numbers_);
  if (asked != nullptr) std::fill(numbers.begin(), numbers.end(), std::numeric_limits<double>::quiet_NaN());
  if (paths_ != nullptr) {
    auto* const motions = reinterpret_cast<FrameMotion*>(view.scratch.data() + numbers_);
    for (std::size_t i = 0; i < frames_.size(); ++i) std::construct_at(motions + i);
    auto address = reinterpret_cast<std::uintptr_t>(view.scratch.data() + own_ - paths_doubles());
    address = (address + 63) / 64 * 64;
    auto* const work = reinterpret_cast<std::byte*>(address);  // NOLINT(performance-no-int-to-ptr)
    paths_->motions(view.positions(), view.speeds(), {motions, frames_.size()}, work);
    if (accelerates_ && !view.accelerations.empty()) accelerate(view, work);
  }
  Seen seen(*this, view, unknown, asked);
  for (const Reading& r : readings_)
    r.sensor->read(seen, {0, numbers.first(r.first)}, numbers.subspan(r.first, r.count));
}

void Signals::accelerate(const LoadView& view, std::byte* work) const noexcept {
  const std::size_t count = frames_.size();
  double* const at = view.scratch.data() + numbers_ + count * doubles_of_motion;
  auto* const found = reinterpret_cast<FrameAcceleration*>(at);
  auto* const motions = reinterpret_cast<FrameMotion*>(at + count * doubles_of_acceleration);
  for (std::size_t i = 0; i < count; ++i) {
    std::construct_at(found + i);
    std::construct_at(motions + i);
  }
  // First, for it is of the state that the work memory has.
  paths_->velocity_accelerations({found, count}, work);
  paths_->motions(view.positions(), view.accelerations, {motions, count}, work);
  for (std::size_t i = 0; i < count; ++i) {
    found[i].angular += motions[i].angular_velocity;
    found[i].linear += motions[i].velocity;
  }
}

void Signals::read(const LoadView& view, std::span<double> values) const noexcept {
  if (!readings_.empty()) read_sensors(view, {}, nullptr);
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const Source& source = sources_[i];
    if (source.element) {
      values[i] = source.element->rate ? view.speeds()[source.element->index] : view.positions()[source.element->index];
    } else if (source.load == nullptr) {
      values[i] = view.scratch[source.number];
    } else {
      const LoadOutput& output = *source.load->output();
      LoadSlot held;
      for (const LoadSlot& slot : view.layout.discrete_slots) {
        if (slot.load == source.index) held = slot;
      }
      const std::span<double> given = view.scratch.subspan(own_, output.outputs());
      output.read({view.t, view.layout, view.y, view.y.subspan(held.first, held.count),
                   view.y.subspan(source.continuous.first, source.continuous.count),
                   view.scratch.subspan(own_ + output.outputs()), view.accelerations},
                  given);
      values[i] = given[source.output];
    }
  }
}

}  // namespace withy
