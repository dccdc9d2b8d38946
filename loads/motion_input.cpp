#include "withy/loads/motion_input.hpp"

#include <algorithm>
#include <stdexcept>

#include "withy/core/model/hinge_rates.hpp"
#include "withy/core/model/hosted_motion.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/effortless_load.hpp"

namespace withy {
namespace {

/// What the host sets: q, q̇ or q̈.
enum class Sets { position, rate, acceleration };

/// From t0, where the coordinate is at x0 with the rate v0, to t1 the acceleration goes in a straight line from a0 to
/// a1. After t1 it is zero, of accelerations that are set a1. Until the host sets something the rate is that of the
/// beginning.
class BoundMotionInput final : public EffortlessLoad, public DiscretePart, public InputPort, public HostedMotion {
 public:
  BoundMotionInput(Sets sets, bool linear, std::size_t position, std::size_t speed, bool angular)
      : sets_(sets), linear_(linear), position_(position), speed_(speed), unit_(angular ? "rad" : "m") {
    if (sets == Sets::rate) unit_ += "/s";
    if (sets == Sets::acceleration) unit_ += "/s^2";
  }

  std::size_t speed() const noexcept override { return speed_; }
  bool jumps() const noexcept override { return sets_ == Sets::acceleration; }
  MotionPoint at(double t, std::span<const double> d) const noexcept override {
    const double length = d[ends_] - d[begins_];
    const double s = std::clamp(t - d[begins_], 0.0, length);
    const double slope = length > 0 ? (d[last_] - d[first_]) / length : 0;
    MotionPoint p;
    p.acceleration = d[first_] + slope * s;
    p.rate = d[v0_] + s * (d[first_] + s * slope / 2);
    p.position = d[x0_] + s * (d[v0_] + s * (d[first_] / 2 + s * slope / 6));
    const double after = t - d[ends_];
    if (!(after > 0)) return p;
    p.acceleration = jumps() ? d[last_] : 0;
    p.position += after * (p.rate + after * p.acceleration / 2);
    p.rate += after * p.acceleration;
    return p;
  }

  std::string unit() const override { return unit_; }
  InputPlace place() const override { return {.speed = static_cast<int>(speed_), .frame = {}}; }
  bool interpolates() const override { return !jumps() || linear_; }
  bool is_set(std::span<const double> d) const noexcept override { return d[set_] != 0; }
  double value(double t, std::span<const double> d) const noexcept override {
    const MotionPoint p = at(t, d);
    return sets_ == Sets::position ? p.position : sets_ == Sets::rate ? p.rate : p.acceleration;
  }
  void set(double t, double reached, double value, std::span<double> d) const noexcept override {
    const MotionPoint now = at(t, d);
    const double before = t - d[begins_], h = std::max(0.0, reached - t);
    const double mean_before = is_set(d) && before > 0 ? (now.position - d[x0_]) / before : now.rate;
    const double span_before = is_set(d) && before > 0 ? before : 0;
    d[set_] = 1;
    d[begins_] = t, d[ends_] = t + h, d[x0_] = now.position, d[v0_] = now.rate;
    d[first_] = d[last_] = 0;
    if (sets_ == Sets::acceleration) {
      d[last_] = value;
      d[first_] = linear_ && h > 0 ? now.acceleration : value;
    } else if (h > 0 && sets_ == Sets::rate) {
      d[first_] = d[last_] = (value - now.rate) / h;
    } else if (h > 0) {
      // It ends with the slope there of the parabola through the places where this line and the one before begin and
      // this one ends; the first line of all begins with the rate that there is.
      const double mean = (value - now.position) / h;
      const double end = mean + (mean - mean_before) * h / (h + span_before);
      d[first_] = (6 * mean - 4 * now.rate - 2 * end) / h;
      d[last_] = (-6 * mean + 2 * now.rate + 4 * end) / h;
    }
  }

  std::size_t states() const override { return count_; }
  void renew(double t, std::span<const double> positions, std::span<const double> speeds, const Crossing& /*crossing*/,
             std::span<double> d, std::span<double> /*scratch*/) const noexcept override {
    if (is_set(d)) return;
    d[begins_] = d[ends_] = t;
    d[x0_] = positions[position_];
    d[v0_] = speeds[speed_];
  }
  void add(double /*t*/, std::span<const double> /*discrete*/, std::span<double> /*efforts*/) const noexcept override {}

  using EffortlessLoad::add;
  const DiscretePart* discrete() const override { return this; }
  const InputPort* input() const override { return this; }

 private:
  enum : std::size_t { set_, begins_, ends_, x0_, v0_, first_, last_, count_ };
  Sets sets_;
  bool linear_;  ///< of accelerations
  std::size_t position_, speed_;
  std::string unit_;
};

class LawOfMotion final : public Load {
 public:
  LawOfMotion(Sets sets, bool linear, std::string hinge) : sets_(sets), linear_(linear), hinge_(std::move(hinge)) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    const int index = model.hinge(hinge_);
    if (index < 0) throw std::invalid_argument("there is no hinge '" + hinge_ + "'");
    const Slot& slot = model.layout().hinges[static_cast<std::size_t>(index)];
    const std::vector<HingeRate> rates = hinge_rates(*model.hinges()[static_cast<std::size_t>(index)].hinge);
    if (slot.positions != 1 || rates.size() != 1)
      throw std::invalid_argument("hinge '" + hinge_ + "' has " + std::to_string(slot.speeds) +
                                  " rates; an input moves hinges with one coordinate");
    return std::make_unique<BoundMotionInput>(sets_, linear_, slot.position, slot.speed, rates.front().angular);
  }

 private:
  Sets sets_;
  bool linear_;
  std::string hinge_;
};

class MotionInput final : public Motion, public MotionByLoad {
 public:
  MotionInput(Sets sets, bool linear) : sets_(sets), linear_(linear) {}
  bool locks() const override { return true; }
  MotionPoint at(double /*t*/) const noexcept override { return {}; }
  std::vector<double> discontinuities() const override { return {}; }
  double end() const override { return 0; }
  std::unique_ptr<Load> load(const std::string& hinge) const override {
    return std::make_unique<LawOfMotion>(sets_, linear_, hinge);
  }

 private:
  Sets sets_;
  bool linear_;
};

std::unique_ptr<Motion> make_motion_input(const Value& p, const MakeContext& context) {
  const std::string what = p.text_at("sets");
  const Sets sets = what == "position" ? Sets::position : what == "rate" ? Sets::rate : Sets::acceleration;
  if (p.has("hold") && sets != Sets::acceleration) {
    context.diagnostics.error(p.at("hold").place(),
                              "is of accelerations; a " + what + " is reached at the end of a step");
    return nullptr;
  }
  return std::make_unique<MotionInput>(sets, p.has("hold") && p.text_at("hold") == "linear");
}

}  // namespace

void enroll_motion_input(Enrollment& enrollment) {
  enrollment.add<Motion>(
      {.id = "input",
       .summary = "Position, rate or acceleration that a host sets between steps; until then the rate stays",
       .parameters =
           {text("sets", "what the host sets").one_of({"position", "rate", "acceleration"}).otherwise("position"),
            text("hold", "of accelerations: one holds, which is the default, or a straight line leads to it")
                .one_of({"constant", "linear"})
                .optional()},
       .make = &make_motion_input});
}

}  // namespace withy
