/// \file
/// Motion of a frame.
#include <Eigen/Geometry>
#include <cmath>

#include "frame_sensor.hpp"

namespace withy {
namespace {

/// Which of its numbers a frame gives.
struct Shown {
  bool position = false, orientation = false, velocity = false, acceleration = false;
};

/// Angles of intrinsic turns about x, then y, then z: R = R_x(a) R_y(b) R_z(c), −π/2 ≤ b ≤ π/2. At b = ±π/2, where a
/// and c are not told apart, c = 0.
Vector3 angles_xyz(const Matrix3& R) noexcept {
  const double across = std::hypot(R(0, 0), R(0, 1));
  const double b = std::atan2(R(0, 2), across);
  if (across < 1e-12) return {std::atan2(R(2, 1), R(1, 1)), b, 0};
  return {std::atan2(-R(1, 2), R(2, 2)), b, std::atan2(-R(0, 1), R(0, 0))};
}

class BoundFrame final : public BoundSensor {
 public:
  BoundFrame(FrameIndex frame, FrameIndex observer, bool own_axes, Shown shown)
      : frame_(frame), observer_(observer), own_axes_(own_axes), shown_(shown) {}
  std::vector<SensorColumn> columns() const override {
    std::vector<SensorColumn> c;
    if (shown_.position) add_columns(c, "", "m");
    if (shown_.orientation) {
      for (const char* part : {"qw", "qx", "qy", "qz"}) c.push_back({part, "1"});
      add_columns(c, "r", "rad");
    }
    if (shown_.velocity) add_columns(c, "v", "m/s");
    if (shown_.velocity) add_columns(c, "w", "rad/s");
    if (shown_.acceleration) add_columns(c, "a", "m/s^2");
    if (shown_.acceleration) add_columns(c, "alpha", "rad/s^2");
    return c;
  }
  void read(SensedState& state, const SensorInputs& /*inputs*/, std::span<double> values) const noexcept override {
    const SeenMotion seen = seen_from(state, observer_, frame_);
    const Matrix3 turned = own_axes_ ? Matrix3(seen.R.transpose()) : Matrix3(Matrix3::Identity());
    if (shown_.position) put(turned * seen.position, values);
    if (shown_.orientation) {
      const Eigen::Quaterniond q(seen.R);
      const double sign = q.w() < 0 ? -1 : 1;
      values[0] = sign * q.w();
      values = values.subspan(1);
      put(sign * q.vec(), values);
      put(angles_xyz(seen.R), values);
    }
    if (shown_.velocity) put(turned * seen.velocity, values);
    if (shown_.velocity) put(turned * seen.angular_velocity, values);
    if (shown_.acceleration) put(turned * seen.acceleration, values);
    if (shown_.acceleration) put(turned * seen.angular_acceleration, values);
  }

 private:
  FrameIndex frame_, observer_;
  bool own_axes_;
  Shown shown_;
};

class FrameSensor final : public Sensor {
 public:
  explicit FrameSensor(const Value& p) : of_(p.text_at("of")), in_(p.text_at("in")) {
    const std::string& show = p.text_at("show");
    const bool all = show == "all";
    shown_ = {all || show == "position", all || show == "orientation", all || show == "velocity",
              all || show == "acceleration"};
  }
  std::unique_ptr<BoundSensor> bind(const Model& model, std::span<const SensorNode> /*before*/) const override {
    const bool own = in_ == "own";
    return std::make_unique<BoundFrame>(sensed_frame(model, of_), own ? world_frame : sensed_frame(model, in_), own,
                                        shown_);
  }

 private:
  std::string of_, in_;
  Shown shown_;
};

std::unique_ptr<Sensor> make_frame(const Value& p, const MakeContext& /*context*/) {
  return std::make_unique<FrameSensor>(p);
}

}  // namespace

void enroll_frame(Enrollment& enrollment) {
  enrollment.add<Sensor>(
      {.id = "frame",
       .summary = "Position, orientation, velocities and accelerations of a frame",
       .parameters = {frame_parameter("of", "frame that is observed"),
                      frame_or("in", "observer, in whose axes the numbers are; own: the world, in the frame's own axes",
                               {"world", "own"})
                          .otherwise("world"),
                      text("show", "which of the numbers")
                          .one_of({"all", "position", "orientation", "velocity", "acceleration"})
                          .otherwise("all")},
       .make = &make_frame});
}

}  // namespace withy
