/// \file
/// Reactions of hinges and inner forces of beams against the dense reference of a tree whose hinge is freed, and closed
/// forms.
#include <fmt/format.h>

#include <Eigen/Geometry>

#include "sensed_case.hpp"
#include "withy/core/simulation/sensor_reader.hpp"

namespace withy::test {
namespace {

class Reactions : public testing::TestWithParam<std::string> {};

/// The tree with one hinge of six free speeds in the place of another.
std::string with_free(const std::string& text, const std::string& hinge) {
  const std::size_t line = text.find("\n  " + hinge + ": {");
  const std::size_t type = text.find(", type: ", line), end = text.find("}\n", type);
  return text.substr(0, type) + ", type: free" + text.substr(end);
}

/// Row by row what the dense reference of the freed tree asks for there: M u̇ − f. Without `products` of speeds the
/// accelerations of the freed hinge are those of the hinge's own alone.
Vector6 asked_of_freed(const Case& c, const Case& freed, std::size_t hinge, const std::vector<double>& rates,
                       bool products) {
  const Layout& from = c.scene.model->layout();
  const Layout& to = freed.scene.model->layout();
  State s = freed.scene.initial;
  std::vector<double> u_dot(to.speeds);
  const auto copy = [&](const Slot& a, const Slot& b) {
    for (std::size_t i = 0; i < a.positions; ++i) s.y[b.position + i] = c.state.y[a.position + i];
    for (std::size_t i = 0; i < a.speeds; ++i) {
      s.y[to.positions + b.speed + i] = c.state.y[from.positions + a.speed + i];
      u_dot[b.speed + i] = rates[from.positions + a.speed + i];
    }
  };
  for (const Slot& slot : from.bodies) copy(slot, *to.body(slot.name));
  for (const Slot& slot : from.hinges) {
    if (slot.name != from.hinges[hinge].name) copy(slot, *to.hinge(slot.name));
  }
  const Slot& own = from.hinges[hinge];
  const Slot& six = *to.hinge(own.name);
  HingeMotion m;
  m.H.resize(6, static_cast<Eigen::Index>(own.speeds));
  const std::span<const double> y(c.state.y);
  c.scene.model->hinges()[hinge].hinge->motion(y.subspan(own.position, own.positions),
                                               y.subspan(from.positions + own.speed, own.speeds), m);
  Vector6 V = Vector6::Zero(), slope = products ? m.bias : Vector6(Vector6::Zero());
  for (std::size_t i = 0; i < own.speeds; ++i) {
    V += m.H.col(static_cast<Eigen::Index>(i)) * c.state.y[from.positions + own.speed + i];
    slope += m.H.col(static_cast<Eigen::Index>(i)) * rates[from.positions + own.speed + i];
  }
  const Eigen::Quaterniond q(m.pose.R);
  const Matrix3& R = m.pose.R;
  const Vector3 w = R * V.head<3>(), v = R * V.tail<3>(), alpha = R * slope.head<3>();
  const Vector3 a = R * (slope.tail<3>() + (products ? 1 : 0) * V.head<3>().cross(V.tail<3>()));
  const std::array<double, 7> x{q.w(), q.x(), q.y(), q.z(), m.pose.p.x(), m.pose.p.y(), m.pose.p.z()};
  std::copy(x.begin(), x.end(), s.y.begin() + static_cast<std::ptrdiff_t>(six.position));
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    s.y[to.positions + six.speed + i] = w[k];
    s.y[to.positions + six.speed + 3 + i] = v[k];
    u_dot[six.speed + i] = alpha[k];
    u_dot[six.speed + 3 + i] = a[k];
  }
  const DenseSystem system = freed.equations->system(c.state.time, s.y);
  Vector6 rows;
  for (std::size_t i = 0; i < 6; ++i) {
    const std::size_t row = six.speed + i;
    double sum = -system.force[row] - system.applied[row];
    for (std::size_t j = 0; j < system.size; ++j) sum += system.mass[row * system.size + j] * u_dot[j];
    rows[static_cast<Eigen::Index>(i)] = sum;
  }
  return rows;
}

/// In every formulation, of every hinge, welds that compilation merges among them.
TEST_P(Reactions, a_reaction_is_what_the_equations_ask_for_where_the_hinge_is_freed) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const int bodies = 3 + static_cast<int>(seed % 4);
    RandomScene random(seed, {.bodies = bodies,
                              .any_root = seed % 2 == 0 && GetParam() != "exact",
                              .rotary = seed % 4 == 2,
                              .stretching = seed % 3 == 2});
    const std::string text = random.text() + frame_loads(seed, bodies);
    Case c(text, GetParam());
    c.state = random.state(*c.scene.model, c.scene.initial);
    const std::vector<double> rates = c.derivatives(c.state);
    const auto sensed = c.equations->make_sensed_state({});
    ASSERT_TRUE(sensed->observe(c.state));
    // A sum cancels at the root of a free tree: errors are of the size of what goes through its hinges.
    std::vector<Vector6> asked;
    double size = 1;
    for (std::size_t h = 0; h < c.scene.model->hinges().size(); ++h) {
      const Case freed(with_free(text, c.scene.model->hinges()[h].name), GetParam());
      asked.push_back(asked_of_freed(c, freed, h, rates, GetParam() != "rate-linear"));
      size = std::max(size, asked.back().norm());
    }
    // Sections of a rod are turned by another method than the reference's, to 1e-8; stiffness magnifies what they are
    // apart in accelerations.
    const double close = (GetParam() == "exact" ? 1e-6 : 1e-9) * size;
    for (std::size_t h = 0; h < asked.size(); ++h) {
      const Wrench got = sensed->reaction(static_cast<int>(h));
      EXPECT_LT((got.moment - asked[h].head<3>()).norm(), close) << "seed " << seed << " hinge " << h;
      EXPECT_LT((got.force - asked[h].tail<3>()).norm(), close) << "seed " << seed << " hinge " << h;
    }
  }
}

