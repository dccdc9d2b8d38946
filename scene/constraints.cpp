#include "withy/scene/constraints.hpp"

#include <fmt/format.h>

#include "withy/core/model/closing.hpp"
#include "withy/core/model/compiled_model.hpp"
#include "withy/core/simulation/assembly.hpp"
#include "withy/scene/grammar.hpp"
#include "withy/scene/make.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/state.hpp"

namespace withy {
namespace {

/// A closing hinge as the scene states it.
class Closing final : public Load {
 public:
  Closing(std::string name, FrameIndex a, FrameIndex b, const Pose& offset, std::vector<ClosingEquation> equations)
      : name_(std::move(name)), a_(a), b_(b), offset_(offset), equations_(std::move(equations)) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    return std::make_unique<LoopClosure>(model, name_, a_, b_, offset_, equations_);
  }

 private:
  std::string name_;
  FrameIndex a_, b_;
  Pose offset_;
  std::vector<ClosingEquation> equations_;
};

/// An end of a loop; nothing after reporting, or where there is no model.
std::optional<FrameIndex> end_of(const Value* end, const SceneTree& tree, const Checker& checker) {
  if (end == nullptr || end->kind() != Value::Kind::text) return {};
  if (end->text() == "world") return FrameIndex{-1, 0};
  const SceneNames& names = tree.names;
  if (names.frames_complete && !names.frames.has(end->text())) {
    checker.no_frame(end->place(), end->text(), names);
    return {};
  }
  return tree.model != nullptr ? tree.model->find_frame(end->text()) : std::nullopt;
}

Pose pose_of(const Value& value, const Checker& checker) {
  std::vector<double> q = value.at("orientation").numbers();
  const std::vector<double> p = value.at("position").numbers();
  accept_quaternion(q, value.at("orientation").place(), checker.diagnostics());
  return {rotation_from_quaternion(q[0], q[1], q[2], q[3]), {p[0], p[1], p[2]}};
}

void add_constraint(const std::string& name, const Value& given, const SceneTree& tree, const Checker& checker,
                    Value& all) {
  const std::string& path = given.place().path;
  if (const std::string problem = name_problem(name); !problem.empty())
    checker.key_error(path, fmt::format("got name {}; {}", in_quotes(name), problem));
  Made<Hinge> made;
  const auto value = check_plugin_map(given, "hinge", grammar::constraint_members(), checker, made);
  // The ends are looked up whatever else is wrong.
  const Value& ends = made.plugin != nullptr ? made.value : given;
  const auto a = end_of(ends.find("a"), tree, checker), b = end_of(ends.find("b"), tree, checker);
  if (!value) return;
  const auto hinge = make_object(*made.plugin, *value, checker);
  if (hinge == nullptr) return;
  const auto equations = closing_equations(*hinge);
  if (!equations) {
    checker.diagnostics().error(
        value->at("hinge").place(),
        fmt::format("{} cannot close a loop: need a hinge of rotations about fixed axes and translations along fixed "
                    "directions that holds something, as weld, revolute, prismatic, universal, cylindrical, planar or "
                    "spherical",
                    in_quotes(made.plugin->id)));
    return;
  }
  const Pose offset = pose_of(value->at("offset"), checker);
  all.members().emplace_back(name, *value);
  if (!a || !b) return;
  try {
    tree.model->add_load(name, Closing(name, *a, *b, offset, *equations));
  } catch (const std::invalid_argument& e) {
    checker.diagnostics().error(value->at("b").place(), e.what());
  }
}

}  // namespace

Value add_constraints(const Value& constraints, const SceneTree& tree, const Checker& checker) {
  Value all = Value::map({}, constraints.place());
  for (const auto& [name, given] : constraints.members()) add_constraint(name, given, tree, checker, all);
  return all;
}

Value without_guess(const Value& initial, const Model& model, const Checker& checker, State& state) {
  const Value* guess = initial.kind() == Value::Kind::map ? initial.find("guess") : nullptr;
  if (guess == nullptr) return initial;
  if (loops_of(model).empty())
    checker.key_error("/initial/guess", "the scene has no constraints; a guess is where closing its loops begins");
  set_state(*guess, model, checker, state);
  Value rest = Value::map({}, initial.place());
  for (const auto& [key, value] : initial.members())
    if (key != "guess") rest.members().emplace_back(key, value);
  return rest;
}

GivenState given_state(const Value* initial, const Model& model) {
  const Layout& layout = model.layout();
  GivenState given{std::vector<bool>(layout.speeds, false), std::vector<bool>(layout.speeds, false)};
  const auto note = [&](const char* group, const std::vector<Slot>& slots, const char* position, const char* rate) {
    const Value* parts = initial != nullptr ? initial->find(group) : nullptr;
    for (const Slot& slot : slots) {
      const Value* part = parts != nullptr ? parts->find(slot.name) : nullptr;
      if (part == nullptr) continue;
      for (std::size_t i = slot.speed; i < slot.speed + slot.speeds; ++i) {
        given.positions[i] = part->find(position) != nullptr;
        given.rates[i] = part->find(rate) != nullptr;
      }
    }
  };
  note("hinges", layout.hinges, "position", "rate");
  note("bodies", layout.bodies, "modes", "rates");
  return given;
}

Value close_loops(const Model& model, const Scene& scene, const Value* given, const Checker& checker, State& state) {
  if (scene.formulation_name == "auto") {
    checker.key_error("/formulation",
                      "got 'auto', which changes the bodies' kinematics along a run and with it where loops are closed "
                      "(constraints); name a formulation");
    return {};
  }
  try {
    // The model outlives the equations.
    const auto equations = compile_model(*scene.formulation, {std::shared_ptr<const Model>(), &model});
    const Assembly assembly = assemble(model, *equations, given_state(given, model), state);
    if (!assembly.fault.empty())
      checker.key_error((assembly.of_hinge ? "/hinges/" : "/constraints/") + assembly.name, fault_and_remedy(assembly));
    if (!assembly.remark.empty()) return Value(assembly.remark);
  } catch (const std::invalid_argument& e) {
    checker.key_error("/formulation", fmt::format("{}: {}", scene.formulation_name, e.what()));
  }
  return {};
}

}  // namespace withy
