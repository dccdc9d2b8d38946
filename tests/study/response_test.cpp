// Transfer functions against closed forms, reduced ones against their bound; what cannot be asked is said.
#include "withy/study/response.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "withy/study/input_error.hpp"
#include "withy/tests/study/linear_scenes.hpp"

namespace withy::study {
namespace {

using test::plugins;

constexpr double beta = 1.8751040687119611;  // first root of 1 + cos β cosh β

TEST(Response, KnowsOfAccelerationsThatAreFedBack) {
  constexpr double m = 2, k = 30, g = 1.5, T = 0.1;
  const Prepared prepared = scene_of(R"(
bodies: {block: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
outputs: {imu: {type: accelerometer, of: block}}
loads:
  spring: {type: hinge-spring, hinge: slide, stiffness: 30}
  command: {type: input, hinge: slide}
  servo: {type: transfer-function, of: imu.x, to: command, numerator: [-1.5], denominator: [0.1, 1]}
)");
  // m s² x + k x = F − g s² x/(T s + 1)
  const Response closed = response(at_start(prepared), {"command", "imu.x", 0.1, 10, 20, {}});
  const Response opened = response(at_start(prepared), {"servo", "", 0.1, 10, 20, {}});
  EXPECT_TRUE(opened.opened);
  for (std::size_t i = 0; i < closed.values.size(); ++i) {
    const std::complex<double> s(0, closed.values[i].omega), lag = g * s * s / (T * s + 1.0);
    const std::complex<double> G = s * s / (m * s * s + k + lag);
    EXPECT_LT(std::abs(closed.values[i].value - G), 1e-7 * std::abs(G));
  }
  for (const ResponseAt& at : opened.values) {
    const std::complex<double> s(0, at.omega), L = g * s * s / (T * s + 1.0) / (m * s * s + k);
    EXPECT_LT(std::abs(std::abs(at.value) - std::abs(L)), 1e-7 * std::abs(L));
  }
}

// The first example of the page: an accelerometer that hardly feels the torque at once.
TEST(Response, OfTheSlewsAccelerometerHasTheStaticGainOfItsCurve) {
  const Prepared prepared = prepare(SceneValues::read(WITHY_SOURCES "/scenes/loads-of-the-slew.yaml"), plugins());
  const Response r = response(at_start(prepared), {"shoulder", "box.y", 1e-4, 10, 5, {}});
  ASSERT_EQ(r.integrators, 0);
  const std::complex<double> slow = r.values.front().value;
  EXPECT_NEAR(r.static_gain, slow.real(), 1e-5 * std::abs(slow));
}

// Links with springs between them and free to turn: slowly the tip of the last accelerates as that of one rigid rod,
// L/J, though a torque at the first is felt there at once by a factor of 1e-9 less.
TEST(Response, OfALongChainsTipIsSlowlyThatOfARigidRod) {
  constexpr int links = 16;
  std::string bodies = "bodies:\n", hinges = "hinges:\n", loads = "loads:\n  u: {type: input, hinge: j1}\n";
  double inertia = 0;
  for (int i = 1; i <= links; ++i) {
    const std::string n = std::to_string(i), before = i == 1 ? "world" : 'l' + std::to_string(i - 1) + ".out";
    bodies +=
        "  l" + n +
        ": {type: rigid, mass: 1.2, center_of_mass: [0.15, 0, 0], inertia: [0.002, 0.01, 0.011, 0, 0, 0], frames: "
        "{out: {position: [0.3, 0, 0]}}}\n";
    hinges += "  j" + n + ": {type: revolute, axis: [0, 0, 1], parent: " + before + ", child: l" + n + "}\n";
    if (i > 1) loads += "  d" + n + ": {type: hinge-spring, hinge: j" + n + ", stiffness: 2000, damping: 2}\n";
    const double arm = 0.3 * (i - 0.5);
    inertia += 0.011 + 1.2 * arm * arm;
  }
  const Prepared prepared = scene_of('\n' + bodies + hinges + loads + "outputs: {acc: {type: accelerometer, of: l" +
                                     std::to_string(links) + ".out}}\n");
  const Response r = response(at_start(prepared), {"u", "acc.y", {}, {}, 20, {}});
  const double rigid = 0.3 * links / inertia;
  EXPECT_NEAR(r.static_gain, rigid, 1e-4 * rigid);
}

/// Its name is the beginning of its rate's.
TEST(Response, OfACoordinateIsThatOfNoRate) {
  const Prepared prepared = scene_of(R"(
bodies: {cart: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: cart}}
loads: {spring: {type: hinge-spring, hinge: slide, stiffness: 30}}
)");
  const Response r = response(at_start(prepared), {"slide", "slide.0", {}, {}, 20, {}});
  EXPECT_NEAR(r.static_gain, 1.0 / 30, 1e-12);
  EXPECT_EQ(linear_model(at_start(prepared), {{"slide"}, {"slide"}}).outputs.size(), 2U) << "the hinge is both";
  // A transfer function is to one number: to what every other study calls by the hinge's name.
  EXPECT_EQ(response(at_start(prepared), {"slide", "slide", {}, {}, 20, {}}).static_gain, r.static_gain);
}

/// One clamped-free mode on a hinge: J = 1/3, coupling ∫xφ = 2/β², modal mass 1, stiffness β⁴.
const std::string hinged_beam = R"(
bodies: {boom: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 1, modes: 1, family: clamped-free}}}
hinges: {root: {type: revolute, axis: [0, 0, 1], parent: world, child: boom}}
outputs: {turn: {type: hinge, hinge: root}, load: {type: section, of: boom, at: 0}}
)";

