// A hinge: a slider on Huygens's curve, the cycloid x = r (θ + sin θ), y = r (1 − cos θ), which does not turn. Its
// coordinate is θ. Under weight along −y it swings in the same time however wide: sin(θ/2) is harmonic, ω² = g / 4r.
#include <cmath>
#include <withy/core/plugin/hinge.hpp>

#include "laws.hpp"

namespace example {
namespace {

class Tautochrone final : public withy::Hinge {
 public:
  explicit Tautochrone(double radius) : radius_(radius) {}
  std::size_t coordinates() const override { return 1; }
  std::size_t speeds() const override { return 1; }
  void reference(std::span<double> x) const noexcept override { x[0] = 0; }

  void motion(std::span<const double> x, std::span<const double> rates,
              withy::HingeMotion& out) const noexcept override {
    const double r = radius_, s = std::sin(x[0]), c = std::cos(x[0]);
    out.pose.R.setIdentity();
    out.pose.p = withy::Vector3(r * (x[0] + s), r * (1 - c), 0);
    // Angular first, then linear, in the axes of M; these are parallel to those of F.
    out.H.resize(6, 1);
    out.H << 0, 0, 0, r * (1 + c), r * s, 0;
    // H depends on x, so its rate times ẋ is an acceleration that no ẍ makes.
    out.bias << 0, 0, 0, -r * s * rates[0] * rates[0], r * c * rates[0] * rates[0], 0;
  }

  void derivatives(std::span<const double>, std::span<const double> rates,
                   std::span<double> x_dot) const noexcept override {
    x_dot[0] = rates[0];
  }
  void normalize(std::span<double>) const noexcept override {}              // no quaternion to scale
  std::optional<withy::HingeKernel> kernel() const override { return {}; }  // no motion that the sweeps know
  std::optional<bool> angular(std::size_t) const override { return true; }  // θ is an angle, though nothing turns

 private:
  double radius_;  ///< of the rolling circle [m]
};

}  // namespace

withy::Plugin<withy::Hinge> tautochrone() {
  return {.id = "tautochrone",
          .summary = "Slider on a cycloid, that swings in the same time however wide",
          .parameters = {withy::number("radius", "m", "radius of the circle that rolls out the cycloid").above(0)},
          .make = [](const withy::Value& p, const withy::MakeContext&) -> std::unique_ptr<withy::Hinge> {
            return std::make_unique<Tautochrone>(p.number_at("radius"));
          }};
}

}  // namespace example
