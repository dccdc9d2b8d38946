/// \file
/// What sensors of frames share: the frames that a scene names, and the motion of one frame seen from another.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/parameters.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/core/plugin/sensor.hpp"

namespace withy {

inline constexpr FrameIndex world_frame = {-1, 0};

inline ParameterSpec frame_parameter(std::string key, const std::string& meaning) {
  return text(std::move(key), meaning + ": body.frame, or body for its root").naming(ParameterSpec::Refers::frame);
}
/// A frame or one of these words.
inline ParameterSpec frame_or(std::string key, const std::string& meaning, std::vector<std::string> words) {
  return frame_parameter(std::move(key), meaning).one_of(std::move(words));
}

/// \throws std::invalid_argument where the model has no such frame.
inline FrameIndex sensed_frame(const Model& model, const std::string& name) {
  if (name == "world") return world_frame;
  if (const std::optional<FrameIndex> index = model.find_frame(name)) return *index;
  throw std::invalid_argument("there is no frame '" + name + "'");
}

/// Motion of a frame as an observer fixed to another one sees it, in the observer's axes.
struct SeenMotion {
  Matrix3 R = Matrix3::Identity();
  Vector3 position = Vector3::Zero(), velocity = Vector3::Zero(), acceleration = Vector3::Zero();
  Vector3 angular_velocity = Vector3::Zero(), angular_acceleration = Vector3::Zero();
};

/// With A the observer and d = p − p_A: v − v_A − ω_A × d, and what Coriolis and centrifugal terms take off a − a_A.
inline SeenMotion seen_from(SensedState& state, FrameIndex observer, FrameIndex frame) noexcept {
  const FrameMotion A = state.motion(observer), B = state.motion(frame);
  const FrameAcceleration a = state.acceleration(observer), b = state.acceleration(frame);
  const Vector3& w = A.angular_velocity;
  const Vector3 d = B.position - A.position, spin = B.angular_velocity - w;
  const Vector3 v = B.velocity - A.velocity - w.cross(d);
  const Matrix3 back = A.R.transpose();
  return {back * B.R,  back * d,
          back * v,    back * (b.linear - a.linear - a.angular.cross(d) - w.cross(w.cross(d)) - 2 * w.cross(v)),
          back * spin, back * (b.angular - a.angular - w.cross(spin))};
}

inline void put(const Vector3& v, std::span<double>& values) noexcept {
  for (Eigen::Index i = 0; i < 3; ++i) values[static_cast<std::size_t>(i)] = v[i];
  values = values.subspan(3);
}

inline void add_columns(std::vector<SensorColumn>& columns, const std::string& prefix, const std::string& unit) {
  for (const char* axis : {"x", "y", "z"}) columns.push_back({prefix + axis, unit});
}

}  // namespace withy
