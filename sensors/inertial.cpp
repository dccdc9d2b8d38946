/// \file
/// What an inertial measurement unit measures: proper acceleration and angular velocity in its own axes.
#include "frame_sensor.hpp"
#include "withy/core/plugin/sensed_fields.hpp"

namespace withy {
namespace {

enum class Quantity { proper_acceleration, angular_velocity };

template <Quantity quantity>
class BoundInertial final : public BoundSensor {
 public:
  explicit BoundInertial(FrameIndex frame) : frame_(frame) {}
  std::vector<SensorColumn> columns() const override {
    std::vector<SensorColumn> c;
    add_columns(c, "", quantity == Quantity::proper_acceleration ? "m/s^2" : "rad/s");
    return c;
  }
  void read(SensedState& state, const SensorInputs& /*inputs*/, std::span<double> values) const noexcept override {
    const FrameMotion motion = state.motion(frame_);
    if constexpr (quantity == Quantity::proper_acceleration) {
      Vector3 free = state.gravity();
      if (auto* fields = dynamic_cast<SensedFields*>(&state)) free += fields->field(frame_);
      put(motion.R.transpose() * (state.acceleration(frame_).linear - free), values);
    } else {
      put(motion.R.transpose() * motion.angular_velocity, values);
    }
  }

 private:
  FrameIndex frame_;
};

template <Quantity quantity>
class Inertial final : public Sensor {
 public:
  explicit Inertial(std::string of) : of_(std::move(of)) {}
  std::unique_ptr<BoundSensor> bind(const Model& model, std::span<const SensorNode> /*before*/) const override {
    return std::make_unique<BoundInertial<quantity>>(sensed_frame(model, of_));
  }

 private:
  std::string of_;
};

template <Quantity quantity>
std::unique_ptr<Sensor> make_inertial(const Value& p, const MakeContext& /*context*/) {
  return std::make_unique<Inertial<quantity>>(p.text_at("of"));
}

}  // namespace

void enroll_inertial(Enrollment& enrollment) {
  enrollment.add<Sensor>(
      {.id = "accelerometer",
       .summary = "Proper acceleration of a frame's origin, without that of gravity and fields, in the frame's axes",
       .parameters = {frame_parameter("of", "frame that carries it")},
       .make = &make_inertial<Quantity::proper_acceleration>});
  enrollment.add<Sensor>({.id = "gyro",
                          .summary = "Angular velocity of a frame in its own axes",
                          .parameters = {frame_parameter("of", "frame that carries it")},
                          .make = &make_inertial<Quantity::angular_velocity>});
}

}  // namespace withy
