// A sensor: the speed of a frame's origin in the world.
#include <stdexcept>
#include <withy/core/model/model.hpp>
#include <withy/core/plugin/registry.hpp>
#include <withy/core/plugin/sensor.hpp>

#include "laws.hpp"

namespace example {
namespace {

class BoundSpeed final : public withy::BoundSensor {
 public:
  explicit BoundSpeed(withy::FrameIndex frame) : frame_(frame) {}
  std::vector<withy::SensorColumn> columns() const override { return {{"", "m/s"}}; }
  void read(withy::SensedState& state, const withy::SensorInputs&, std::span<double> values) const noexcept override {
    values[0] = state.motion(frame_).velocity.norm();
  }

 private:
  withy::FrameIndex frame_;
};

class Speed final : public withy::Sensor {
 public:
  explicit Speed(std::string of) : of_(std::move(of)) {}
  std::unique_ptr<withy::BoundSensor> bind(const withy::Model& model,
                                           std::span<const withy::SensorNode>) const override {
    const auto frame = model.find_frame(of_);
    if (!frame) throw std::invalid_argument("there is no frame '" + of_ + "'");
    return std::make_unique<BoundSpeed>(*frame);
  }

 private:
  std::string of_;
};

std::unique_ptr<withy::Sensor> make_speed(const withy::Value& p, const withy::MakeContext&) {
  return std::make_unique<Speed>(p.text_at("of"));
}

}  // namespace

withy::Plugin<withy::Sensor> speed() {
  return {.id = "speed",
          .summary = "Speed of a frame's origin",
          .parameters = {withy::text("of", "frame that is observed").naming(withy::ParameterSpec::Refers::frame)},
          .make = &make_speed};
}

}  // namespace example