/// A beam's hinge at its root holds the section there: they carry the same, in every formulation.
TEST_P(Reactions, the_section_at_a_beams_root_carries_what_its_hinge_carries) {
  int compared = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const int bodies = 4 + static_cast<int>(seed % 4);
    RandomScene random(
        seed, {.bodies = bodies, .any_family = seed % 2 == 0, .rotary = seed % 4 == 2, .stretching = seed % 3 == 2});
    Case c(random.text() + frame_loads(seed, bodies), GetParam());
    c.state = random.state(*c.scene.model, c.scene.initial);
    const Model& model = *c.scene.model;
    std::vector<SectionPlace> roots;
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
      if (model.hinges()[b].child_frame == 0 && model.bodies()[b].body->cut(0))
        roots.push_back({static_cast<int>(b), 0});
    }
    const auto sensed = c.equations->make_sensed_state(roots);
    ASSERT_TRUE(sensed->observe(c.state));
    for (std::size_t i = 0; i < roots.size(); ++i, ++compared) {
      const auto h = static_cast<std::size_t>(roots[i].body);
      const Slot& slot = model.layout().hinges[h];
      HingeMotion m;
      m.H.resize(6, static_cast<Eigen::Index>(slot.speeds));
      const std::span<const double> y(c.state.y);
      model.hinges()[h].hinge->motion(y.subspan(slot.position, slot.positions),
                                      y.subspan(model.layout().positions + slot.speed, slot.speeds), m);
      const Wrench a = sensed->reaction(roots[i].body), b = sensed->section(i).inner;
      const double close = 1e-9 * (1 + a.force.norm() + a.moment.norm());
      EXPECT_LT((a.force - m.pose.R * b.force).norm(), close) << "seed " << seed << " body " << h;
      EXPECT_LT((a.moment - m.pose.R * b.moment).norm(), close) << "seed " << seed << " body " << h;
    }
  }
  EXPECT_GT(compared, 15);
}

/// Held at its root or at its tip, spinning or not: N = ∫ ρ ω² x, M = ½ ρ g (L − x)² + P (L − x). At the end that is
/// held the section at the tip carries all, as that at the root does: the hinge is beyond it.
TEST(Sections, of_a_stiff_beam_carry_its_weight_its_load_and_its_spin) {
  constexpr double L = 2, rho = 1.5, g = 9.81, P = 4, w = 3;
  for (const bool at_tip : {false, true}) {
    const std::string end = at_tip ? "root" : "tip";
    Case c(
        "format: withy/1\ntime: {end: 1}\ngravity: [0, 0, -9.81]\nbodies: {boom: {type: beam, length: 2, "
        "mass_per_length: 1.5}}\nhinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: boom" +
            std::string(at_tip ? ".tip" : "") + "}}\nloads: {push: {type: force, frame: boom." + end +
            ", law: constant, value: [0, 0, -4]}}\n",
        "quadratic");
    c.state.y[1] = w;
    const std::vector<SectionPlace> places = {{0, 0.7}, {0, at_tip ? L : 0}};
    const auto sensed = c.equations->make_sensed_state(places);
    ASSERT_TRUE(sensed->observe(c.state));
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Wrench in = sensed->section(i).inner;
      // The part beyond x, or where the tip is held the part before it, which is free.
      const double free = at_tip ? places[i].x : L - places[i].x, sense = at_tip ? -1 : 1;
      const double pull = 0.5 * rho * w * w * (L * L - (L - free) * (L - free));
      EXPECT_NEAR(in.force.x(), -pull, 1e-10);
      EXPECT_NEAR(in.force.z(), sense * (rho * g * free + P), 1e-10);
      EXPECT_NEAR(in.moment.y(), -(0.5 * rho * g * free * free + P * free), 1e-10);
    }
  }
}

