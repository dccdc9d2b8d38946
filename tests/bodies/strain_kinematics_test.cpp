/// \file
/// Strain kinematics as plugins: those that come along, in bodies and in scenes.
#include <gtest/gtest.h>

#include "withy/core/deformation/point_motion.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"
#include "withy/tests/conformance/plugins.hpp"
#include "withy/tests/conformance/strain_kinematics_suite.hpp"

namespace withy::test {
namespace {

class StrainKinematicsPlugins : public testing::Test {
 protected:
  StrainKinematicsPlugins() { enroll_static_plugins(registry_); }
  std::unique_ptr<StrainKinematics> kinematics(const std::string& id) {
    return make_plugin<StrainKinematics>(registry_, id);
  }
  Scene scene(const std::string& formulation, const std::string& more = "") {
    return parse_scene(R"(format: withy/1
time: {end: 1}
gravity: [0, -9.81, 1]
formulation: )" + formulation +
                           R"(
bodies:
  boom:
    type: beam
    length: 1.2
    mass_per_length: 0.8
    bending_y: {stiffness: 40, modes: 2}
    bending_z: {stiffness: 30, modes: 2}
    torsion: {stiffness: 20, inertia: 0.01, modes: 1}
    frames: {middle: {at: 0.5}}
)" + more + R"(hinges:
  pivot: {type: spherical, parent: world, child: boom}
)",
                       "scene", registry_, {});
  }
  const Body& boom(const Scene& s) { return *s.model->bodies()[0].body; }
  static DenseSystem bent(const Scene& s, double size = 0.05) {
    State state = s.initial;
    for (const Slot& b : s.model->layout().bodies) {
      for (std::size_t i = 0; i < b.positions; ++i)
        state.y[b.position + i] = size * std::sin(1.0 + 2.3 * static_cast<double>(i));
    }
    return s.formulation->compile(s.model)->system(0, state.y);
  }

  Registry registry_;
};

TEST_F(StrainKinematicsPlugins, conform) {
  for (const std::string& id : registry_.ids<StrainKinematics>()) {
    const auto k = kinematics(id);
    EXPECT_EQ(k->name(), id);
    expect_strain_kinematics_conforms(*k);
    if (k->order() != StrainOrder::linear) expect_expands(*k, boom(scene("quadratic")), 1.2);
  }
  EXPECT_EQ(registry_.ids<StrainKinematics>(),
            (std::vector<std::string>{"exact", "foreshortening", "linear", "quadratic"}));
}

/// The complete second order is what a beam has of its own, to the last bit.
TEST_F(StrainKinematicsPlugins, quadratic_expands_a_beam_to_itself) {
  const Scene s = scene("quadratic");
  const auto expanded = boom(s).expanded(*kinematics("quadratic"));
  const PointExpansion own = *boom(s).station(0.7), anew = *expanded->station(0.7);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(own.gamma[c], anew.gamma[c]);
    EXPECT_EQ(own.theta[c], anew.theta[c]);
  }
}

TEST_F(StrainKinematicsPlugins, foreshortening_has_the_axial_part_alone) {
  const Scene s = scene("quadratic");
  const auto expanded = boom(s).expanded(*kinematics("foreshortening"));
  const PointExpansion own = *boom(s).station(1.2), anew = *expanded->station(1.2);
  EXPECT_LT((own.gamma[0] - anew.gamma[0]).norm(), 1e-13 * own.gamma[0].norm());
  EXPECT_GT(own.gamma[1].norm(), 0.1) << "the coupling that it lacks";
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_TRUE(anew.theta[c].isZero(0));
    if (c > 0) {
      EXPECT_TRUE(anew.gamma[c].isZero(0));
    }
  }
}

