/// \file
/// Newton's and Euler's laws for every body, of random trees under loads of all kinds and of every scene that comes
/// along: the rate of its momentum, by differences along the motion, is what hinges, loops and loads exert and weight.
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

/// Of one body, from the motion of all its mass: linear momentum, angular momentum about the world's origin, and the
/// first moment of its mass.
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
  [[nodiscard]] Eigen::Matrix<double, 9, Eigen::Dynamic> sums(const State& s) const {
    const reference::ReferenceTree<double> tree(model, terms, s.y);
    Eigen::Matrix<double, 9, Eigen::Dynamic> all(9, static_cast<Eigen::Index>(model.bodies().size()));
    using Motion = reference::WorldMotion<double>;
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
      MassSums sum = MassSums::Zero();
      tree.each(
          b,
          [&](double mass, const Motion& A) {
            sum.head<3>() += mass * A.v;
            sum.segment<3>(3) += mass * A.p.cross(A.v);
            sum.tail<3>() += mass * A.p;
          },
          [&](const Matrix3& inertia, const Motion& A) { sum.segment<3>(3) += A.R * inertia * A.R.transpose() * A.w; });
      all.col(static_cast<Eigen::Index>(b)) = sum;
    }
    return all;
  }
};

/// A wrench about a place, as one about the world's origin: force, then moment.
Vector6 about_origin(const Wrench& w, const Vector3& place) {
  Vector6 both;
  both << w.force, w.moment + place.cross(w.force);
  return both;
}

/// The wrench of a hinge on its child in the world.
Vector6 in_world(SensedState& sensed, const Model& model, std::size_t hinge) {
  const HingeNode& node = model.hinges()[hinge];
  const Matrix3 R =
      (node.parent < 0 ? Matrix3(Matrix3::Identity()) : sensed.motion({node.parent, node.parent_frame}).R) *
      node.offset.R;
  const Wrench w = sensed.reaction(static_cast<int>(hinge));
  return about_origin({R * w.moment, R * w.force}, sensed.motion({node.child, node.child_frame}).position);
}

/// What loads and closed loops exert at frames of bodies: one column a body.
Eigen::Matrix<double, 6, Eigen::Dynamic> applied(const Case& c, SensedState& sensed) {
  const Model& model = *c.scene.model;
  Eigen::Matrix<double, 6, Eigen::Dynamic> all =
      Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, static_cast<Eigen::Index>(model.bodies().size()));
  const auto add = [&](std::span<const FrameIndex> frames, const std::vector<Wrench>& wrenches) {
    for (std::size_t i = 0; i < frames.size(); ++i)
      all.col(frames[i].body) += about_origin(wrenches[i], sensed.motion(frames[i]).position);
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

/// `step` [s] of the differences, of eighth order, along the motion.
void expect_closed(const Case& c, double tolerance, double step, const std::string& what) {
  const Model& model = *c.scene.model;
  const auto sensed = c.equations->make_sensed_state({});
  ASSERT_TRUE(sensed->observe(c.state)) << what;
  const WholeTree tree(c);
  const auto bodies = static_cast<Eigen::Index>(model.bodies().size());
  const Eigen::MatrixXd rates =
      central_difference([&](double h) -> Eigen::MatrixXd { return tree.sums(moved(c, h)).topRows<6>(); }, step);
  const Eigen::Matrix<double, 9, Eigen::Dynamic> now = tree.sums(c.state);
  Eigen::Matrix<double, 6, Eigen::Dynamic> exerted = applied(c, *sensed);
  double size = 1 + rates.cwiseAbs().maxCoeff();
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const Vector6 w = in_world(*sensed, model, h);
    size = std::max(size, w.norm());
    exerted.col(model.hinges()[h].child) += w;
    if (model.hinges()[h].parent >= 0) exerted.col(model.hinges()[h].parent) -= w;
  }
  for (Eigen::Index b = 0; b < bodies; ++b) {
    double mass = 0;
    for (const Particle& p : model.bodies()[static_cast<std::size_t>(b)].body->shape().particles) mass += p.mass;
    exerted.col(b).head<3>() += mass * model.gravity();
    exerted.col(b).tail<3>() += now.col(b).tail<3>().cross(model.gravity());
    EXPECT_LT((rates.col(b) - exerted.col(b)).norm(), tolerance * size)
        << what << ", body '" << model.bodies()[static_cast<std::size_t>(b)].name << "'";
  }
}

TEST(Closure, of_newtons_and_eulers_laws_holds_for_every_body_of_random_trees) {
  const std::vector<std::string> untruncated = {"quadratic", "linear", "exact"};
  const std::string fields =
      "  star: {type: point-gravity, parameter: 30, center: [0.5, -2, 6]}\n"
      "  axes: {type: rotating-frame, axis: [1, 2, -2], rate: 0.8, acceleration: 0.6}\n";
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const std::string& formulation = untruncated[seed % 3];
    const int bodies = 3 + static_cast<int>(seed % 5);
    const bool planar = seed % 4 == 0;
    RandomScene random(seed, {.bodies = bodies, .planar = planar, .any_root = seed % 2 == 0 && formulation != "exact"});
    Case c(random.text() + (planar ? "" : frame_loads(seed, bodies) + (seed % 5 < 2 ? fields : "")), formulation);
    c.state = random.state(*c.scene.model, c.scene.initial);
    // Sections of a rod are turned by another method than the reference's, to 1e-8; stiffness magnifies it.
    expect_closed(c, formulation == "exact" ? 1e-6 : 1e-9, 3e-4, formulation + ", seed " + std::to_string(seed));
  }
}

/// Each after a short run, so that it moves and its controllers have states.
TEST(Closure, of_newtons_and_eulers_laws_holds_for_every_body_of_every_scene) {
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
    expect_closed(c, 1e-9, 1e-4, file.filename().string());
  }
}

}  // namespace
}  // namespace withy::test
