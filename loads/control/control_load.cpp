#include "withy/loads/control/control_load.hpp"

#include <algorithm>
#include <stdexcept>

#include "withy/core/kinematics/signals.hpp"
#include "withy/core/model/columns.hpp"

namespace withy {
namespace {

/// The coordinate whose derivative a rate is, and the rate, by the names of their columns.
struct NamedRate {
  std::string coordinate, rate;
};

NamedRate named_rate(const Model& model, const RateName& name) {
  position_index(model, name);  // throws where it is the derivative of none
  const HingeNode& hinge = model.hinges()[static_cast<std::size_t>(model.hinge(name.hinge))];
  const HingeRate rate = hinge_rates(*hinge.hinge)[name.component];
  return {coordinate_columns(hinge)[*rate.coordinate].name, rate_columns(hinge)[name.component].name};
}

/// The rate whose coordinate has this column.
std::string rate_of(const Model& model, const std::string& coordinate) {
  for (const HingeNode& hinge : model.hinges()) {
    const std::vector<HingeRate> rates = hinge_rates(*hinge.hinge);
    for (std::size_t i = 0; i < rates.size(); ++i) {
      if (rates[i].coordinate && coordinate_columns(hinge)[*rates[i].coordinate].name == coordinate)
        return rate_columns(hinge)[i].name;
    }
  }
  throw std::invalid_argument("the derivative of signal '" + coordinate +
                              "' is not measured: it is no coordinate of a hinge; give a 'filter'");
}

std::vector<std::string> measured(const Model& model, const ControlEnds& ends) {
  std::vector<std::string> names;
  for (const std::string& name : ends.of) {
    names.push_back(name);
    if (ends.rate_too) names.push_back(rate_of(model, name));
  }
  if (ends.of.empty() && !ends.measures_nothing && !ends.rate_of_hinge) {
    const NamedRate own = named_rate(model, *ends.hinge);
    names.push_back(own.coordinate);
    if (ends.rate_too) names.push_back(own.rate);
  }
  if (ends.rate_of_hinge) {
    const auto speed = speed_index(model, *ends.hinge);  // throws where there is none
    const auto h = static_cast<std::size_t>(model.hinge(ends.hinge->hinge));
    names.push_back(rate_columns(model.hinges()[h])[speed - model.layout().hinges[h].speed].name);
  }
  return names;
}

std::vector<InputPlace> places_of(const Model& model, const ControlEnds& ends) {
  if (!ends.acts) return {};
  if (ends.to.empty()) return {{.speed = static_cast<int>(speed_index(model, *ends.hinge)), .frame = {}}};
  std::vector<InputPlace> all;
  for (const std::string& name : ends.to) {
    const auto named = [&](const LoadNode& node) { return node.name == name; };
    const auto node = std::find_if(model.loads().begin(), model.loads().end(), named);
    if (node == model.loads().end() || node->load->input() == nullptr)
      throw std::invalid_argument("'" + name + "' is no load of type input, through which a controller acts");
    all.push_back(node->load->input()->place());
  }
  return all;
}

/// What the continuous and the sampled controller have in common.
class BoundControl : public BoundLoad, public LoadOutput {
 public:
  BoundControl(const Model& model, const Terms& terms, ControlEnds ends, std::shared_ptr<const ControlBlock> block)
      : ends_(std::move(ends)),
        block_(std::move(block)),
        signals_(model, terms, measured(model, ends_)),
        places_(places_of(model, ends_)) {
    expect(signals_.size(), block_->inputs(), "signals", "of");
    if (ends_.acts) expect(places_.size(), block_->outputs(), "places to act", "to");
    for (const InputPlace& place : places_)
      if (place.speed < 0) frames_.push_back(place.frame);
    follow_accelerations();
  }

