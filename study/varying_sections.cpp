#include "withy/study/varying_sections.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "withy/core/shape/modal_mass.hpp"
#include "withy/core/shape/vibrations.hpp"
#include "withy/study/mode_basis.hpp"
#include "withy/study/tip_load.hpp"

namespace withy::study {
namespace {

/// Of a frequency: less is hardly worth a word.
constexpr double notably_faster = 0.015;

/// First frequency of some of a body's modes, its root held and all others at rest [rad/s].
double first_frequency(const Body& body, Eigen::Index from, Eigen::Index count) {
  const Eigen::MatrixXd K = body.shape().stiffness.block(from, from, count, count),
                        G = modal_mass(body.shape()).block(from, from, count, count);
  return std::sqrt(vibrations(K, G).squares[0]);
}

/// "2 bending_z modes of clamped-free vibrate first at 0.7407 Hz, as many of vibration-modes at 0.7250 Hz", strain by
/// strain; empty where the body's functions do about as well.
std::string of_its_strains(const Scene& scene, const BodyModes& modes, const Body& body, Registry& registry) {
  std::string text;
  Eigen::Index from = 0;
  for (const ModeCount& count : modes.counts) {
    const auto n = static_cast<Eigen::Index>(count.modes), first = std::exchange(from, from + n);
    if (n == 0 || count.family_path.empty() || count.family_id() == vibration_modes ||
        !spans_cantilevers(count.family, registry))
      continue;
    const auto other =
        body_with(scene, modes.body, {{count.family_path, Value(std::string(vibration_modes))}}, registry);
    if (other == nullptr || other->shape().modes() != body.shape().modes()) continue;
    const double has = first_frequency(body, first, n), could = first_frequency(*other, first, n);
    if (!(has > (1 + notably_faster) * could)) continue;
    const double cycle = 2 * std::numbers::pi;
    text += fmt::format("{}{} {} modes of {} vibrate first at {:.4g} Hz, as many of vibration-modes at {:.4g} Hz",
                        text.empty() ? "" : "; ", n, count.strain, count.family_id(), has / cycle, could / cycle);
  }
  return text;
}

}  // namespace

void look_at_varying_sections(const Prepared& prepared, Registry& registry, std::vector<Remark>& all) {
  const Scene& scene = prepared.scene;
  std::optional<std::vector<Matrix6>> loads;
  for (const BodyModes& modes : scene.modes) {
    const int index = scene.model->body(modes.body);
    if (index < 0 || !varies(scene, modes.body)) continue;
    if (!loads) loads = tip_loads(*scene.model, scene.initial);
    const auto b = static_cast<std::size_t>(index);
    if (!(*loads)[b].isZero(0)) continue;  // its functions may be made for what it carries
    const std::string text = of_its_strains(scene, modes, *scene.model->bodies()[b].body, registry);
    if (text.empty()) continue;
    all.push_back({scene.source.at("bodies").at(modes.body).place(),
                   text + ": functions of an even beam fit a stiffness that varies badly; choose family: "
                          "vibration-modes, or more of them"});
  }
}

}  // namespace withy::study
