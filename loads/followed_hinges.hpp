/// \file
/// The part of a scene's load that says which hinges follow which trajectories, and the same in a model.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "withy/core/plugin/registry.hpp"
#include "withy/loads/hinge_rate.hpp"
#include "withy/loads/trajectory.hpp"

namespace withy {

/// A hinge of the scene that follows a trajectory.
struct FollowedHinge {
  std::string hinge;
  Trajectory trajectory;
  const Value* given;  ///< what the scene says of it; lives as long as the parameters
};

/// `law` and its options, and `hinges`, each with its part of the law and with `own` parameters.
inline std::vector<ParameterSpec> trajectory_parameters(std::vector<std::string> laws, std::vector<ParameterSpec> own,
                                                        const std::string& which_hinges) {
  std::vector<ParameterSpec> hinge{
      number("from", "rad|m", "coordinate at the start, 0 where left out (quintic, bang-bang)").optional(),
      number("to", "rad|m", "coordinate at the end, 0 where left out (quintic, bang-bang, constant)").optional(),
      table("table", {"s", "rad|m"}, "time and coordinate, at rest in the first and last row (table)").optional(),
      number("center", "rad|m", "coordinate about which it swings, 0 where left out (sine)").optional(),
      number("amplitude", "rad|m", "greatest distance from the centre (sine)").optional(),
      number("phase", "rad", "phase at time 0, 0 where left out (sine)").optional(),
      text("motion", "motion plugin with its options (motion)").naming(ParameterSpec::Refers::motion).optional()};
  hinge.insert(hinge.end(), own.begin(), own.end());
  laws.emplace_back("motion");
  return {text("law", "trajectory of the hinges").one_of(std::move(laws)).otherwise("quintic"),
          number("duration", "s", "duration before scaling (quintic, bang-bang)").above(0).optional(),
          number("period", "s", "period before scaling (sine)").above(0).optional(),
          number("time_scale", "1", "time runs this many times as fast").above(0).otherwise(1.0),
          named("hinges", std::move(hinge), which_hinges).naming(ParameterSpec::Refers::hinge)};
}

/// Reads trajectories; reports keys that the law lacks or does not take.
class TrajectoryReader {
 public:
  TrajectoryReader(const Value& p, const MakeContext& context)
      : p_(p), context_(context), law_(p.text_at("law")), scale_(p.number_at("time_scale")) {}

  /// Nothing after a reported error.
  std::optional<std::vector<FollowedHinge>> read() {
    const bool rest_to_rest = law_ == "quintic" || law_ == "bang-bang";
    if (!rest_to_rest) refuse(p_, {"duration"});
    if (law_ != "sine") refuse(p_, {"period"});
    if (rest_to_rest && !p_.has("duration")) lacks(p_, "'duration'");
    if (law_ == "sine" && !p_.has("period")) lacks(p_, "'period'");
    std::vector<FollowedHinge> followed;
    for (const auto& [hinge, given] : p_.at("hinges").members()) {
      if (!rest_to_rest) refuse(given, {"from"});
      if (!rest_to_rest && law_ != "constant") refuse(given, {"to"});
      if (law_ != "table") refuse(given, {"table"});
      if (law_ != "sine") refuse(given, {"center", "amplitude", "phase"});
      if (law_ == "table" && !given.has("table")) lacks(given, "'table'");
      if (law_ != "motion") refuse(given, {"motion"});
      if (law_ == "sine" && !given.has("amplitude")) lacks(given, "'amplitude'");
      if (law_ == "motion" && !given.has("motion")) lacks(given, "'motion'");
      if (!good_) continue;
      auto read = law_ == "motion" ? of_plugin(given.at("motion")) : trajectory(given);
      if (read) followed.push_back({hinge, std::move(*read), &given});
    }
    if (p_.at("hinges").members().empty()) error(p_.at("hinges"), "names no hinge; need at least one to move");
    if (!good_) return {};
    return followed;
  }