/// The piece before a section between two is not beyond it, the hinge at the tip is: what is inside does not jump where
/// nothing hangs, and at the tip it is what the beam exerts on its hinge.
TEST(Sections, of_a_beam_in_segments_that_is_held_at_its_tip_carry_what_is_before_them) {
  Case c(
      "format: withy/1\ntime: {end: 1}\ngravity: [0, -9.81, 0]\nbodies: {boom: {type: beam, length: 2, "
      "mass_per_length: 1.5, segments: 2, bending_y: {stiffness: 40, modes: 2, family: orthogonal-polynomials}}}\n"
      "hinges: {wall: {type: weld, parent: world, child: boom.tip}}\nloads: {push: {type: force, frame: boom.root, "
      "law: "
      "constant, value: [0, -4, 0]}}\n",
      "quadratic");
  const std::vector<int> pieces = c.scene.model->segments("boom");
  ASSERT_EQ(pieces.size(), 2u);
  const std::vector<SectionPlace> places = {{pieces[0], 1 - 1e-7}, {pieces[0], 1}, {pieces[1], 0}, {pieces[1], 1}};
  const auto sensed = c.equations->make_sensed_state(places);
  ASSERT_TRUE(sensed->observe(c.state));
  const Wrench before = sensed->section(0).inner;
  EXPECT_GT(before.force.norm(), 0.05);
  for (const std::size_t between : {1u, 2u}) {
    EXPECT_LT((sensed->section(between).inner.force - before.force).norm(), 1e-5) << between;
    EXPECT_LT((sensed->section(between).inner.moment - before.moment).norm(), 1e-5) << between;
  }
  const Wrench tip = sensed->section(3).inner, hinge = sensed->reaction(pieces[1]);
  EXPECT_LT((tip.force + hinge.force).norm(), 1e-9 * hinge.force.norm());
  EXPECT_LT((tip.moment + hinge.moment).norm(), 1e-9 * hinge.force.norm());
}

/// Strains at fibres are those of the stiffness' own moment there: E times them is m c/I.
TEST(Sections, of_a_bent_beam_show_strains_of_the_sign_of_stresses) {
  Case c(
      "format: withy/1\ntime: {end: 1}\nbodies: {boom: {type: beam, length: 2, mass_per_length: 1.5, bending_y: "
      "{stiffness: 40, modes: 2}, bending_z: {stiffness: 60, modes: 1}}}\nhinges: {root: {type: weld, parent: world, "
      "child: boom}}\noutputs: {cut: {type: section, of: boom, at: 0.3, moduli: {y: 1, z: 1}, fibres: {y: 0.01, z: "
      "0.02}}}\n",
      "quadratic");
  for (const auto& [i, q] : {std::pair(0, 0.02), std::pair(1, -0.003), std::pair(2, 0.015)})
    c.state.y[static_cast<std::size_t>(i)] = q;
  SensorReader reader(c.scene.outputs, *c.equations);
  std::vector<double> seen(reader.columns().size());
  ASSERT_TRUE(reader.read(c.state, seen));
  const auto of = [&](const std::string& name) {
    for (std::size_t i = 0; i < seen.size(); ++i)
      if (reader.columns()[i].name == "cut." + name) return seen[i];
    throw std::out_of_range(name);
  };
  EXPECT_NEAR(of("strain_y"), of("elastic_my") * 0.01 / 60, 1e-15);
  EXPECT_NEAR(of("strain_z"), of("elastic_mz") * 0.02 / 40, 1e-15);
  EXPECT_GT(std::abs(of("strain_y")), 1e-5);
  EXPECT_GT(std::abs(of("strain_z")), 1e-5);
  EXPECT_EQ(of("stress_y"), of("my"));
}