/// Names are presets of the two choices.
TEST_F(StrainKinematicsPlugins, names_of_formulations_are_presets) {
  for (const auto& [name, choice] : std::vector<std::pair<std::string, std::string>>{
           {"quadratic", "{kinematics: quadratic}"},
           {"linear", "{kinematics: linear, truncation: none}"},
           {"consistent", "{kinematics: quadratic, truncation: strict}"},
           {"inconsistent", "{kinematics: linear, truncation: strict}"},
           {"symmetric", "{kinematics: exact, truncation: symmetric}"},
           {"ruthless", "{kinematics: quadratic, truncation: ruthless}"}}) {
    const DenseSystem a = bent(scene(name)), b = bent(scene(choice));
    EXPECT_EQ(a.mass, b.mass) << name;
    EXPECT_EQ(a.force, b.force) << name;
  }
}

TEST_F(StrainKinematicsPlugins, a_scene_and_a_body_choose_alike) {
  const std::string choice = "{kinematics: foreshortening, truncation: strict}";
  const DenseSystem whole = bent(scene(choice)), own = bent(scene("consistent", "    formulation: " + choice + "\n")),
                    consistent = bent(scene("consistent"));
  EXPECT_EQ(whole.mass, own.mass);
  EXPECT_EQ(whole.force, own.force);
  EXPECT_NE(whole.mass, consistent.mass);
}

/// Sweep and reference see the same maps.
TEST_F(StrainKinematicsPlugins, foreshortening_is_swept_as_the_dense_equations_say) {
  for (const char* truncation : {"ruthless", "strict", "symmetric", "none"}) {
    const Scene s = scene(std::string("{kinematics: foreshortening, truncation: ") + truncation + "}");
    const auto equations = s.formulation->compile(s.model);
    State state = s.initial;
    const std::size_t positions = s.model->layout().positions;
    for (const Slot& b : s.model->layout().bodies) {
      for (std::size_t i = 0; i < b.positions; ++i) state.y[b.position + i] = 0.01 * std::sin(1.0 + double(i));
    }
    for (std::size_t i = 0; i < s.model->layout().speeds; ++i) state.y[positions + i] = std::cos(2.0 + double(i));
    std::vector<double> y_dot(equations->size());
    Work work = equations->make_work();
    ASSERT_TRUE(equations->derivatives(0, state.y, y_dot, work).ok());
    const std::vector<double> a = solve(equations->system(0, state.y));
    for (std::size_t i = 0; i < a.size(); ++i)
      EXPECT_NEAR(y_dot[positions + i], a[i], 1e-9 * (1 + std::abs(a[i]))) << truncation;
  }
}

TEST_F(StrainKinematicsPlugins, what_a_body_or_a_scene_cannot_have_is_refused_by_name) {
  const Scene plate = parse_scene(R"(format: withy/1
time: {end: 1}
formulation: {kinematics: foreshortening}
bodies: {panel: {type: plate, length: 1, width: 0.5, mass_per_area: 2, stiffness: 30}}
hinges: {edge: {type: revolute, axis: [0, 1, 0], parent: world, child: panel}}
)",
                                  "plate", registry_, {});
  try {
    static_cast<void>(plate.formulation->compile(plate.model));
    ADD_FAILURE() << "compiled";
  } catch (const std::invalid_argument& e) {
    const std::string text = e.what();
    EXPECT_NE(text.find("'panel'"), std::string::npos) << text;
    EXPECT_NE(text.find("'foreshortening'"), std::string::npos) << text;
  }
  const auto refusal = [&](const std::string& formulation) -> std::string {
    try {
      static_cast<void>(scene(formulation));
    } catch (const SceneError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(refusal("{kinematics: foreshortning}").find("did you mean 'foreshortening'?"), std::string::npos)
      << refusal("{kinematics: foreshortning}");
  EXPECT_NE(refusal("{kinematics: linear, truncation: strickt}").find("strict"), std::string::npos);
  EXPECT_NE(refusal("{truncation: strict}").find("kinematics"), std::string::npos);
}

}  // namespace
}  // namespace withy::test
