/// \file
/// Soft stops at the ends of a coordinate's range. With d the depth beyond a stop and ḋ its rate,
///   |τ| = f(d) max(0, 1 + α ḋ)   (Hunt & Crossley 1975),   f = k d²/(2w) for d < w, k (d − w/2) beyond:
/// a stop pushes and never pulls, and the effort sets in with slope zero.
#include <algorithm>
#include <limits>
#include <utility>

#include "withy/core/plugin/kinks.hpp"
#include "withy/core/plugin/load_numbers.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/loads/hinge_rate.hpp"

namespace withy {
namespace {

struct Limits {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  double stiffness = 0;    ///< k [N m/rad, N/m]
  double dissipation = 0;  ///< α [s/rad, s/m]
  double onset = 0;        ///< w [rad, m]

  /// Push of a stop that is entered by `depth` at a rate.
  double push(double depth, double rate) const noexcept {
    if (depth <= 0) return 0;
    const double elastic = depth < onset ? stiffness * depth * depth / (2 * onset) : stiffness * (depth - 0.5 * onset);
    return elastic * std::max(0.0, 1 + dissipation * rate);
  }
  /// Derivatives of `push` with respect to depth and rate.
  std::pair<double, double> push_slopes(double depth, double rate) const noexcept {
    if (depth <= 0 || 1 + dissipation * rate <= 0) return {0, 0};
    const double stiffness_here = depth < onset ? stiffness * depth / onset : stiffness;
    return {stiffness_here * (1 + dissipation * rate), dissipation * push(depth, 0)};
  }
  /// Derivatives of the effort with respect to x and its rate: both stops push against a displacement towards them.
  std::pair<double, double> slopes(double x, double rate) const noexcept {
    const auto below = push_slopes(lower - x, -rate), above = push_slopes(x - upper, rate);
    return {-below.first - above.first, -below.second - above.second};
  }
  double operator()(double x, double rate) const noexcept { return push(lower - x, -rate) - push(x - upper, rate); }
};

class BoundLimit final : public BoundLoad, public LoadNumbers, public Kinks {
 public:
  /// \param unit of the coordinate
  BoundLimit(const Limits& limits, std::size_t position, std::size_t speed, std::string unit)
      : limits_(limits), position_(position), speed_(speed), unit_(std::move(unit)) {}
  /// How far the nearest stop is.
  std::vector<SensorColumn> numbers() const override { return {{"margin", unit_}}; }
  void show(const LoadView& view, std::span<double> values) const noexcept override {
    kinks(view.positions(), view.speeds(), values);
  }
  std::size_t kinks() const override { return 1; }
  void kinks(std::span<const double> positions, std::span<const double> /*speeds*/,
             std::span<double> values) const noexcept override {
    const double x = positions[position_];
    values[0] = std::min(x - limits_.lower, limits_.upper - x);
  }
  std::size_t scratch() const override { return 0; }
  void add(double /*t*/, std::span<const double> positions, std::span<const double> speeds, std::span<double> efforts,
           std::span<double> /*scratch*/) const noexcept override {
    efforts[speed_] += limits_(positions[position_], speeds[speed_]);
  }
  bool add_derivatives(double /*t*/, std::span<const double> positions, std::span<const double> speeds,
                       Eigen::Ref<Eigen::MatrixXd> by_position, Eigen::Ref<Eigen::MatrixXd> by_speed) const override {
    const auto i = static_cast<Eigen::Index>(speed_);
    const auto [by_x, by_rate] = limits_.slopes(positions[position_], speeds[speed_]);
    by_position(i, i) += by_x;
    by_speed(i, i) += by_rate;
    return true;
  }
  std::vector<double> discontinuities() const override { return {}; }
  double end() const override { return 0; }
  void begin(State& /*state*/) const override {}

 private:
  Limits limits_;
  std::size_t position_;
  std::size_t speed_;
  std::string unit_;
};

class HingeLimit final : public Load {
 public:
  HingeLimit(RateName rate, const Limits& limits) : rate_(std::move(rate)), limits_(limits) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    const std::size_t speed = speed_index(model, rate_), position = position_index(model, rate_);
    const HingeNode& hinge = model.hinges()[static_cast<std::size_t>(model.hinge(rate_.hinge))];
    const bool angular = hinge_rates(*hinge.hinge)[rate_.component].angular;
    return std::make_unique<BoundLimit>(limits_, position, speed, angular ? "rad" : "m");
  }

 private:
  RateName rate_;
  Limits limits_;
};

std::unique_ptr<Load> make_hinge_limit(const Value& p, const MakeContext& context) {
  Limits limits;
  limits.stiffness = p.number_at("stiffness");
  limits.dissipation = p.number_at("dissipation");
  limits.onset = p.number_at("onset");
  if (const Value* v = p.find("lower")) limits.lower = v->number();
  if (const Value* v = p.find("upper")) limits.upper = v->number();
  if (!p.has("lower") && !p.has("upper")) {
    context.diagnostics.error(p.place(), "has no stop; need 'lower', 'upper' or both");
    return nullptr;
  }
  if (!(limits.lower < limits.upper)) {
    context.diagnostics.error(p.at("upper").place(), "'upper' is not above 'lower'");
    return nullptr;
  }
  return std::make_unique<HingeLimit>(rate_name(p), limits);
}

}  // namespace

void enroll_hinge_limit(Enrollment& enrollment) {
  enrollment.add<Load>(
      {.id = "hinge-limit",
       .summary = "Soft stops at the ends of a coordinate's range; per metre where the coordinate is a length",
       .parameters = rate_parameters(
           {number("lower", "rad|m", "coordinate of the lower stop").optional(),
            number("upper", "rad|m", "coordinate of the upper stop").optional(),
            number("stiffness", "N m/rad|N/m", "of a stop that is entered beyond its onset").above(0),
            number("dissipation", "s/rad|s/m", "a slow impact at rate v comes back with (1 − 2/3 dissipation v) v")
                .least(0)
                .otherwise(0.0),
            number("onset", "rad|m", "depth over which the stiffness grows from zero").above(0).otherwise(0.01)}),
       .make = &make_hinge_limit});
}

}  // namespace withy
