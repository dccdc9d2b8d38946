// From rest to rest along a cycloid: x = from + (to − from) (τ − sin 2πτ / 2π), τ = t / duration.
#include <cmath>
#include <numbers>
#include <withy/core/plugin/motion.hpp>

#include "laws.hpp"

namespace example {
namespace {

class Cycloid final : public withy::Motion {
 public:
  Cycloid(double from, double to, double duration) : from_(from), change_(to - from), duration_(duration) {}
  bool locks() const override { return false; }
  withy::MotionPoint at(double t) const noexcept override {
    if (!(t > 0)) return {from_, 0, 0};
    if (t >= duration_) return {from_ + change_, 0, 0};
    const double w = 2 * std::numbers::pi, r = t / duration_;
    return {from_ + change_ * (r - std::sin(w * r) / w), change_ * (1 - std::cos(w * r)) / duration_,
            change_ * w * std::sin(w * r) / (duration_ * duration_)};
  }
  std::vector<double> discontinuities() const override { return {0, duration_}; }
  double end() const override { return duration_; }

 private:
  double from_, change_, duration_;
};

std::unique_ptr<withy::Motion> make_cycloid(const withy::Value& p, const withy::MakeContext& /*context*/) {
  return std::make_unique<Cycloid>(p.number_at("from"), p.number_at("to"), p.number_at("duration"));
}

}  // namespace

withy::Plugin<withy::Motion> cycloid() {
  return {.id = "cycloid",
          .summary = "From rest to rest along a cycloid",
          .parameters = {withy::number("from", "rad", "coordinate at time 0").otherwise(0.0),
                         withy::number("to", "rad", "coordinate at the end"),
                         withy::number("duration", "s", "time until the end").above(0)},
          .make = &make_cycloid};
}

}  // namespace example
