#include "withy/study/plausibility.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "withy/core/model/closing.hpp"
#include "withy/core/plugin/measured_place.hpp"
#include "withy/core/simulation/diagnosis.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/study/fast_course.hpp"
#include "withy/study/held_places.hpp"
#include "withy/study/step_limit.hpp"
#include "withy/study/tip_load.hpp"
#include "withy/study/tip_moments.hpp"
#include "withy/study/varying_sections.hpp"
#include "withy/study/written_angles.hpp"

namespace withy::study {
namespace {

/// A flexible body this many times shorter than the greatest distance in the scene, or with this many times its own
/// mass on it, is remarked on.
constexpr double short_enough = 100, heavy_enough = 1e4;
/// Damping ratio of a servo over what it drives beyond which the inertia is remarked on.
constexpr double stiff_enough = 10;
/// Times the longest stable step: a little damping moves that.
constexpr double too_long = 1.05;

/// A box round points, along the axes of the world.
struct Box {
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  void hold(const Vector3& p) { low = low.cwiseMin(p), high = high.cwiseMax(p); }
  [[nodiscard]] double size() const { return (high - low).norm(); }
};

/// The greatest distance between frames at the initial state, and the body whose own frames make most of it: the name
/// is empty where none does, as between bodies far apart.
struct Extent {
  double all = 0;  ///< [m]
  std::string greatest;
  double own = 0;  ///< of that body [m]
};

Extent extent(const Prepared& prepared) {
  const auto seen = prepared.equations->make_observation();
  seen->observe(prepared.scene.initial.y);
  Box all;
  std::map<std::string, Box> bodies;
  for (std::size_t b = 0; b < prepared.model().bodies().size(); ++b) {
    const BodyNode& node = prepared.model().bodies()[b];
    Box& own = bodies[node.scene_name()];
    for (std::size_t f = 0; f < node.frames.size(); ++f) {
      const WorldPose pose = seen->frame_pose(static_cast<int>(b), static_cast<int>(f));
      const Vector3 p = Eigen::Map<const Vector3>(pose.position.data());
      all.hold(p);
      own.hold(p);
    }
  }
  Extent found{all.size(), {}, 0};
  for (const auto& [name, box] : bodies)
    if (box.size() > std::max(found.own, 0.5 * found.all)) found.greatest = name, found.own = box.size();
  return found;
}

/// Of a short body among long ones: either may be in another unit.
std::string short_beside(double length, const Extent& tree) {
  const std::string which = tree.greatest.empty() ? "; is the length in metres?"
                                                  : fmt::format(", most of it '{}' with {} m; are both in metres?",
                                                                tree.greatest, brief(tree.own));
  return fmt::format(
      "a flexible body {} m long in a tree of {} m{} Its vibrations are so fast that they may cost all "
      "of the time of a run; if it does not bend, make it rigid",
      brief(length), brief(tree.all), which);
}

/// An inertia without a mass: no distribution of mass has it.
bool forgets_mass(const ModalShape& shape, double mass) {
  return mass == 0 && std::any_of(shape.sections.begin(), shape.sections.end(),
                                  [](const auto& section) { return !section.inertia.isZero(0); });
}

void look_at_bodies(const Prepared& prepared, std::vector<Remark>& all) {
  const Model& model = prepared.model();
  const Extent tree = extent(prepared);
  const BodyMasses masses = masses_of(model);
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const BodyNode& node = model.bodies()[b];
    if (node.segment && node.segment->index > 0) continue;
    const std::string& name = node.scene_name();
    const Place place = place_in_scene(prepared.scene, "bodies", name);
    for (const std::string& remark : node.body->remarks()) all.push_back({place, remark});
    const ModalShape& shape = node.body->shape();
    const double own = masses.own[b], carried = masses.carried[b];
    if (forgets_mass(shape, own))
      all.push_back({place,
                     "an inertia and a mass of 0 kg, which no body has: is the mass forgotten? The inertia of a rotor "
                     "behind a gear is the hinge's reflected_inertia"});
    if (shape.modes() == 0 || !(shape.length > 0) || node.segment) continue;
    if (shape.length * short_enough < tree.all) all.push_back({place, short_beside(shape.length, tree)});
    if (own * heavy_enough < carried)
      all.push_back({place, fmt::format("a flexible body of {} kg carries {} kg: are its length and its mass meant?",
                                        brief(own), brief(carried))});
  }
}

/// The inertia [kg m², kg] that an effort on each speed accelerates where all else is free: 1 / (M⁻¹)_ii. 0 on speeds
/// that motions prescribe, and everywhere where M cannot be inverted.
std::vector<double> driven_inertia(const Prepared& prepared) {
  const State& initial = prepared.scene.initial;
  const DenseSystem system = prepared.equations->system(initial.time, initial.y);
  const DenseSystem free = free_part(system);
  const auto n = static_cast<Eigen::Index>(free.size);
  std::vector<double> inertia(system.size, 0.0);
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::FullPivLU<Eigen::MatrixXd> M(Eigen::Map<const RowMajor>(free.mass.data(), n, n));
  if (n == 0 || !M.isInvertible()) return inertia;
  const Eigen::MatrixXd inverse = M.inverse();
  Eigen::Index next = 0;
  for (std::size_t i = 0; i < system.size; ++i) {
    const bool prescribed = std::any_of(system.prescribed.begin(), system.prescribed.end(),
                                        [i](const PrescribedRate& p) { return p.speed == i; });
    if (prescribed) continue;
    inertia[i] = 1 / inverse(next, next);
    ++next;
  }
  return inertia;
}

/// Feedback of a servo: k on a coordinate and d on its rate.
struct Feedback {
  double stiffness, damping;
};

/// Of a `pd-controller` on one of its hinges, or of a continuous `pid` on the hinge that it measures too; nothing where
/// gains follow a schedule, or where the derivative is filtered or held over samples: its pole is another one then.
std::optional<Feedback> feedback_of(const Value& gains, const std::string& hinge, bool pid) {
  const auto number = [&](const char* key) {
    const Value* given = gains.find(key);
    return given != nullptr && given->kind() == Value::Kind::number ? given->number() : 0.0;
  };
  if (!pid) return Feedback{number("stiffness"), number("damping")};
  const Value* of = gains.find("of");
  const bool measures = of == nullptr || (of->items().size() == 1 && of->items()[0].text() == hinge);
  if (!measures || gains.has("to") || number("sample") > 0 || number("filter") > 0) return {};
  return Feedback{number("proportional"), number("derivative")};
}

/// The pole −d/h where the inertia h is far below that which the gains are for, d ≈ 2 √(k h).
void look_at_servo(const Prepared& prepared, const std::vector<double>& inertia, const std::string& hinge,
                   const Value& gains, bool pid, std::vector<Remark>& all) {
  const std::optional<Feedback> feedback = feedback_of(gains, hinge, pid);
  const Slot* slot = prepared.model().layout().hinge(hinge);
  if (!feedback || slot == nullptr || slot->speeds != 1) return;
  const double h = inertia[slot->speed], k = feedback->stiffness, d = feedback->damping;
  if (!(h > 0) || !(k > 0) || d < 2 * stiff_enough * std::sqrt(k * h)) return;
  all.push_back(
      {gains.place(), fmt::format("the servo on '{}' drives an inertia of {} alone: damping {} over it makes a pole "
                                  "at about -{}/s, which explicit integrators follow in steps of its "
                                  "reciprocal; if a motor drives it, give hinges.{}.reflected_inertia, the inertia "
                                  "of its rotor times the square of the gear ratio, or use radau",
                                  hinge, brief(h), brief(d), brief(d / h), hinge)});
}

void look_at_servos(const Prepared& prepared, std::vector<Remark>& all) {
  const Value* loads = prepared.scene.source.find("loads");
  if (loads == nullptr || prepared.model().layout().speeds > 400) return;
  const std::vector<double> inertia = driven_inertia(prepared);
  for (const auto& [name, load] : loads->members()) {
    const Value* type = load.find("type");
    const Value* hinges = load.find("hinges");
    if (type == nullptr) continue;
    const Value* hinge = load.find("hinge");
    if (type->text() == "pid" && hinge != nullptr) look_at_servo(prepared, inertia, hinge->text(), load, true, all);
    if (type->text() != "pd-controller" || hinges == nullptr) continue;
    for (const auto& [name_of_hinge, gains] : hinges->members())
      look_at_servo(prepared, inertia, name_of_hinge, gains, false, all);
  }
}

/// Steps that the scene fixes, beyond those to which the integrator is stable where the run begins.
void look_at_fixed_step(const Prepared& prepared, const Value& chosen, std::vector<Remark>& all) {
  const Value* given = chosen.find("step");
  if (given == nullptr || given->kind() != Value::Kind::number) return;
  double step = given->number();
  // Steps end where a load takes a sample.
  for (const LoadNode& node : prepared.model().loads())
    if (const DiscretePart* part = node.load->discrete(); part != nullptr && part->period() > 0)
      step = std::min(step, part->period());
  const std::optional<TooStiff> stable = too_stiff(prepared, prepared.scene.initial, 0);
  if (!stable || !(step > too_long * stable->step)) return;
  all.push_back({given->place(), fmt::format("steps of {} s are {} times as long as the longest that {} is stable to "
                                             "where the run begins: what vibrates fastest there grows from step to "
                                             "step once it moves; at most {} s are needed, or radau",
                                             brief(step), brief(step / stable->step), prepared.scene.integrator_name,
                                             brief(stable->step))});
}

/// A motion that the integrator chosen does not follow to the end of the run; a load that its steps do not see.
void look_at_steps(const Prepared& prepared, std::vector<Remark>& all) {
  const Value* chosen = prepared.scene.source.find("integrator");
  const Place place = chosen != nullptr ? chosen->place() : prepared.scene.source.place();
  if (const std::optional<TooStiff> found = too_stiff(prepared, prepared.scene.initial))
    all.push_back({place, found->text + "; use radau, or give the inertia that is missing"});
  else if (chosen != nullptr)
    look_at_fixed_step(prepared, *chosen, all);
  if (const std::optional<FastCourse> unseen = unseen_course(prepared, prepared.scene.initial))
    all.push_back({place, unseen->text});
}

/// Every text of a value but the names of members.
void add_texts(const Value& value, std::set<std::string>& texts) {
  if (value.kind() == Value::Kind::text) texts.insert(value.text());
  for (const Value& item : value.items()) add_texts(item, texts);
  for (const auto& [name, member] : value.members()) add_texts(member, texts);
}

void look_at_frames(const Prepared& prepared, std::vector<Remark>& all) {
  std::set<std::string> texts;
  for (const auto& [name, member] : prepared.scene.source.members())
    if (name != "bodies") add_texts(member, texts);
  const Value* bodies = prepared.scene.source.find("bodies");
  if (bodies == nullptr) return;
  for (const auto& [body, values] : bodies->members()) {
    const Value* frames = values.find("frames");
    if (frames == nullptr) continue;
    for (const auto& [frame, pose] : frames->members()) {
      const std::string name = body + '.' + frame;
      // Results tell of every frame "tip".
      const bool used = frame == "tip" || std::any_of(texts.begin(), texts.end(), [&](const std::string& text) {
                          return text == name || text.starts_with(name + '.');
                        });
      if (!used)
        all.push_back({pose.place(), fmt::format("nothing uses the frame '{}'; a frame named tip would stand in the "
                                                 "results",
                                                 name)});
    }
  }
}

/// Bodies that begin bent beyond what a run goes on with.
void look_at_start(const Prepared& prepared, std::vector<Remark>& all) {
  const Scene& scene = prepared.scene;
  for (const Tip& tip : measured_ends(prepared.model())) {
    if (!tip.flexible || !(tip.length > 0)) continue;
    const auto d = deflection(*prepared.equations, scene.initial.y, tip);
    const double share = std::hypot(d[0], d[1], d[2]) / tip.length;
    if (!(share > scene.deflection_limit)) continue;
    all.push_back(
        {place_in_scene(scene, "bodies", tip.body),
         fmt::format("the scene begins with {} of '{}' deflected by {} times its length, beyond what a run goes on "
                     "with (limits.deflection, {}){}",
                     MeasuredPlace{tip.station, {}}.in_words(), tip.body, brief(share), brief(scene.deflection_limit),
                     loops_of(prepared.model()).empty()
                         ? ""
                         : "; loops that hinges cannot close are closed by bending: are the frames and offsets of "
                           "constraints meant so?")});
  }
}

}  // namespace

Place place_in_scene(const Scene& scene, const char* group, const std::string& name) {
  const Value* all = scene.source.find(group);
  const Value* one = all != nullptr ? all->find(name) : nullptr;
  return one != nullptr ? one->place() : scene.source.place();
}

std::vector<Remark> implausible(const Prepared& prepared, Registry& registry) {
  std::vector<Remark> all;
  look_at_bodies(prepared, all);
  look_at_held_places(prepared, registry, all);
  look_at_tip_moments(prepared, registry, all);
  look_at_varying_sections(prepared, registry, all);
  look_at_servos(prepared, all);
  look_at_steps(prepared, all);
  look_at_frames(prepared, all);
  look_at_written_angles(prepared, registry, all);
  look_at_start(prepared, all);
  std::stable_sort(all.begin(), all.end(),
                   [](const Remark& a, const Remark& b) { return a.place.line < b.place.line; });
  return all;
}

}  // namespace withy::study
