// A load: the drag of still air on a point, the force −k |v| v at the origin of a frame.
#include <array>
#include <stdexcept>
#include <withy/core/model/model.hpp>
#include <withy/core/plugin/load.hpp>

#include "laws.hpp"

namespace example {
namespace {

/// The load on one model. It acts by wrenches alone: the core turns them into efforts on all speeds that move the
/// frame.
class BoundDrag final : public withy::BoundLoad {
 public:
  BoundDrag(withy::FrameIndex frame, double coefficient) : frames_{frame}, coefficient_(coefficient) {}
  std::span<const withy::FrameIndex> frames() const override { return frames_; }
  void wrenches(double /*t*/, std::span<const withy::FrameMotion> motions,
                std::span<withy::Wrench> wrenches) const noexcept override {
    const withy::Vector3& v = motions[0].velocity;
    wrenches[0] = {withy::Vector3::Zero(), -coefficient_ * v.norm() * v};
  }
  // Nothing acts on a hinge itself, and nothing jumps, begins or ends at a time.
  void add(double, std::span<const double>, std::span<const double>, std::span<double>,
           std::span<double>) const noexcept override {}
  std::size_t scratch() const override { return 0; }
  std::vector<double> discontinuities() const override { return {}; }
  double end() const override { return 0; }
  void begin(withy::State&) const override {}

 private:
  std::array<withy::FrameIndex, 1> frames_;
  double coefficient_;
};

/// The load as the scene states it, for any model.
class Drag final : public withy::Load {
 public:
  Drag(std::string frame, double coefficient) : frame_(std::move(frame)), coefficient_(coefficient) {}
  std::unique_ptr<withy::BoundLoad> bind(const withy::Model& model) const override {
    const auto frame = model.find_frame(frame_);
    if (!frame) throw std::invalid_argument("there is no frame '" + frame_ + "'");
    return std::make_unique<BoundDrag>(*frame, coefficient_);
  }

 private:
  std::string frame_;
  double coefficient_;  ///< k [kg/m]
};

}  // namespace

withy::Plugin<withy::Load> drag() {
  return {.id = "drag",
          .summary = "Drag of still air on the origin of a frame",
          .parameters = {withy::text("frame", "where it acts").naming(withy::ParameterSpec::Refers::frame),
                         withy::number("coefficient", "kg/m",
                                       "force over speed squared: half of density, drag "
                                       "coefficient and area")
                             .above(0)},
          .make = [](const withy::Value& p, const withy::MakeContext&) -> std::unique_ptr<withy::Load> {
            return std::make_unique<Drag>(p.text_at("frame"), p.number_at("coefficient"));
          }};
}

}  // namespace example