TEST(Response, OfAHingedBeamIsTheClosedForm) {
  const double coupling = 2 / (beta * beta), J = 1.0 / 3, clamped = beta * beta;
  const Prepared prepared = scene_of(hinged_beam);
  const LinearModel m = linear_model(at_start(prepared), {{"root"}, {}});
  EXPECT_NEAR(m.system.D(find(m.outputs, "turn.acceleration"), 0), 1 / (J - coupling * coupling), 1e-6);
  EXPECT_NEAR(m.system.D(find(m.outputs, "load.mz"), 0), 1, 1e-9) << "what is put on the hinge goes into the beam";

  const Response r = response(at_start(prepared), {"root", "turn.position", {}, {}, 20, {}});
  // θ/τ = (s² + ω_c²) / (J s² (…)): the zero is the frequency with the hinge locked.
  ASSERT_EQ(r.roots.zeros.size(), 2);
  EXPECT_NEAR(std::abs(r.roots.zeros[0].imag()), clamped, 1e-6);
  const double free = clamped / std::sqrt(1 - coupling * coupling / J);
  double fastest = 0;
  for (const auto pole : r.roots.poles) fastest = std::max(fastest, std::abs(pole));
  EXPECT_NEAR(fastest, free, 1e-6 * free);
  EXPECT_EQ(r.integrators, 2);
  EXPECT_NEAR(r.static_gain, 1 / J, 1e-6) << "slowly it is a rigid body";
  ASSERT_EQ(r.peaks.size(), 1U);
  EXPECT_FALSE(r.peaks[0].height) << "nothing damps it";
  for (const ResponseAt& at : r.values) {
    const double w2 = at.omega * at.omega;
    const double exact = (clamped * clamped - w2) / (-w2 * (J * (clamped * clamped - w2) + coupling * coupling * w2));
    // Beside the pole what rounding leaves of its place is seen.
    const double beside = 1e-9 / std::min(std::abs(at.omega / free - 1), std::abs(at.omega / clamped - 1));
    EXPECT_NEAR(std::abs(at.value - exact), 0, (1e-7 + beside) * std::abs(exact)) << at.omega;
  }
}

/// A push through the middle of a craft with two equal booms turns it by rounding alone, which has poles and zeros too.
TEST(Response, OfWhatSymmetryKeepsApartIsNone) {
  const Prepared prepared = scene_of(R"(
bodies:
  hub: {type: rigid, mass: 4, inertia: [3, 3, 5, 0, 0, 0], frames: {right: {position: [0.5, 0, 0]},
    left: {position: [-0.5, 0, 0], orientation: {axis: [0, 0, 1], angle: "180 deg"}}, off: {position: [1.0e-6, 0, 0]}}}
  right: {type: beam, length: 2, mass_per_length: 0.3, bending_y: {stiffness: 5, modes: 3}, damping_ratio: 0.01}
  left: {type: beam, length: 2, mass_per_length: 0.3, bending_y: {stiffness: 5, modes: 3}, damping_ratio: 0.01}
hinges:
  float: {type: free, parent: world, child: hub}
  one: {type: weld, parent: hub.right, child: right}
  two: {type: weld, parent: hub.left, child: left}
loads:
  push: {type: input, frame: hub, direction: [0, 1, 0]}
  aside: {type: input, frame: hub.off, direction: [0, 1, 0]}
outputs: {rate: {type: gyro, of: hub}, place: {type: frame, of: hub, show: position}}
)");
  const auto ask = [&](const std::string& input, const std::string& output) {
    return response(at_start(prepared), {input, output, {}, {}, 20, {}});
  };
  EXPECT_THROW(ask("push", "rate.z"), Unfelt);
  EXPECT_EQ(ask("push", "place.y").integrators, 2);
  // L (s² J)⁻¹ s at low frequency: the moment of a micrometre, about the inertia of the whole.
  const double inertia = 5 + 2 * 0.3 * (2.5 * 2.5 * 2.5 - 0.5 * 0.5 * 0.5) / 3;
  EXPECT_NEAR(ask("aside", "rate.z").static_gain, 1e-6 / inertia, 1e-4 * 1e-6 / inertia);
}

