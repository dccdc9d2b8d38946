/// \file
/// Distance between the origins of two frames.
#include "frame_sensor.hpp"

namespace withy {
namespace {

class BoundDistance final : public BoundSensor {
 public:
  BoundDistance(FrameIndex from, FrameIndex to) : from_(from), to_(to) {}
  std::vector<SensorColumn> columns() const override { return {{"", "m"}, {"rate", "m/s"}}; }
  void read(SensedState& state, const SensorInputs& /*inputs*/, std::span<double> values) const noexcept override {
    const FrameMotion a = state.motion(from_), b = state.motion(to_);
    const Vector3 d = b.position - a.position, v = b.velocity - a.velocity;
    const double length = d.norm();
    values[0] = length;
    values[1] = length > 0 ? d.dot(v) / length : v.norm();
  }

 private:
  FrameIndex from_, to_;
};

class DistanceSensor final : public Sensor {
 public:
  DistanceSensor(std::string from, std::string to) : from_(std::move(from)), to_(std::move(to)) {}
  std::unique_ptr<BoundSensor> bind(const Model& model, std::span<const SensorNode> /*before*/) const override {
    return std::make_unique<BoundDistance>(sensed_frame(model, from_), sensed_frame(model, to_));
  }

 private:
  std::string from_, to_;
};

std::unique_ptr<Sensor> make_distance(const Value& p, const MakeContext& /*context*/) {
  return std::make_unique<DistanceSensor>(p.text_at("from"), p.text_at("to"));
}

}  // namespace

void enroll_distance(Enrollment& enrollment) {
  enrollment.add<Sensor>({.id = "distance",
                          .summary = "Distance between the origins of two frames, and its rate",
                          .parameters = {frame_or("from", "first frame", {"world"}).otherwise("world"),
                                         frame_or("to", "second frame", {"world"})},
                          .make = &make_distance});
}

}  // namespace withy
