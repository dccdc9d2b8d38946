/// \file
/// Newton's and Euler's laws for every body, of random trees under loads of all kinds and of every scene that comes
/// along: the rate of its momentum, by differences along the motion, is what hinges, loops and loads exert and weight.
/// Roots of beams carry what hinges do there, and accelerations are rates of velocities.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "sensed_case.hpp"
#include "withy/core/deformation/mass_points.hpp"
#include "withy/core/plugin/closed_loops.hpp"
#include "withy/core/reference/reference_tree.hpp"
#include "withy/core/simulation/simulate.hpp"

namespace withy::test {
namespace {

/// Of one body, from the motion of all its mass: linear momentum, angular momentum about a place near it, and the first
/// moment of its mass there, seen by an observer who flies along. Nothing would be left of the digits of a satellite
/// about the world's origin.
using MassSums = Eigen::Matrix<double, 9, 1>;

/// A tree whose bodies are without truncation, in the kinematics of the scene.
struct WholeTree {
  const Model& model;
  std::vector<RodTable> tables;
  std::vector<reference::BodyTerms<double>> terms;

  explicit WholeTree(const Case& c) : model(*c.scene.model) {
    tables.reserve(model.bodies().size());
    for (const BodyNode& node : model.bodies()) {
      const StrainOrder order = node.terms.value_or(c.scene.formulation->terms()).strain;
      const bool rod = order == StrainOrder::exact && node.body->shape().modes() > 0;
      if (rod) tables.emplace_back(*node.body->rod());
      terms.push_back({order, 1.0, rod ? &tables.back() : nullptr});
    }
  }
  /// One column a body.
  [[nodiscard]] Eigen::Matrix<double, 9, Eigen::Dynamic> sums(const State& s, const Matrix3X& places,
                                                              const Matrix3X& flying) const {
    const reference::ReferenceTree<double> tree(model, terms, s.y);
    Eigen::Matrix<double, 9, Eigen::Dynamic> all(9, static_cast<Eigen::Index>(model.bodies().size()));
    using Motion = reference::WorldMotion<double>;
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
      MassSums sum = MassSums::Zero();
      tree.each(
          b,
          [&](double mass, const Motion& A) {
            const Vector3 arm = A.p - places.col(static_cast<Eigen::Index>(b));
            const Vector3 v = A.v - flying.col(static_cast<Eigen::Index>(b));
            sum.head<3>() += mass * v;
            sum.segment<3>(3) += mass * arm.cross(v);
            sum.tail<3>() += mass * arm;
          },
          [&](const Matrix3& inertia, const Motion& A) { sum.segment<3>(3) += A.R * inertia * A.R.transpose() * A.w; });
      all.col(static_cast<Eigen::Index>(b)) = sum;
    }
    return all;
  }
};

/// A wrench about `at` as one about `place`: force, then moment.
Vector6 about(const Vector3& place, const Wrench& w, const Vector3& at) {
  Vector6 both;
  both << w.force, w.moment + (at - place).cross(w.force);
  return both;
}

/// The wrench of a hinge on its child in world axes, about a place.
Vector6 in_world(SensedState& sensed, const Model& model, std::size_t hinge, const Vector3& place) {
  const HingeNode& node = model.hinges()[hinge];
  const Matrix3 R =
      (node.parent < 0 ? Matrix3(Matrix3::Identity()) : sensed.motion({node.parent, node.parent_frame}).R) *
      node.offset.R;
  const Wrench w = sensed.reaction(static_cast<int>(hinge));
  return about(place, {R * w.moment, R * w.force}, sensed.motion({node.child, node.child_frame}).position);
}

/// What loads and closed loops exert at frames of bodies: one column a body.
Eigen::Matrix<double, 6, Eigen::Dynamic> applied(const Case& c, SensedState& sensed, const Matrix3X& places) {
  const Model& model = *c.scene.model;
  Eigen::Matrix<double, 6, Eigen::Dynamic> all =
      Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, static_cast<Eigen::Index>(model.bodies().size()));
  const auto add = [&](std::span<const FrameIndex> frames, const std::vector<Wrench>& wrenches) {
    for (std::size_t i = 0; i < frames.size(); ++i)
      all.col(frames[i].body) += about(places.col(frames[i].body), wrenches[i], sensed.motion(frames[i]).position);
  };
  std::vector<double> scratch(model.load_scratch());
  for (const LoadNode& node : model.loads()) {
    std::vector<FrameMotion> motions;
    for (const FrameIndex& at : node.load->frames()) motions.push_back(sensed.motion(at));
    std::vector<Wrench> wrenches(motions.size());
    node.wrenches(c.state.time, c.state.y, model.layout(), motions, wrenches, scratch);
    add(node.load->frames(), wrenches);
  }
  if (const auto* loops = dynamic_cast<const ClosedLoops*>(c.equations.get())) {
    Work work = c.equations->make_work();
    std::vector<double> multipliers(loops->closing_equations());
    loops->multipliers(c.state.time, c.state.y, multipliers, work);
    std::vector<Wrench> wrenches(loops->frames().size());
    loops->wrenches(multipliers, wrenches, work);
    add(loops->frames(), wrenches);
  }
  return all;
}