  std::size_t scratch() const override { return block_->inputs() + block_->outputs() + signals_.scratch(); }
  void add(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
           std::span<double> /*efforts*/, std::span<double> /*scratch*/) const noexcept override {}
  bool add_derivatives(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
                       Eigen::Ref<Eigen::MatrixXd> /*by_position*/,
                       Eigen::Ref<Eigen::MatrixXd> /*by_speed*/) const override {
    return true;  // `add` adds nothing
  }
  std::span<const FrameIndex> frames() const override { return frames_; }
  void wrenches(double /*t*/, std::span<const FrameMotion> /*motions*/,
                std::span<Wrench> wrenches) const noexcept override {
    std::fill(wrenches.begin(), wrenches.end(), Wrench{});
  }
  double end() const override { return block_->end(); }
  void begin(State& /*state*/) const override {}
  const LoadOutput* output() const override { return this; }
  std::size_t outputs() const override { return block_->outputs(); }
  bool needs_accelerations() const override { return follows_accelerations_; }

 protected:
  [[nodiscard]] const ControlEnds& ends() const { return ends_; }
  [[nodiscard]] const ControlBlock& block() const { return *block_; }
  [[nodiscard]] const std::shared_ptr<const ControlBlock>& shared_block() const { return block_; }
  [[nodiscard]] const Signals& signals() const { return signals_; }
  [[nodiscard]] const std::vector<InputPlace>& places() const { return places_; }

  /// What is measured, in the scratch space.
  std::span<const double> measure(const LoadView& view) const noexcept {
    const std::span<double> w = view.scratch.first(block_->inputs());
    LoadView behind = view;
    behind.scratch = view.scratch.subspan(block_->inputs() + block_->outputs());
    signals_.read(behind, w);
    return w;
  }
  /// Where outputs stand in the scratch space.
  std::span<double> commands(std::span<double> scratch) const noexcept {
    return scratch.subspan(block_->inputs(), block_->outputs());
  }
  void act(std::span<const double> v, std::span<double> efforts) const noexcept {
    for (std::size_t i = 0; i < places_.size(); ++i)
      if (places_[i].speed >= 0) efforts[static_cast<std::size_t>(places_[i].speed)] += v[i];
  }
  void act_at_frames(std::span<const double> v, std::span<const FrameMotion> motions,
                     std::span<Wrench> wrenches) const noexcept {
    std::size_t next = 0;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const InputPlace& place = places_[i];
      if (place.speed >= 0) continue;
      const Vector3 acting = v[i] * place.direction;
      Vector3& part = place.moment ? wrenches[next].moment : wrenches[next].force;
      part += place.following ? Vector3(motions[next].R * acting) : acting;
      ++next;
    }
  }

 private:
  /// What is commanded may depend on accelerations at once where nothing acts by it at once.
  void follow_accelerations() {
    for (std::size_t i = 0; i < signals_.size(); ++i) {
      const std::string& name = signals_.names()[i];
      if (!signals_.needs_accelerations(i)) continue;
      if (ends_.sample > 0)
        throw std::invalid_argument(
            "signal '" + name +
            "' depends on accelerations; a sampled controller measures positions and rates: make "
            "it continuous, with a lag behind it");
      if (!block_->feeds_through(i)) continue;
      follows_accelerations_ = true;
      if (ends_.acts)
        throw std::invalid_argument(
            "signal '" + name +
            "' depends on accelerations, and the effort follows it at once: "
            "the loop " +
            name + " -> this load -> accelerations -> " + name +
            " is algebraic; put a lag between: 'to: nothing' and an actuator that measures this "
            "load, or a transfer-function whose numerator has the lower degree");
    }
  }
  static void expect(std::size_t got, std::size_t needed, const char* what, const char* key) {
    if (got != needed)
      throw std::invalid_argument("got " + std::to_string(got) + " " + what + " ('" + key + "'); it has " +
                                  std::to_string(needed));
  }

  ControlEnds ends_;
  std::shared_ptr<const ControlBlock> block_;
  Signals signals_;
  std::vector<InputPlace> places_;
  std::vector<FrameIndex> frames_;
  bool follows_accelerations_ = false;  ///< what it commands does, at once
};

/// In continuous time: the block's states are the load's.
class ContinuousControl final : public BoundControl, public ContinuousPart {
 public:
  ContinuousControl(const Model& model, const Terms& terms, ControlEnds ends, std::shared_ptr<const ControlBlock> block)
      : BoundControl(model, terms, std::move(ends), std::move(block)), states_(this->block().states()) {
    for (std::size_t i = 0; i < signals().size(); ++i) along_.push_back(speed_along(model, signals().element(i)));
  }

