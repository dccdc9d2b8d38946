#include "withy/study/tip_moments.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "withy/core/simulation/tips.hpp"
#include "withy/study/mode_basis.hpp"
#include "withy/study/tip_load.hpp"

namespace withy::study {
namespace {

/// Part of its own mass from which what a flexible body carries is looked at; part of the deflection by which functions
/// are off for a word, and part of that by which others are off at most to be proposed; a gravity [m/s²] that bends
/// nothing far.
constexpr double carries_something = 0.2, noticeable = 0.015, better_share = 0.5, weak = 1e-6;
constexpr std::size_t few_enough = 20;  ///< bodies of a tree that are looked at

/// Deflections of tips by their body's name, under its weight and that of all it carries along the world's axes in
/// turn, all hinges held and all other bodies straight, over the acceleration [s²]; nothing of bodies that have no tip.
using Sags = std::map<std::string, std::vector<std::array<double, 3>>>;

Sags sags_of(const SceneValues& values, const std::set<std::string>& bodies, Registry& registry) {
  Sags all;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    SceneValues weighed = values;
    std::vector<Value> gravity(3, Value(0.0));
    gravity[axis] = Value(weak);
    const std::string origin = "a load to compare functions by";
    const Prepared p = prepare(weighed.set("gravity", Value::list(gravity), origin), registry);
    const Layout& layout = p.model().layout();
    State state = p.scene.initial;
    for (const Slot& s : layout.bodies)
      std::fill_n(state.y.begin() + static_cast<std::ptrdiff_t>(s.position), s.positions, 0.0);
    std::fill_n(state.y.begin() + static_cast<std::ptrdiff_t>(layout.positions), layout.speeds, 0.0);
    const std::vector<double> still(layout.speeds, 0.0);
    std::vector<double> needed(layout.speeds);
    Work work = p.equations->make_work();
    p.equations->inverse_dynamics(state.y, still, needed, work);
    for (const Tip& tip : tips(p.model())) {
      if (!bodies.contains(tip.body) || tip.in_segments()) continue;
      const auto b = static_cast<std::size_t>(tip.tip.body);
      const Slot& slot = *layout.modes(b);
      const Eigen::MatrixXd& stiffness = p.model().bodies()[b].body->shape().stiffness;
      const Eigen::VectorXd q = -stiffness.ldlt().solve(
          Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(needed.data() + slot.speed, stiffness.rows())));
      std::copy(q.begin(), q.end(), state.y.begin() + static_cast<std::ptrdiff_t>(slot.position));
      all[tip.body].push_back(p.equations->deflection(state.y, tip.tip.body, tip.tip.frame));
    }
  }
  return all;
}

/// A strain of a body whose functions carry no moment at the tip.
struct Bending {
  ModeCount count;
  std::size_t proposed = 0, richer = 0;  ///< polynomials that are proposed, and those that tell the truth
};

/// The least number that is proposed: one polynomial is a parabola, which no force at the tip bends a beam to. Two are
/// those of an even beam at the tip, whatever it carries. More of them tell the truth of those that vary.
constexpr std::size_t least_polynomials = 2, further_polynomials = 2;

std::vector<Bending> without_moment(const Scene& scene, const std::string& name) {
  std::vector<Bending> all;
  for (const BodyModes& body : scene.modes) {
    if (body.body != name) continue;
    for (const ModeCount& count : body.counts) {
      if (count.family_path.empty() || count.family_id() != "clamped-free" || count.modes == 0) continue;
      const std::size_t proposed = std::max(count.modes, least_polynomials), richer = proposed + further_polynomials;
      if (richer <= std::min(count.most, most_polynomials)) all.push_back({count, proposed, richer});
    }
  }
  return all;
}

/// The values of a body with polynomials in the place of these functions, below the body.
std::vector<std::pair<std::string, Value>> with_polynomials(const std::vector<Bending>& strains,
                                                            std::size_t Bending::*number) {
  std::vector<std::pair<std::string, Value>> values;
  for (const Bending& b : strains) {
    values.emplace_back(b.count.family_path, Value(std::string(polynomials)));
    values.emplace_back(b.count.path, Value(static_cast<double>(b.*number)));
  }
  return values;
}