 private:
  /// Reports those of `keys` that are given.
  void refuse(const Value& given, std::initializer_list<std::string_view> keys) {
    for (const std::string_view key : keys) {
      if (const Value* v = given.find(key)) error(*v, "the law '" + law_ + "' takes no '" + std::string(key) + "'");
    }
  }
  void lacks(const Value& given, const std::string& what) { error(given, "the law '" + law_ + "' needs " + what); }
  void error(const Value& at, const std::string& message) {
    context_.diagnostics.error(at.place(), message);
    good_ = false;
  }

  /// A motion plugin of the scene's choice; nothing after a reported error.
  std::optional<Trajectory> of_plugin(const Value& given) {
    const std::string& type = given.text_at("type");
    const auto* plugin = context_.registry.find<Motion>(type);
    std::shared_ptr<const Motion> motion = plugin != nullptr ? plugin->make(given, context_) : nullptr;
    if (motion == nullptr) {
      good_ = false;
      return {};
    }
    if (motion->locks()) error(given, "'" + type + "' holds a hinge where it is; it is no trajectory to follow");
    return PluginMotion{std::move(motion), scale_};
  }

  std::optional<Trajectory> trajectory(const Value& given) const {
    const auto value = [&](std::string_view key) {
      const Value* v = given.find(key);
      return v == nullptr ? 0.0 : v->number();
    };
    const double from = value("from"), to = value("to");
    if (law_ == "constant") return Hold{to};
    if (law_ == "sine")
      return SineMotion{value("center"), value("amplitude"), scale_ / p_.number_at("period"), value("phase")};
    if (law_ == "table") {
      std::vector<double> times, positions;
      for (const Value& row : given.at("table").items()) {
        times.push_back(row.items()[0].number() / scale_);
        positions.push_back(row.items()[1].number());
      }
      return Spline(std::move(times), std::move(positions));
    }
    const double duration = p_.number_at("duration") / scale_;
    if (law_ == "bang-bang") return BangBang{from, to - from, duration};
    return Quintic{from, to - from, duration};
  }

  const Value& p_;
  const MakeContext& context_;
  const std::string& law_;
  double scale_;
  bool good_ = true;
};

/// A coordinate of a model that follows a trajectory.
struct FollowedAxis {
  std::size_t position;
  std::size_t speed;
  Trajectory trajectory;
};

/// The axis of a hinge with one coordinate.
/// \throws std::invalid_argument where the model has no such hinge.
inline FollowedAxis single_axis(const Model& model, const std::string& hinge, const Trajectory& trajectory) {
  const Slot& slot = single_coordinate(model, hinge);
  return {slot.position, slot.speed, trajectory};
}

/// The axes of hinges with one coordinate each, and the names of their rates.
/// \throws std::invalid_argument where the model has no such hinges.
inline std::vector<FollowedAxis> axes_of(const Model& model, const std::vector<FollowedHinge>& hinges) {
  std::vector<FollowedAxis> axes;
  for (const FollowedHinge& h : hinges) axes.push_back(single_axis(model, h.hinge, h.trajectory));
  return axes;
}
inline std::vector<RateName> rates_of(const std::vector<FollowedHinge>& hinges) {
  std::vector<RateName> names;
  for (const FollowedHinge& h : hinges) names.push_back({h.hinge, 0});
  return names;
}

/// Times [s], increasing, where the second or third derivative of any trajectory jumps.
inline std::vector<double> jumps_of(const std::vector<FollowedAxis>& axes) {
  std::vector<double> all;
  for (const FollowedAxis& axis : axes) {
    const std::vector<double> own = std::visit([](const auto& motion) { return motion.jumps(); }, axis.trajectory);
    all.insert(all.end(), own.begin(), own.end());
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

/// Time [s] at which the last of the trajectories has come to rest; 0 where none ends.
inline double end_of(const std::vector<FollowedAxis>& axes) {
  double end = 0;
  for (const FollowedAxis& axis : axes)
    end = std::max(end, std::visit([](const auto& motion) { return motion.end(); }, axis.trajectory));
  return end;
}

/// Puts the state on the trajectories as they are at its time.
inline void begin_on(const std::vector<FollowedAxis>& axes, std::size_t positions, State& state) {
  for (const FollowedAxis& axis : axes) {
    const MotionPoint start = at(axis.trajectory, state.time);
    state.y[axis.position] = start.position;
    state.y[positions + axis.speed] = start.rate;
  }
}

}  // namespace withy