TEST(Response, WhatCannotBeAskedIsSaid) {
  const Prepared prepared = scene_of(free_body);
  const auto ask = [&](const std::string& input, const std::string& output) {
    return response(at_start(prepared), {input, output, {}, {}, 10, {}});
  };
  EXPECT_THROW(ask("push", "box"), OptionError) << "three components";
  EXPECT_THROW(ask("pusch", "box.y"), InputError);
  EXPECT_THROW(ask("push", "boxx.y"), InputError);
  EXPECT_THROW(ask("push", ""), InputError);
  EXPECT_THROW(ask("turn", "place.z"), std::domain_error) << "a turn in the plane lifts nothing";
}

TEST(Reduction, OfALongArmStaysWithinItsBound) {
  const Prepared prepared = scene_of(R"(
bodies:
  boom: {type: beam, length: 1, mass_per_length: 1, bending_y: {stiffness: 40, modes: 6, family: clamped-free}, damping_ratio: 0.02}
hinges: {root: {type: revolute, axis: [0, 0, 1], parent: world, child: boom}}
loads: {control: {type: pd-controller, law: constant, sample: 0.01, hinges: {root: {stiffness: 4, damping: 1}}}}
outputs: {tip: {type: frame, of: boom.tip, show: position}}
)");
  SceneValues continuous = prepared.values;
  continuous.set_text("loads={}");
  for (const Prepared& p : {prepared, prepare(continuous, plugins())}) {
    const bool free = p.model().loads().empty();
    for (const int order : {4, 6, 9}) {
      const Response r = response(at_start(p), {"root", "tip.y", {}, {}, 50, order});
      ASSERT_TRUE(r.reduction);
      EXPECT_EQ(r.reduction->system.A.rows(), order);
      EXPECT_EQ(r.reduction->kept, free ? 2 : 0) << "a free hinge does not decay";
      EXPECT_LE(r.reduction_error, r.reduction->bound * (1 + 1e-6) + 1e-12);
      EXPECT_GT(r.reduction_error, 1e-3 * r.reduction->bound) << "the bound is not idle";
    }
  }
}

TEST(Response, OfALoopThatMovesInStepsIsRefusedByTheNameOfWhatDoes) {
  const Prepared p = scene_of(R"(
bodies: {table: {type: rigid, mass: 1, inertia: [1, 1, 2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
loads:
  read: {type: quantizer, of: axle, step: 0.005, sample: 0.01}
  servo: {type: pid, of: read, hinge: axle, proportional: 3, sample: 0.01}
)");
  try {
    ResponseQuestion question;
    question.input = "servo";
    static_cast<void>(response(at_start(p), question));
    FAIL() << "a quantizer has no linear form";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("load 'read' gives what it measures in steps"), std::string::npos) << e.what();
  }
}

/// An integral holds what a force moves: G(0) is zero, and of a sampled loop G at half its rate, to the last digit. No
/// gain makes the loop unstable there.
TEST(Response, ThatIsZeroAtAnEndHasNoGainMarginThere) {
  for (const std::string sample : {"", ", sample: 0.02"}) {
    const Prepared prepared = scene_of(R"(
bodies: {m: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [1, 0, 0], parent: world, child: m}}
loads:
  control: {type: pid, of: axle, hinge: axle, proportional: 10, derivative: 4, integral: 3, filter: 0.05)" +
                                       sample + R"(}
  push: {type: input, hinge: axle}
)");
    const Response r = response(at_start(prepared), {"push", "axle", {}, {}, 50, {}});
    EXPECT_EQ(r.static_gain, 0) << sample;
    ASSERT_TRUE(r.margins.has_value());
    for (const GainMargin& margin : r.margins->gains) {
      EXPECT_GT(margin.omega, 0) << sample << ' ' << margin.factor;
      EXPECT_LT(margin.factor, 1e9) << sample << ' ' << margin.omega;
    }
  }
}

}  // namespace
}  // namespace withy::study
