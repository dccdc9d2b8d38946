#include "withy/study/held_places.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include "withy/core/shape/held_section.hpp"
#include "withy/core/shape/vibrations.hpp"
#include "withy/core/simulation/motion_stiffness.hpp"
#include "withy/study/mode_basis.hpp"

namespace withy::study {
namespace {

/// Whether all turns that modes give a section are held: it is clamped.
bool is_clamped(const HeldSection& at) { return (at.held * at.at.psi - at.at.psi).isZero(1e-9 * at.at.psi.norm()); }

/// First frequency [Hz] of some of a body's modes, a section of it clamped; not a number where they have no mass then.
double first_hertz(const Body& body, const HeldSection& at, Eigen::Index from, Eigen::Index count) {
  const Eigen::MatrixXd K = body.shape().stiffness.block(from, from, count, count),
                        G = modal_mass(body.shape(), at).block(from, from, count, count);
  if (Eigen::LLT<Eigen::MatrixXd>(G).info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
  return std::sqrt(vibrations(K, G).squares[0]) / (2 * std::numbers::pi);
}

/// Where polynomials bend notably better; empty where the body's functions do about as well.
std::string of_held_strains(const Scene& scene, const BodyModes& modes, const Body& body, const HeldSection& at,
                            Registry& registry) {
  const auto held_hertz = [&](const Body& of, Eigen::Index first, Eigen::Index count) {
    if (&of == &body) return first_hertz(body, at, first, count);
    const std::optional<PointExpansion> section = of.station(at.at.X.x());
    return section ? first_hertz(of, {*section, at.held}, first, count) : std::numeric_limits<double>::quiet_NaN();
  };
  const auto there_are_as_many = [](const ModeCount& count) { return count.modes <= most_polynomials; };
  return notably_faster_strains(scene, modes, body, {polynomials, there_are_as_many, held_hertz}, registry);
}

/// A beam's sections are one with its root, but functions that are made for a clamped root and a free tip have no
/// moment where it is held instead, and those that are made for a pinned or a free root none at a clamped one.
std::string of_beam(const Prepared& prepared, std::size_t b, Registry& registry) {
  const Model& model = prepared.model();
  const BodyNode& node = model.bodies()[b];
  const std::optional<HeldSection> at = held_root(model, b);
  if (node.segment || !at || !is_clamped(*at)) return {};
  for (const BodyModes& modes : prepared.scene.modes)
    if (modes.body == node.name) return of_held_strains(prepared.scene, modes, *node.body, *at, registry);
  return {};
}

}  // namespace

void look_at_held_places(const Prepared& prepared, Registry& registry, std::vector<Remark>& all) {
  const Model& model = prepared.model();
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const HingeNode& hinge = model.hinges()[h];
    const auto b = static_cast<std::size_t>(hinge.child);
    const BodyNode& node = model.bodies()[b];
    if (node.body->shape().modes() == 0) continue;
    const Frame& held = node.frames[static_cast<std::size_t>(hinge.child_frame)];
    const PointExpansion root = *node.body->station(std::string("root"));
    const bool at_root = held.section.X == root.X;
    if (held.section.phi.isZero(0) && held.section.psi.isZero(0)) continue;
    const std::string begin =
        fmt::format("holds '{}' at '{}', where its modes {}", node.name, held.name, at_root ? "turn it" : "move");
    if (!node.body->cut(0)) {
      if (at_root) continue;
      all.push_back({place_in_scene(prepared.scene, "hinges", hinge.name),
                     begin + "; they are those of the body held at its root and leave all that is clamped there "
                             "undeformed: hold it at its root"});
      continue;
    }
    const std::string strains = of_beam(prepared, b, registry);
    if (strains.empty()) continue;
    all.push_back({place_in_scene(prepared.scene, "hinges", hinge.name),
                   begin + ", and they bend badly when it is clamped there: " + strains +
                       (at_root ? "; choose these, or a hinge that lets it turn, if that is meant"
                                : "; choose these, or hold it at its root")});
  }
}

}  // namespace withy::study