/// Where the functions of a strain move the tip.
Vector3 along(const std::string& strain, const std::array<double, 3>& deflection) {
  return {0, strain == "bending_z" ? 0 : deflection[1], strain == "bending_y" ? 0 : deflection[2]};
}

using Deflections = std::vector<std::array<double, 3>>;

/// How far a list of deflections is from the truth where functions of a strain move the tip, over the greatest there.
double error_along(const std::string& strain, const Deflections& of, const Deflections& truth) {
  double greatest = 0, apart = 0;
  for (std::size_t i = 0; i < of.size(); ++i) {
    const Vector3 right = along(strain, truth[i]);
    greatest = std::max(greatest, right.norm());
    apart = std::max(apart, (along(strain, of[i]) - right).norm());
  }
  return greatest > 0 ? apart / greatest : 0;
}

/// What is said of a body; empty where nothing is to be.
std::string said_of(const std::vector<Bending>& strains, const Deflections& own, const Deflections& proposed,
                    const Deflections& truth) {
  std::string has, better;
  double off = 0;
  std::size_t functions = 0;
  for (const Bending& b : strains) {
    const std::string& strain = b.count.strain;
    const double error = error_along(strain, own, truth);
    if (!(error > noticeable) || !(error_along(strain, proposed, truth) < better_share * error)) continue;
    const char* const also = has.empty() ? "" : " and ";
    has += fmt::format("{}{} {}", also, b.count.modes, strain);
    better += fmt::format("{}{} {}", also, b.proposed, strain);
    off = std::max(off, error);
    functions += b.count.modes;
  }
  if (has.empty()) return {};
  return fmt::format(
      "{} mode{} of clamped-free carr{} no moment at the tip, where other bodies hang: under their weight it deflects "
      "{:.2g} % otherwise than with more functions that do; choose {} of family: {}, or clamped-loaded with that load",
      has, functions == 1 ? "" : "s", functions == 1 ? "ies" : "y", 100 * off, better, polynomials);
}

}  // namespace

void look_at_tip_moments(const Prepared& prepared, Registry& registry, std::vector<Remark>& all) {
  const Model& model = prepared.model();
  const BodyMasses masses = masses_of(model);
  // All bodies at once, for each is looked at with all others straight.
  SceneValues proposed = prepared.values, richer = prepared.values;
  std::map<std::string, std::vector<Bending>> bending;
  std::set<std::string> bodies;
  for (std::size_t b = 0; b < model.bodies().size() && bodies.size() < few_enough; ++b) {
    const BodyNode& node = model.bodies()[b];
    if (node.body->shape().modes() == 0 || node.segment) continue;
    if (masses.carried[b] < carries_something * masses.own[b]) continue;
    std::vector<Bending> strains = without_moment(prepared.scene, node.name);
    if (strains.empty()) continue;
    // What is said of each mode, as its damping, may not be there for more of them.
    if (body_with(prepared.scene, node.name, with_polynomials(strains, &Bending::proposed), registry) == nullptr ||
        body_with(prepared.scene, node.name, with_polynomials(strains, &Bending::richer), registry) == nullptr)
      continue;
    for (const auto& [values, number] : {std::pair(&proposed, &Bending::proposed), {&richer, &Bending::richer}}) {
      const std::string origin = "functions with a moment at the tip";
      for (auto& [path, value] : with_polynomials(strains, number))
        values->set("bodies." + node.name + "." + path, std::move(value), origin);
      // Coordinates of other functions; the bodies are looked at straight.
      if (const std::string start = "initial.bodies." + node.name; values->find(start) != nullptr)
        values->set(start, Value(), origin);
    }
    bending.emplace(node.name, std::move(strains));
    bodies.insert(node.name);
  }
  if (bodies.empty()) return;
  const Sags own = sags_of(prepared.values, bodies, registry), other = sags_of(proposed, bodies, registry),
             truth = sags_of(richer, bodies, registry);
  for (const auto& [name, strains] : bending) {
    if (!own.contains(name)) continue;
    std::string text = said_of(strains, own.at(name), other.at(name), truth.at(name));
    if (!text.empty()) all.push_back({prepared.scene.source.at("bodies").at(name).place(), std::move(text)});
  }
}

}  // namespace withy::study
