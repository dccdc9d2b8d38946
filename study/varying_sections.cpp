#include "withy/study/varying_sections.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "withy/core/shape/modal_mass.hpp"
#include "withy/core/shape/vibrations.hpp"
#include "withy/study/mode_basis.hpp"
#include "withy/study/tip_load.hpp"

namespace withy::study {
namespace {

/// First frequency of some of a body's modes, its root held and all others at rest [Hz].
double first_clamped_hertz(const Body& body, Eigen::Index from, Eigen::Index count) {
  const Eigen::MatrixXd K = body.shape().stiffness.block(from, from, count, count),
                        G = modal_mass(body.shape()).block(from, from, count, count);
  return std::sqrt(vibrations(K, G).squares[0]) / (2 * std::numbers::pi);
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
    const auto of_an_even_beam = [&](const ModeCount& count) { return spans_cantilevers(count.family, registry); };
    const std::string text = notably_faster_strains(scene, modes, *scene.model->bodies()[b].body,
                                                    {vibration_modes, of_an_even_beam, first_clamped_hertz}, registry);
    if (text.empty()) continue;
    all.push_back({scene.source.at("bodies").at(modes.body).place(),
                   text + ": functions of an even beam fit a stiffness that varies badly; choose family: "
                          "vibration-modes, or more of them"});
  }
}

}  // namespace withy::study
