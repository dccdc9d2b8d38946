/// \file
/// Angle between two frames.
#include <cmath>
#include <optional>

#include "frame_sensor.hpp"
#include "withy/core/plugin/direction.hpp"

namespace withy {
namespace {

class BoundAngle final : public BoundSensor {
 public:
  BoundAngle(FrameIndex from, FrameIndex to, std::optional<Vector3> axis) : from_(from), to_(to), axis_(axis) {}
  std::vector<SensorColumn> columns() const override { return {{"", "rad"}}; }
  void read(SensedState& state, const SensorInputs& /*inputs*/, std::span<double> values) const noexcept override {
    const Matrix3 R = state.motion(from_).R.transpose() * state.motion(to_).R;
    if (axis_) {
      const Vector3 turned = R * *axis_;
      values[0] = std::atan2(axis_->cross(turned).norm(), axis_->dot(turned));
    } else {
      const Vector3 twice_sine(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
      values[0] = std::atan2(twice_sine.norm(), R.trace() - 1);
    }
  }

 private:
  FrameIndex from_, to_;
  std::optional<Vector3> axis_;
};

class AngleSensor final : public Sensor {
 public:
  AngleSensor(std::string from, std::string to, std::optional<Vector3> axis)
      : from_(std::move(from)), to_(std::move(to)), axis_(axis) {}
  std::unique_ptr<BoundSensor> bind(const Model& model, std::span<const SensorNode> /*before*/) const override {
    return std::make_unique<BoundAngle>(sensed_frame(model, from_), sensed_frame(model, to_), axis_);
  }

 private:
  std::string from_, to_;
  std::optional<Vector3> axis_;
};

std::unique_ptr<Sensor> make_angle(const Value& p, const MakeContext& context) {
  std::optional<Vector3> axis;
  if (p.has("axis")) {
    axis = direction_at(p, "axis", context);
    if (!axis) return nullptr;
  }
  return std::make_unique<AngleSensor>(p.text_at("from"), p.text_at("to"), axis);
}

}  // namespace

void enroll_angle(Enrollment& enrollment) {
  enrollment.add<Sensor>(
      {.id = "angle",
       .summary = "Angle between two frames, from 0 to a half turn",
       .parameters = {frame_or("from", "first frame", {"world"}).otherwise("world"),
                      frame_or("to", "second frame", {"world"}),
                      vector("axis", 3, "1",
                             "direction in the axes of each frame between which the angle is; without it, that of the "
                             "whole rotation")
                          .optional()},
       .make = &make_angle});
}

}  // namespace withy