/// The hinge that holds a beam at its root carries what the section there does.
void expect_roots_carried(const Case& c, const std::string& what) {
  const Model& model = *c.scene.model;
  std::vector<SectionPlace> roots;
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    if (model.hinges()[b].child_frame == 0 && model.bodies()[b].body->cut(0)) roots.push_back({static_cast<int>(b), 0});
  }
  const auto sensed = c.equations->make_sensed_state(roots);
  ASSERT_TRUE(sensed->observe(c.state)) << what;
  for (std::size_t i = 0; i < roots.size(); ++i) {
    const HingeNode& hinge = model.hinges()[static_cast<std::size_t>(roots[i].body)];
    const Matrix3 R = sensed->motion({hinge.child, 0}).R;
    const Vector3 place = sensed->motion({hinge.child, 0}).position;
    const Vector6 of_hinge = in_world(*sensed, model, static_cast<std::size_t>(roots[i].body), place);
    const Wrench inner = sensed->section(i).inner;
    const Vector6 of_section = about(place, {R * inner.moment, R * inner.force}, place);
    EXPECT_LT((of_hinge - of_section).norm(), 1e-9 * (1 + of_hinge.norm())) << what << ", body " << roots[i].body;
  }
}

/// Accelerations of all bodies are the rates of their velocities.
void expect_rates(const Case& c, double step, const std::string& what) {
  const auto sensed = c.equations->make_sensed_state({});
  ASSERT_TRUE(sensed->observe(c.state)) << what;
  const auto seen = c.equations->make_observation();
  const auto bodies = static_cast<Eigen::Index>(c.scene.model->bodies().size());
  const Eigen::MatrixXd rates = central_difference(
      [&](double h) {
        seen->observe(moved(c, h).y);
        Eigen::MatrixXd all(6, bodies);
        for (Eigen::Index b = 0; b < bodies; ++b) {
          const WorldVelocity V = seen->frame_velocity(static_cast<int>(b), 0);
          all.col(b) << arrow(V.angular), arrow(V.linear);
        }
        return all;
      },
      step);
  for (Eigen::Index b = 0; b < bodies; ++b) {
    const FrameAcceleration a = sensed->acceleration({static_cast<int>(b), 0});
    Vector6 both;
    both << a.angular, a.linear;
    EXPECT_LT((both - rates.col(b)).norm(), 1e-7 * (1 + both.norm())) << what << ", body " << b;
  }
}

