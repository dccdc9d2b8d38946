/// \file
/// Proportional and derivative feedback on single coordinates, continuous in time or sampled:
///   τ = k (x_r − x) + c (ẋ_r − ẋ),  or  τ_max tanh(τ / τ_max) of it where the effort is limited.
#include <cmath>
#include <limits>

#include "withy/core/plugin/registry.hpp"
#include "withy/loads/followed_hinges.hpp"
#include "withy/loads/sampled.hpp"

namespace withy {
namespace {

struct Gains {
  double stiffness = 0;                                    ///< k [N m/rad, N/m]
  double damping = 0;                                      ///< c [N m s/rad, N s/m]
  double limit = std::numeric_limits<double>::infinity();  ///< τ_max [N m, N]

  /// Derivative of the effort with respect to what it would be without limit.
  double slope(double error, double error_rate) const noexcept {
    const double share = std::tanh((stiffness * error + damping * error_rate) / limit);
    return 1 - share * share;
  }
  /// The effort without limit.
  double asked(double error, double error_rate) const noexcept { return stiffness * error + damping * error_rate; }
  double operator()(double error, double error_rate) const noexcept {
    const double effort = asked(error, error_rate);
    return limit < std::numeric_limits<double>::infinity() ? limit * std::tanh(effort / limit) : effort;
  }
};

/// A hinge's rate with its trajectory and gains.
struct Loop {
  RateName rate;
  Trajectory trajectory;
  Gains gains;
};

std::vector<RateName> rates_of(const std::vector<Loop>& loops) {
  std::vector<RateName> names;
  for (const Loop& loop : loops) names.push_back(loop.rate);
  return names;
}

std::vector<FollowedAxis> axes_of(const Model& model, const std::vector<Loop>& loops) {
  std::vector<FollowedAxis> axes;
  for (const Loop& loop : loops)
    axes.push_back({position_index(model, loop.rate), speed_index(model, loop.rate), loop.trajectory});
  return axes;
}

class BoundPdController final : public TrackingLoad {
 public:
  BoundPdController(const Model& model, const std::vector<Loop>& loops, bool begins_on)
      : TrackingLoad(model, rates_of(loops), axes_of(model, loops)),
        positions_(model.layout().positions),
        begins_on_(begins_on) {
    std::vector<double> limits;
    for (const Loop& loop : loops) {
      gains_.push_back(loop.gains);
      limits.push_back(loop.gains.limit);
    }
    add_limits(std::move(limits));
  }
  std::size_t scratch() const override { return 0; }
  void add(double t, std::span<const double> positions, std::span<const double> speeds, std::span<double> efforts,
           std::span<double> /*scratch*/) const noexcept override {
    for (std::size_t i = 0; i < axes().size(); ++i) efforts[axes()[i].speed] += effort(i, t, positions, speeds);
  }
  void commands(double t, std::span<const double> positions, std::span<const double> speeds, std::span<double> values,
                std::span<double> /*scratch*/) const noexcept override {
    for (std::size_t i = 0; i < axes().size(); ++i) values[i] = effort(i, t, positions, speeds);
  }
  bool add_derivatives(double t, std::span<const double> positions, std::span<const double> speeds,
                       Eigen::Ref<Eigen::MatrixXd> by_position, Eigen::Ref<Eigen::MatrixXd> by_speed) const override {
    for (std::size_t k = 0; k < axes().size(); ++k) {
      const FollowedAxis& axis = axes()[k];
      const MotionPoint r = at(axis.trajectory, t);
      const double share = gains_[k].slope(r.position - positions[axis.position], r.rate - speeds[axis.speed]);
      const auto i = static_cast<Eigen::Index>(axis.speed);
      by_position(i, i) -= share * gains_[k].stiffness;
      by_speed(i, i) -= share * gains_[k].damping;
    }
    return true;
  }
  void begin(State& state) const override {
    if (begins_on_) begin_on(axes(), positions_, state);
  }

 protected:
  double demand(std::size_t axis, double t, std::span<const double> positions,
                std::span<const double> speeds) const noexcept override {
    const FollowedAxis& a = axes()[axis];
    const MotionPoint r = at(a.trajectory, t);
    return gains_[axis].asked(r.position - positions[a.position], r.rate - speeds[a.speed]);
  }

 private:
  [[nodiscard]] double effort(std::size_t axis, double t, std::span<const double> positions,
                              std::span<const double> speeds) const noexcept {
    const FollowedAxis& a = axes()[axis];
    const MotionPoint r = at(a.trajectory, t);
    return gains_[axis](r.position - positions[a.position], r.rate - speeds[a.speed]);
  }

  std::size_t positions_;
  bool begins_on_;
  std::vector<Gains> gains_;  ///< one for each axis
};

class PdController final : public Load {
 public:
  /// \param period [s] between samples; 0: continuous
  PdController(std::vector<Loop> loops, bool begins_on, double period)
      : loops_(std::move(loops)), begins_on_(begins_on), period_(period) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    return sampled(std::make_unique<BoundPdController>(model, loops_, begins_on_), period_);
  }

 private:
  std::vector<Loop> loops_;
  bool begins_on_;
  double period_;
};

std::unique_ptr<Load> make_pd_controller(const Value& p, const MakeContext& context) {
  const auto hinges = TrajectoryReader(p, context).read();
  if (!hinges) return nullptr;
  std::vector<Loop> loops;
  for (const FollowedHinge& h : *hinges) {
    Gains gains{h.given->number_at("stiffness"), h.given->number_at("damping")};
    if (const Value* limit = h.given->find("limit")) gains.limit = limit->number();
    loops.push_back({{h.hinge, h.given->count_at("component")}, h.trajectory, gains});
  }
  return std::make_unique<PdController>(std::move(loops), p.text_at("law") != "constant", sample_period(p));
}

}  // namespace

void enroll_pd_controller(Enrollment& enrollment) {
  std::vector<ParameterSpec> parameters =
      trajectory_parameters({"quintic", "bang-bang", "table", "sine", "constant"},
                            {component_parameter(), number("stiffness", "N m/rad|N/m", "proportional gain").least(0),
                             number("damping", "N m s/rad|N s/m", "derivative gain").least(0),
                             number("limit", "N m|N", "the effort never exceeds this").above(0).optional()},
                            "hinges to control");
  parameters.push_back(sample_parameter());
  enrollment.add<Load>({.id = "pd-controller",
                        .summary = "Controller: proportional and derivative feedback on coordinates of hinges",
                        .parameters = std::move(parameters),
                        .make = &make_pd_controller});
}

}  // namespace withy