/// Moduli and fibres are about the axes that twist turns: a beam twisted by one angle is one that is turned about its
/// axis, and shows the stresses and strains of that in the same motion. Its moments and curvatures are of axes that do
/// not turn.
TEST(Sections, of_a_twisted_beam_have_stresses_about_their_own_axes) {
  const double beta = 0.7, c = std::cos(beta), s = std::sin(beta);
  const auto beam = [](const std::string& twist, const std::string& offset, const std::string& segments) {
    return "format: withy/1\ntime: {end: 1}\nbodies: {boom: {type: beam, length: 2, mass_per_length: 1.5" + twist +
           segments +
           ", bending_y: {stiffness: 40, modes: 2, family: orthogonal-polynomials}, bending_z: {stiffness: 90, modes: "
           "2, "
           "family: orthogonal-polynomials}}}\nhinges: {root: {type: weld, parent: world, child: boom" +
           offset +
           "}}\nloads: {push: {type: force, frame: boom.tip, law: constant, value: [0, 3, -1]}}\noutputs: {cut: {type: "
           "section, of: boom, at: 0.3, moduli: {y: 0.1, z: 0.2}, fibres: {y: 0.01, z: 0.02}}}\n";
  };
  for (const std::string segments : {"", ", segments: 2"}) {
    Case twisted(beam(", twist: 0.7", "", segments), "quadratic");
    Case turned(
        beam("",
             fmt::format(", offset: {{orientation: [{:.17g}, {:.17g}, 0, 0]}}", std::cos(beta / 2), std::sin(beta / 2)),
             segments),
        "quadratic");
    const std::size_t pieces = twisted.state.y.size() / 8;
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      for (std::size_t i = 4 * piece; i < 4 * piece + 2; ++i) {
        const double v = 0.02 / (1.0 + static_cast<double>(i)), w = -0.013;
        twisted.state.y[i] = v;
        twisted.state.y[i + 2] = w;
        turned.state.y[i] = c * v + s * w;
        turned.state.y[i + 2] = -s * v + c * w;
      }
    }
    const auto seen = [](Case& scene) {
      SensorReader reader(scene.scene.outputs, *scene.equations);
      std::vector<double> values(reader.columns().size());
      EXPECT_TRUE(reader.read(scene.state, values));
      return values;
    };
    const std::vector<double> a = seen(twisted), b = seen(turned);
    ASSERT_EQ(a.size(), 16u);
    for (std::size_t first : {0u, 3u, 6u, 9u}) {  // force, moment, curvature, elastic moment
      EXPECT_NEAR(a[first], b[first], 1e-10);
      EXPECT_NEAR(a[first + 1], c * b[first + 1] - s * b[first + 2], 1e-10);
      EXPECT_NEAR(a[first + 2], s * b[first + 1] + c * b[first + 2], 1e-10);
    }
    for (std::size_t i = 12; i < 16; ++i) {  // stresses and strains
      EXPECT_NEAR(a[i], b[i], 1e-10 * (1 + std::abs(b[i])));
      EXPECT_GT(std::abs(b[i]), 1e-5);
    }
  }
}

/// A scene counts along the whole of a beam in segments: at a joint the section carries what the weld there does.
TEST(Sections, of_a_beam_in_segments_count_along_the_whole) {
  Case c(
      "format: withy/1\ntime: {end: 1}\ngravity: [0, -9.81, 0]\nbodies: {boom: {type: beam, length: 1.5, "
      "mass_per_length: 2, segments: 3, bending_y: {stiffness: 60, modes: 2, family: orthogonal-polynomials}}}\n"
      "hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: boom}}\noutputs:\n"
      "  joint: {type: section, of: boom, at: 0.5}\n  before: {type: section, of: boom, at: 0.4999999}\n"
      "  end: {type: section, of: boom, at: 1.5}\n",
      "quadratic");
  c.state = moved(c, 0.02);
  SensorReader reader(c.scene.outputs, *c.equations);
  std::vector<double> values(reader.columns().size());
  ASSERT_TRUE(reader.read(c.state, values));
  const std::size_t each = values.size() / 3;
  ASSERT_EQ(reader.columns()[each].name, "before.fx");
  const auto sensed = c.equations->make_sensed_state({});
  ASSERT_TRUE(sensed->observe(c.state));
  const Wrench weld = sensed->reaction(1);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    EXPECT_NEAR(values[i], weld.force[k], 1e-9);
    EXPECT_NEAR(values[3 + i], weld.moment[k], 1e-9);
    EXPECT_NEAR(values[each + i], weld.force[k], 1e-5);
    EXPECT_NEAR(values[each + 3 + i], weld.moment[k], 1e-5);
    EXPECT_EQ(values[2 * each + i], 0);
  }
  EXPECT_GT(std::abs(values[5]), 0.005);
}