/// What is left of Newton's and Euler's laws of each body, over the greatest that is exerted.
/// \param step [s] of the differences, of eighth order, along the motion
Eigen::VectorXd left_open(const Case& c, double step, const std::string& what) {
  const Model& model = *c.scene.model;
  const auto sensed = c.equations->make_sensed_state({});
  EXPECT_TRUE(sensed->observe(c.state)) << what;
  const WholeTree tree(c);
  const auto bodies = static_cast<Eigen::Index>(model.bodies().size());
  Matrix3X places(3, bodies), flying(3, bodies);
  for (Eigen::Index b = 0; b < bodies; ++b) {
    const FrameMotion m = sensed->motion({static_cast<int>(b), 0});
    places.col(b) = m.position;
    flying.col(b) = m.velocity;
  }
  const Eigen::MatrixXd rates = central_difference(
      [&](double h) -> Eigen::MatrixXd { return tree.sums(moved(c, h), places, flying).topRows<6>(); }, step);
  const Eigen::Matrix<double, 9, Eigen::Dynamic> now = tree.sums(c.state, places, flying);
  Eigen::Matrix<double, 6, Eigen::Dynamic> exerted = applied(c, *sensed, places);
  double size = 1 + rates.cwiseAbs().maxCoeff();
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const int child = model.hinges()[h].child, parent = model.hinges()[h].parent;
    const Vector6 w = in_world(*sensed, model, h, places.col(child));
    size = std::max(size, w.norm());
    exerted.col(child) += w;
    if (parent >= 0) exerted.col(parent) -= in_world(*sensed, model, h, places.col(parent));
  }
  Eigen::VectorXd open(bodies);
  for (Eigen::Index b = 0; b < bodies; ++b) {
    double mass = 0;
    for (const Particle& p : model.bodies()[static_cast<std::size_t>(b)].body->shape().particles) mass += p.mass;
    exerted.col(b).head<3>() += mass * model.gravity();
    exerted.col(b).tail<3>() += now.col(b).tail<3>().cross(model.gravity());
    // d/dt Σ m (p − p₀) × (v − w) = moment − (Σ m v) × w.
    exerted.col(b).tail<3>() -= now.col(b).head<3>().cross(flying.col(b));
    open[b] = (rates.col(b) - exerted.col(b)).norm() / size;
  }
  return open;
}

void expect_closed(const Case& c, double tolerance, double step, const std::string& what) {
  const Eigen::VectorXd open = left_open(c, step, what);
  for (Eigen::Index b = 0; b < open.size(); ++b)
    EXPECT_LT(open[b], tolerance) << what << ", body '" << c.scene.model->bodies()[static_cast<std::size_t>(b)].name
                                  << "'";
}

TEST(Closure, holds_for_every_body_of_random_trees) {
  const std::vector<std::string> untruncated = {"quadratic", "linear", "exact"};
  const std::string fields =
      "  star: {type: point-gravity, parameter: 30, center: [0.5, -2, 6]}\n"
      "  axes: {type: rotating-frame, axis: [1, 2, -2], rate: 0.8, acceleration: 0.6}\n";
  for (unsigned seed = 1; seed <= 130; ++seed) {
    const std::string& formulation = untruncated[seed % 3];
    const int bodies = 3 + static_cast<int>(seed % 5);
    const bool planar = seed % 4 == 0;
    RandomScene random(seed, {.bodies = bodies,
                              .planar = planar,
                              .any_root = seed % 2 == 0 && formulation != "exact",
                              .any_family = seed > 100,
                              .rotary = seed % 7 < 3,
                              .stretching = seed % 7 > 1 && seed % 7 < 5});
    Case c(random.text() + (planar ? "" : frame_loads(seed, bodies) + (seed % 5 < 2 ? fields : "")), formulation);
    c.state = random.state(*c.scene.model, c.scene.initial);
    const std::string what = formulation + ", seed " + std::to_string(seed);
    expect_closed(c, 1e-9, 3e-4, what);
    expect_roots_carried(c, what);
    expect_rates(c, 3e-4, what);
  }
}

/// Each after a short run, so that it moves and its controllers have states.
TEST(Closure, holds_for_every_body_of_every_scene) {
  namespace fs = std::filesystem;
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(WITHY_SOURCE_DIRECTORY) / "scenes")) {
    std::ifstream file(entry.path());
    std::stringstream text;
    text << file.rdbuf();
    if (entry.path().extension() == ".yaml" && text.str().find("\nformat: withy/1\n") != std::string::npos)
      files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  ASSERT_GT(files.size(), 25U);
  for (const fs::path& file : files) {
    Case c(file);
    RunOptions options;
    options.end = std::min(0.2, 0.1 * c.scene.end.value_or(end_of_run(c.scene)));
    options.output = options.end;
    options.events = c.scene.events;
    const RunSummary run =
        simulate(*c.scene.model, *c.equations, *c.scene.integrator, c.state, options, [](const State&) {});
    ASSERT_EQ(run.status, RunStatus::completed) << file << run.message;
    c.state = run.final;
    const std::string what = file.filename().string();
    expect_closed(c, 1e-9, 1e-3, what);
    expect_roots_carried(c, what);
    expect_rates(c, 1e-3, what);
  }
}

}  // namespace
}  // namespace withy::test
