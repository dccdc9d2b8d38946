#include "withy/loads/shaped_motion.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "withy/core/plugin/course_of_time.hpp"
#include "withy/core/plugin/motion.hpp"

namespace withy {
namespace {

/// One of the copies of a motion that are added up.
struct Impulse {
  double delay = 0;  ///< [s]
  double share = 1;  ///< all of them sum to 1
};
using Impulses = std::vector<Impulse>;

/// Beyond this many an evaluation costs more than the model does.
constexpr std::size_t most_impulses = 1024;

/// A motion of one coordinate that begins with its first copy and comes to rest with its last.
class Shaped final : public Motion, public CourseOfTime {
 public:
  Shaped(std::unique_ptr<Motion> motion, Impulses impulses)
      : motion_(std::move(motion)), impulses_(std::move(impulses)) {
    const auto* course = dynamic_cast<const CourseOfTime*>(motion_.get());
    follows_formula_ = course != nullptr && course->courses() > 0;
  }
  bool locks() const override { return false; }
  MotionPoint at(double t) const noexcept override {
    MotionPoint sum;
    for (const Impulse& impulse : impulses_) {
      const MotionPoint p = motion_->at(t - impulse.delay);
      sum.position += impulse.share * p.position;
      sum.rate += impulse.share * p.rate;
      sum.acceleration += impulse.share * p.acceleration;
    }
    return sum;
  }
  std::vector<double> discontinuities() const override {
    std::vector<double> times;
    for (const double time : motion_->discontinuities())
      for (const Impulse& impulse : impulses_) times.push_back(time + impulse.delay);
    std::sort(times.begin(), times.end());
    // Copies that begin together may be apart by rounding; no step is as short.
    const auto together = [](double a, double b) { return b - a <= 1e-12 * std::abs(b); };
    times.erase(std::unique(times.begin(), times.end(), together), times.end());
    return times;
  }
  double end() const override { return motion_->end() > 0 ? motion_->end() + impulses_.back().delay : 0; }
  std::size_t courses() const override { return follows_formula_ ? 1 : 0; }
  void course(double t, std::span<double> values) const noexcept override { values[0] = at(t).acceleration; }

 private:
  std::unique_ptr<Motion> motion_;
  Impulses impulses_;  ///< delays do not decrease
  bool follows_formula_ = false;
};

/// What leaves a mode of the frequency ω and the damping ratio ζ at rest: half a damped period T/2 = π/(ω √(1 − ζ²))
/// apart, with K = exp(−ζ π/√(1 − ζ²)), in the shares of (1 + K)ⁿ. n − 1 derivatives by ω of what is left are zero
/// (Singer & Seering 1990).
Impulses shaper(double frequency, double damping_ratio, int n) {
  const double root = std::sqrt((1 - damping_ratio) * (1 + damping_ratio));
  const double half_period = 0.5 / (frequency * root), decay = std::exp(-damping_ratio * std::numbers::pi / root);
  Impulses impulses;
  double binomial = 1;
  for (int k = 0; k <= n; ++k) {
    impulses.push_back({k * half_period, binomial * std::pow(decay, k) / std::pow(1 + decay, n)});
    binomial *= static_cast<double>(n - k) / (k + 1);
  }
  return impulses;
}

/// Each of the one after each of the other.
Impulses convolved(const Impulses& one, const Impulses& other) {
  Impulses all;
  for (const Impulse& a : one)
    for (const Impulse& b : other) all.push_back({a.delay + b.delay, a.share * b.share});
  std::stable_sort(all.begin(), all.end(), [](const Impulse& a, const Impulse& b) { return a.delay < b.delay; });
  return all;
}

/// The shapers of all modes; nothing after a reported error.
Impulses shaper_of_modes(const Value& p, const MakeContext& context) {
  const std::string& kind = p.text_at("shaper");
  const int order = kind == "none" ? 0 : kind == "zv" ? 1 : kind == "zvd" ? 2 : 3;
  const Value& modes = p.at("modes");
  Impulses all{{}};
  for (const Value& row : modes.items()) {
    const double frequency = row.items()[0].number(), damping_ratio = row.items()[1].number();
    if (!(frequency > 0) || !(damping_ratio >= 0 && damping_ratio < 1)) {
      context.diagnostics.error(row.place(), "needs a frequency > 0 [Hz] and a damping ratio >= 0 and < 1");
      return {};
    }
    all = convolved(all, shaper(frequency, damping_ratio, order));
    if (all.size() > most_impulses) {
      context.diagnostics.error(modes.place(),
                                "is of so many modes that more than 1024 copies of the motion would be added up; "
                                "need fewer, or the shaper zv");
      return {};
    }
  }
  return all;
}

std::unique_ptr<Motion> make_shaped(const Value& p, const MakeContext& context) {
  const Value& given = p.at("motion");
  const std::string& type = given.text_at("type");
  const auto* plugin = context.registry.find<Motion>(type);
  std::unique_ptr<Motion> motion = plugin != nullptr ? plugin->make(given, context) : nullptr;
  Impulses impulses = shaper_of_modes(p, context);
  if (motion == nullptr || impulses.empty()) return nullptr;
  if (motion->locks()) {
    context.diagnostics.error(given.place(), "'" + type + "' is no function of time that could be shaped");
    return nullptr;
  }
  return std::make_unique<Shaped>(std::move(motion), std::move(impulses));
}

}  // namespace

void enroll_shaped_motion(Enrollment& enrollment) {
  enrollment.add<Motion>(
      {.id = "shaped",
       .summary = "Another motion in copies that follow each other, so that given modes do not ring after it",
       .parameters = {text("motion", "what is shaped, with its options").naming(ParameterSpec::Refers::motion),
                      table("modes", {"Hz", "1"}, "frequency and damping ratio of each mode that is not to ring"),
                      text("shaper",
                           "which stands a frequency that is wrong the better the longer it takes: half a period (zv), "
                           "one (zvd) or one and a half (zvdd) of each mode; none: the motion as it is")
                          .one_of({"none", "zv", "zvd", "zvdd"})
                          .otherwise("zvd")},
       .make = &make_shaped});
}

}  // namespace withy