/// At deflections of no order but the first the two kinematics are one; they gather mass in different ways.
TEST(Sections, of_a_rod_and_of_its_expansion_agree_at_small_deflections) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    std::vector<SectionLoad> loads;
    for (const char* formulation : {"quadratic", "exact"}) {
      Case c(seed, {.bodies = 5, .planar = seed % 3 == 0}, formulation);
      const Model& model = *c.scene.model;
      for (const Slot& b : model.layout().bodies) {
        for (std::size_t i = 0; i < b.positions; ++i) c.state.y[b.position + i] *= 1e-5;
      }
      std::vector<SectionPlace> places;
      for (std::size_t b = 0; b < model.bodies().size(); ++b) {
        if (model.bodies()[b].body->cut(0))
          places.push_back({static_cast<int>(b), 0.2 * (1 + static_cast<double>(b % 2))});
      }
      const auto sensed = c.equations->make_sensed_state(places);
      ASSERT_TRUE(sensed->observe(c.state));
      for (std::size_t i = 0; i < places.size(); ++i) loads.push_back(sensed->section(i));
    }
    const std::size_t half = loads.size() / 2;
    for (std::size_t i = 0; i < half; ++i) {
      const SectionLoad &a = loads[i], &b = loads[half + i];
      const double close = 1e-6 * (1 + a.inner.force.norm() + a.inner.moment.norm());
      EXPECT_LT((a.inner.force - b.inner.force).norm(), close) << "seed " << seed;
      EXPECT_LT((a.inner.moment - b.inner.moment).norm(), close) << "seed " << seed;
      EXPECT_LT((a.elastic - b.elastic).norm(), close) << "seed " << seed;
    }
  }
}

/// What a motion does to hold a revolute hinge is what the weld in its place carries about its axis.
TEST_P(Reactions, the_effort_that_locks_a_revolute_hinge_is_the_reaction_of_the_weld_in_its_place) {
  const std::string before =
      "format: withy/1\ntime: {end: 1}\ngravity: [0.3, -9.81, 1]\nbodies:\n"
      "  hub: {type: rigid, mass: 2, inertia: [0.1, 0.2, 0.3, 0, 0, 0], frames: {out: {position: [0.2, 0.1, 0]}}}\n"
      "  arm: {type: beam, length: 1.2, mass_per_length: 0.8, bending_y: {stiffness: 40, modes: 2}, bending_z: "
      "{stiffness: 60, modes: 1}}\n"
      "  bob: {type: rigid, mass: 0.5, center_of_mass: [0.1, 0.2, 0], inertia: [0.02, 0.03, 0.04, 0, 0, 0]}\n"
      "hinges:\n  base: {type: spherical, parent: world, child: hub}\n  end: {type: weld, parent: arm.tip, child: "
      "bob}\n"
      "  elbow: {parent: hub.out, child: arm, ";
  const Case locked(before + "type: revolute, axis: [0, 0.6, 0.8]}\nmotions: {hold: {type: locked, hinge: elbow}}\n",
                    GetParam());
  const Case welded(before + "type: weld}\n", GetParam());
  const auto state_of = [](const Case& c) {
    State s = c.state;
    const Layout& layout = c.scene.model->layout();
    const Slot &base = *layout.hinge("base"), &arm = *layout.body("arm");
    const std::array<double, 3> spin{0.4, -0.9, 1.3}, q{0.02, -0.003, 0.015}, q_dot{0.3, 0.1, -0.2};
    for (std::size_t i = 0; i < 3; ++i) {
      s.y[layout.positions + base.speed + i] = spin[i];
      s.y[arm.position + i] = q[i];
      s.y[layout.positions + arm.speed + i] = q_dot[i];
    }
    return s;
  };
  const State a = state_of(locked), b = state_of(welded);
  const auto one = locked.equations->make_sensed_state({}), other = welded.equations->make_sensed_state({});
  ASSERT_TRUE(one->observe(a));
  ASSERT_TRUE(other->observe(b));
  const int h = locked.scene.model->hinge("elbow");
  const double effort = one->motion_efforts()[locked.scene.model->layout().hinge("elbow")->speed];
  const Wrench weld = other->reaction(welded.scene.model->hinge("elbow")), held = one->reaction(h);
  const double along = Vector3(0, 0.6, 0.8).dot(weld.moment);
  EXPECT_GT(std::abs(effort), 0.1);
  EXPECT_NEAR(effort, along, 1e-9 * std::abs(effort));
  EXPECT_LT((weld.moment - held.moment).norm() + (weld.force - held.force).norm(), 1e-9 * weld.force.norm());
}

INSTANTIATE_TEST_SUITE_P(Formulations, Reactions, testing::ValuesIn(formulations), formulation_name);

}  // namespace
}  // namespace withy::test
