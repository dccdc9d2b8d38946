/// \file
/// The loads of the project, hinges to put them on, and the paper's arm.
#pragma once

#include "withy/plugins/host/static_plugins.hpp"
#include "withy/tests/conformance/plugins.hpp"
#include "withy/tests/conformance/test_bodies.hpp"

namespace withy {

inline Registry load_registry() {
  Registry registry;
  enroll_static_plugins(registry);
  return registry;
}

inline Value list_of(std::initializer_list<double> numbers) {
  std::vector<Value> items;
  for (const double x : numbers) items.emplace_back(x);
  return Value::list(std::move(items));
}

inline std::shared_ptr<const Hinge> test_hinge(const std::string& id, const Vector3& axis = Vector3::UnitZ()) {
  Registry registry = load_registry();
  std::vector<Value::Member> given;
  if (id == "revolute" || id == "prismatic") given.emplace_back("axis", list_of({axis.x(), axis.y(), axis.z()}));
  return make_plugin<Hinge>(registry, id, std::move(given));
}

/// The two-link arm of Padilla & von Flotow, table 1, in SI units (0.0127 m = 0.5 in and so on), with `modes` modes a
/// link.
inline Model two_link_arm(Eigen::Index modes) {
  const auto inertia = [](double i) -> Matrix3 { return i * Matrix3::Identity(); };
  std::vector<BodyNode> bodies = {
      test_node("hub", test_rigid(20, {0, 0, 0}, inertia(0.01)),
                {{"out", "root", {Matrix3::Identity(), {0.0762, 0, 0}}}}),
      test_node("link1", test_rod(1.33937, 0.9144, modes), {{"tip", "tip", {}}}),
      test_node("elbow_body", test_rigid(14, {0.0762, 0, 0}, inertia(0.03)),
                {{"pivot", "root", {Matrix3::Identity(), {0.0762, 0, 0}}}}),
      test_node("link2", test_rod(0.669685, 0.9144, modes),
                {{"tip", "tip", {}}, {"hub", "root", {Matrix3::Identity(), {-0.0127, 0, 0}}}}),
      test_node("payload", test_rigid(2, {0.0508, 0, 0}, inertia(0.01)))};
  std::vector<HingeNode> hinges = {{.name = "shoulder", .hinge = test_hinge("revolute"), .offset = {}, .child = 0},
                                   {"root1", test_hinge("weld"), 0, 1, {}, 1, 0},
                                   {"tip1", test_hinge("weld"), 1, 1, {}, 2, 0},
                                   {"elbow", test_hinge("revolute"), 2, 1, {}, 3, 2},
                                   {"tip2", test_hinge("weld"), 3, 1, {}, 4, 0}};
  return Model(std::move(bodies), std::move(hinges), Vector3::Zero());
}

}  // namespace withy