  std::unique_ptr<BoundLoad> rebound(const Model& model, const Terms& terms) const override {
    if (!signals().of_frames() && !signals().of_loads()) return nullptr;
    return std::make_unique<ContinuousControl>(model, terms, ends(), shared_block());
  }
  const ContinuousPart* continuous() const override { return this; }
  std::vector<double> discontinuities() const override { return block().discontinuities(); }
  std::size_t states() const override { return states_.size(); }
  std::string name(std::size_t state) const override { return states_[state]; }
  void begin(const LoadView& view, std::span<double> continuous) const noexcept override {
    block().begin(view.t, measure(view), continuous);
  }
  void rates(const LoadView& view, std::span<double> rates) const noexcept override {
    block().rates(view.t, measure(view), view.continuous, rates);
  }
  void add(const LoadView& view, std::span<double> efforts) const noexcept override { act(command(view), efforts); }
  void add_wrenches(const LoadView& view, std::span<const FrameMotion> motions,
                    std::span<Wrench> wrenches) const noexcept override {
    act_at_frames(command(view), motions, wrenches);
  }
  void read(const LoadView& view, std::span<double> values) const noexcept override {
    const std::span<const double> v = command(view);
    std::copy(v.begin(), v.end(), values.begin());
  }
  bool add_derivatives(const LoadView& view, ContinuousDerivatives& to) const override {
    if (std::any_of(along_.begin(), along_.end(), [](int speed) { return speed < 0; })) return false;
    const auto m = static_cast<Eigen::Index>(block().inputs()), p = static_cast<Eigen::Index>(block().outputs()),
               k = static_cast<Eigen::Index>(states_.size()), acting = static_cast<Eigen::Index>(places().size());
    ControlBlock::Slopes s{Eigen::MatrixXd::Zero(k, m), Eigen::MatrixXd::Zero(k, k), Eigen::MatrixXd::Zero(p, m),
                           Eigen::MatrixXd::Zero(p, k)};
    if (!block().slopes(view.t, measure(view), view.continuous, s)) return false;
    to.rate_by_state += s.rate_by_state;
    for (Eigen::Index j = 0; j < m; ++j) {
      const auto input = static_cast<std::size_t>(j);
      const bool rate = signals().element(input)->rate;
      (rate ? to.rate_by_speed : to.rate_by_position).col(along_[input]) += s.rate_by_input.col(j);
      for (Eigen::Index i = 0; i < acting; ++i) {
        const int speed = places()[static_cast<std::size_t>(i)].speed;
        if (speed >= 0)
          (rate ? to.effort_by_speed : to.effort_by_position)(speed, along_[input]) += s.output_by_input(i, j);
      }
    }
    for (Eigen::Index i = 0; i < acting; ++i) {
      const int speed = places()[static_cast<std::size_t>(i)].speed;
      if (speed >= 0) to.effort_by_state.row(speed) += s.output_by_state.row(i);
    }
    return true;
  }
  using BoundControl::add;
  using BoundControl::add_derivatives;
  using BoundControl::begin;

 private:
  [[nodiscard]] std::span<const double> command(const LoadView& view) const noexcept {
    const std::span<double> v = commands(view.scratch);
    block().output(view.t, measure(view), view.continuous, v);
    return v;
  }
  /// The speed that a signal is, or along which alone it changes; −1 where there is no such one.
  static int speed_along(const Model& model, const std::optional<Signals::Element>& element) {
    if (!element) return -1;
    if (element->rate) return static_cast<int>(element->index);
    for (std::size_t h = 0; h < model.hinges().size(); ++h) {
      const Slot& slot = model.layout().hinges[h];
      const std::vector<HingeRate> rates = hinge_rates(*model.hinges()[h].hinge);
      // Where all rates are derivatives of coordinates a displacement along one moves that coordinate alone.
      const bool plain = slot.positions == slot.speeds &&
                         std::all_of(rates.begin(), rates.end(), [](const HingeRate& r) { return bool(r.coordinate); });
      for (std::size_t i = 0; plain && i < rates.size(); ++i)
        if (slot.position + *rates[i].coordinate == element->index) return static_cast<int>(slot.speed + i);
    }
    return -1;
  }

