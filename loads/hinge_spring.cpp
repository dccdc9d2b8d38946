/// \file
/// A linear spring and damper on a coordinate of a hinge: τ = preload − k (x − x₀) − c ẋ.
#include "withy/core/plugin/registry.hpp"
#include "withy/loads/hinge_rate.hpp"

namespace withy {
namespace {

struct Spring {
  double stiffness = 0;      ///< k [N m/rad, N/m]
  double damping = 0;        ///< c [N m s/rad, N s/m]
  double free_position = 0;  ///< x₀ [rad, m]
  double preload = 0;        ///< [N m, N]
};

class BoundSpring final : public BoundLoad {
 public:
  BoundSpring(const Spring& spring, std::size_t position, std::size_t speed)
      : spring_(spring), position_(position), speed_(speed) {}
  std::size_t scratch() const override { return 0; }
  void add(double /*t*/, std::span<const double> positions, std::span<const double> speeds, std::span<double> efforts,
           std::span<double> /*scratch*/) const noexcept override {
    double effort = spring_.preload - spring_.damping * speeds[speed_];
    // A damper alone may sit where there is no coordinate.
    if (spring_.stiffness > 0) effort -= spring_.stiffness * (positions[position_] - spring_.free_position);
    efforts[speed_] += effort;
  }
  bool add_derivatives(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
                       Eigen::Ref<Eigen::MatrixXd> by_position, Eigen::Ref<Eigen::MatrixXd> by_speed) const override {
    const auto i = static_cast<Eigen::Index>(speed_);
    by_position(i, i) -= spring_.stiffness;
    by_speed(i, i) -= spring_.damping;
    return true;
  }
  std::vector<double> discontinuities() const override { return {}; }
  double end() const override { return 0; }
  void begin(State& /*state*/) const override {}

 private:
  Spring spring_;
  std::size_t position_;
  std::size_t speed_;
};

class HingeSpring final : public Load {
 public:
  HingeSpring(RateName rate, const Spring& spring) : rate_(std::move(rate)), spring_(spring) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    const std::size_t position = spring_.stiffness > 0 ? position_index(model, rate_) : 0;
    return std::make_unique<BoundSpring>(spring_, position, speed_index(model, rate_));
  }

 private:
  RateName rate_;
  Spring spring_;
};

std::unique_ptr<Load> make_hinge_spring(const Value& p, const MakeContext& context) {
  const Spring spring{p.number_at("stiffness"), p.number_at("damping"), p.number_at("free_position"),
                      p.number_at("preload")};
  if (spring.stiffness == 0 && spring.damping == 0 && spring.preload == 0) {
    context.diagnostics.error(p.place(), "does nothing; need 'stiffness', 'damping' or 'preload'");
    return nullptr;
  }
  return std::make_unique<HingeSpring>(rate_name(p), spring);
}

}  // namespace

void enroll_hinge_spring(Enrollment& enrollment) {
  enrollment.add<Load>(
      {.id = "hinge-spring",
       .summary = "Linear spring and damper on a coordinate of a hinge; per metre where the coordinate is a length",
       .parameters = rate_parameters(
           {number("stiffness", "N m/rad|N/m", "effort for one radian").least(0).otherwise(0.0),
            number("damping", "N m s/rad|N s/m", "effort for one radian per second").least(0).otherwise(0.0),
            number("free_position", "rad|m", "coordinate at which the spring is slack").otherwise(0.0),
            number("preload", "N m|N", "constant effort, in the sense of the rate").otherwise(0.0)}),
       .make = &make_hinge_spring});
}

}  // namespace withy
