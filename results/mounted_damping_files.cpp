#include "withy/results/mounted_damping_files.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "withy/results/scene_edit.hpp"
#include "withy/results/text_table.hpp"

namespace withy {
namespace {

std::vector<std::string> settings(const study::MountedDamping& damping) {
  std::vector<std::string> texts;
  for (const study::Change& change : damping.changes) texts.push_back(change.text());
  return texts;
}

}  // namespace

nlohmann::ordered_json mounted_damping_json(const study::MountedDamping& damping) {
  nlohmann::ordered_json j{
      {"modes", nlohmann::ordered_json::array()}, {"set", settings(damping)}, {"frozen", damping.frozen}};
  for (const study::DampedMode& m : damping.modes)
    j["modes"].push_back({{"hertz", m.frequency / (2 * std::numbers::pi)}, {"asked", m.asked}, {"reached", m.reached}});
  return j;
}

std::string mounted_damping_text(const study::MountedDamping& damping) {
  TextTable table({"mode", "frequency\n[Hz]", "asked\n[%]", "reached\n[%]"});
  for (std::size_t i = 0; i < damping.modes.size(); ++i) {
    const study::DampedMode& m = damping.modes[i];
    table.add({std::to_string(i + 1), fmt::format("{:.5g}", m.frequency / (2 * std::numbers::pi)),
               fmt::format("{:.3g}", 100 * m.asked), fmt::format("{:.3g}", 100 * m.reached)});
  }
  std::string text =
      "Damping of the bodies' own modes that gives the tree's, as it is mounted, their ratios\n\n" + table.str();
  if (damping.frozen)
    text +=
        "\nThe equations change as hinges turn, or with time: this is found and reached at one angle, and bodies that "
        "are equal, as blades, may be given different ratios.\n";
  for (const std::size_t i : damping.beyond) text += fmt::format("\nMode {} has more damping from loads alone.", i + 1);
  return text + (damping.beyond.empty() ? "" : "\n") + "\n" + scene_lines(settings(damping));
}

}  // namespace withy