  std::vector<std::string> states_;
  std::vector<int> along_;  ///< one a signal
};

/// By the clock. Discrete states: whether it has begun, the block's states, and commands from the one that acts to the
/// one just made, later by the delay.
class SampledControl final : public BoundControl, public DiscretePart {
 public:
  SampledControl(const Model& model, ControlEnds ends, std::shared_ptr<const ControlBlock> block)
      : BoundControl(model, Terms{}, std::move(ends), std::move(block)),
        layout_(model.layout()),
        count_(this->block().states().size()) {
    if (signals().of_loads())
      throw std::invalid_argument("a sampled controller measures positions, rates and outputs; not what loads give");
    const bool flexible = std::any_of(model.bodies().begin(), model.bodies().end(),
                                      [](const BodyNode& b) { return b.body->shape().modes() > 0; });
    if (signals().of_frames() && flexible)
      throw std::invalid_argument(
          "a sampled controller measures frames of rigid bodies, and coordinates of hinges; here bodies are flexible");
  }

  std::size_t scratch() const override { return BoundControl::scratch() + layout_.positions + layout_.speeds; }
  const DiscretePart* discrete() const override { return this; }
  std::vector<double> discontinuities() const override { return {}; }  // seen at the samples alone
  std::size_t states() const override { return 1 + count_ + (ends().delay + 1) * outputs(); }
  double period() const override { return ends().sample; }
  void renew(double t, std::span<const double> positions, std::span<const double> speeds, const Crossing& /*crossing*/,
             std::span<double> discrete, std::span<double> scratch) const noexcept override {
    const std::span<double> y = scratch.first(layout_.positions + layout_.speeds);
    std::copy(positions.begin(), positions.end(), y.begin());
    std::copy(speeds.begin(), speeds.end(), y.begin() + static_cast<std::ptrdiff_t>(layout_.positions));
    const LoadView view{t, layout_, y, discrete, {}, scratch.subspan(y.size())};
    const std::span<const double> w = measure(view);
    const std::span<double> z = discrete.subspan(1, count_), queue = discrete.subspan(1 + count_);
    if (discrete[0] == 0) block().begin(t, w, z);
    discrete[0] = 1;
    const std::size_t p = outputs();
    std::copy(queue.begin() + static_cast<std::ptrdiff_t>(p), queue.end(), queue.begin());
    block().output(t, w, z, queue.last(p));
    block().advance(t, w, z);
  }
  void add(double /*t*/, std::span<const double> discrete, std::span<double> efforts) const noexcept override {
    act(discrete.subspan(1 + count_, outputs()), efforts);
  }
  void add_wrenches(double /*t*/, std::span<const double> discrete, std::span<const FrameMotion> motions,
                    std::span<Wrench> wrenches) const noexcept override {
    act_at_frames(discrete.subspan(1 + count_, outputs()), motions, wrenches);
  }
  void read(const LoadView& view, std::span<double> values) const noexcept override {
    const std::span<const double> v = view.discrete.subspan(1 + count_, outputs());
    std::copy(v.begin(), v.end(), values.begin());
  }
  using BoundControl::add;

 private:
  Layout layout_;      ///< of positions and speeds
  std::size_t count_;  ///< states of the block
};

class Control final : public Load {
 public:
  Control(ControlEnds ends, std::shared_ptr<const ControlBlock> block)
      : ends_(std::move(ends)), block_(std::move(block)) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    if (ends_.sample > 0) return std::make_unique<SampledControl>(model, ends_, block_);
    return std::make_unique<ContinuousControl>(model, Terms{}, ends_, block_);
  }

 private:
  ControlEnds ends_;
  std::shared_ptr<const ControlBlock> block_;
};

}  // namespace

std::unique_ptr<Load> make_control(ControlEnds ends, std::shared_ptr<const ControlBlock> block) {
  return std::make_unique<Control>(std::move(ends), std::move(block));
}

}  // namespace withy
