#include "withy/study/tip_moments.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "withy/core/simulation/tips.hpp"

namespace withy::study {
namespace {

/// Part of its own mass from which what a flexible body carries is looked at; part of the deflection by which other
/// functions have to do better, and bodies of a tree that are looked at; a gravity [m/s²] that bends nothing far.
constexpr double carries_something = 0.2, noticeable = 0.015, weak = 1e-6;
constexpr std::size_t few_enough = 20;
constexpr std::size_t most_functions = 100;  ///< that polynomials have

/// Of each body, its own mass, and that of all that hangs on it without itself.
struct Masses {
  std::vector<double> own, carried;
};

Masses masses_of(const Model& model) {
  Masses m{std::vector<double>(model.bodies().size()), std::vector<double>(model.bodies().size())};
  for (std::size_t b = model.bodies().size(); b-- > 0;) {
    for (const Particle& p : model.bodies()[b].body->shape().particles) m.own[b] += p.mass;
    const int parent = model.hinges()[b].parent;
    if (parent >= 0) m.carried[static_cast<std::size_t>(parent)] += m.carried[b] + m.own[b];
  }
  return m;
}

/// Deflections of a flexible body's tip under its weight and that of all it carries, along the world's axes in turn,
/// all hinges held, over the acceleration [s²]; nothing where the body has no tip.
std::vector<std::array<double, 3>> sag(const SceneValues& values, const std::string& body, Registry& registry) {
  std::vector<std::array<double, 3>> all;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    SceneValues weighed = values;
    std::vector<Value> gravity(3, Value(0.0));
    gravity[axis] = Value(weak);
    const std::string origin = "a load to compare functions by";
    const Prepared p = prepare(weighed.set("gravity", Value::list(gravity), origin), registry);
    const Layout& layout = p.model().layout();
    for (const Tip& tip : tips(p.model())) {
      if (tip.body != body || tip.in_segments()) continue;
      const auto b = static_cast<std::size_t>(tip.tip.body);
      const Slot& slot = *layout.modes(b);
      State state = p.scene.initial;
      for (const Slot& s : layout.bodies)
        std::fill_n(state.y.begin() + static_cast<std::ptrdiff_t>(s.position), s.positions, 0.0);
      std::fill_n(state.y.begin() + static_cast<std::ptrdiff_t>(layout.positions), layout.speeds, 0.0);
      const DenseSystem system = p.equations->system(state.time, state.y);
      const Eigen::MatrixXd& stiffness = p.model().bodies()[b].body->shape().stiffness;
      const Eigen::VectorXd q =
          stiffness.ldlt().solve(Eigen::Map<const Eigen::VectorXd>(system.force.data() + slot.speed, stiffness.rows()));
      std::copy(q.begin(), q.end(), state.y.begin() + static_cast<std::ptrdiff_t>(slot.position));
      all.push_back(p.equations->deflection(state.y, tip.tip.body, tip.tip.frame));
    }
  }
  return all;
}

double norm(const std::array<double, 3>& v) { return std::hypot(v[0], v[1], v[2]); }

/// A body whose bending functions carry no moment at the tip, where another hangs on it: they converge like 1/n. How
/// far they are, as many functions that carry one tell.
void look_at_tip_moment(const Prepared& prepared, const std::string& name, Registry& registry,
                        std::vector<Remark>& all) {
  SceneValues values = prepared.values;
  std::string counts;
  for (const BodyModes& body : prepared.scene.modes) {
    if (body.body != name) continue;
    for (const ModeCount& count : body.counts) {
      if (count.family_path.empty() || count.family_id() != "clamped-free" || count.modes == 0 ||
          count.modes > most_functions)
        continue;
      values.set("bodies." + name + "." + count.family_path, Value(std::string("orthogonal-polynomials")),
                 "functions with a moment at the tip");
      counts += fmt::format("{}{} {}", counts.empty() ? "" : " and ", count.modes, count.strain);
    }
  }
  if (counts.empty()) return;
  const auto ours = sag(prepared.values, name, registry), theirs = sag(values, name, registry);
  double greatest = 0, apart = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    greatest = std::max(greatest, norm(theirs[i]));
    apart = std::max(apart, norm({ours[i][0] - theirs[i][0], ours[i][1] - theirs[i][1], ours[i][2] - theirs[i][2]}));
  }
  if (!(apart > noticeable * greatest)) return;
  all.push_back({prepared.scene.source.at("bodies").at(name).place(),
                 fmt::format("{} modes of clamped-free carry no moment at the tip, where other bodies hang: under "
                             "their weight it deflects {:.2g} % otherwise than with as many of family: "
                             "orthogonal-polynomials, and that error falls like 1/n only; choose these, or "
                             "clamped-loaded with that load",
                             counts, 100 * apart / greatest)});
}

}  // namespace

void look_at_tip_moments(const Prepared& prepared, Registry& registry, std::vector<Remark>& all) {
  const Model& model = prepared.model();
  const Masses masses = masses_of(model);
  std::size_t looked_at = 0;
  for (std::size_t b = 0; b < model.bodies().size() && looked_at < few_enough; ++b) {
    const BodyNode& node = model.bodies()[b];
    if (node.body->shape().modes() == 0 || node.segment) continue;
    if (masses.carried[b] < carries_something * masses.own[b]) continue;
    ++looked_at;
    look_at_tip_moment(prepared, node.name, registry, all);
  }
}

}  // namespace withy::study
