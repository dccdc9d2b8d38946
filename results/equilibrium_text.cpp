#include "withy/results/equilibrium_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "withy/core/model/columns.hpp"
#include "withy/results/modes_files.hpp"
#include "withy/results/text_table.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

TextTable hinge_table(const study::Configuration& c, const SteadyState& steady) {
  TextTable table({"<coordinate", "value", "<unit", "rate\n[rad/s, m/s]", "<held", "effort\n[N m, N]"});
  const Model& model = c.prepared().model();
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const Slot& slot = c.layout().hinges[h];
    const auto columns = coordinate_columns(model.hinges()[h]);
    for (std::size_t i = 0; i < std::max(slot.positions, slot.speeds); ++i) {
      const bool has_speed = i < slot.speeds;
      const bool held = has_speed && c.held()[slot.speed + i];
      table.add({i < slot.positions ? columns[i].name : c.layout().speed_names[slot.speed + i],
                 i < slot.positions ? fmt::format("{:.6g}", steady.state.y[slot.position + i]) : "-",
                 i < slot.positions ? columns[i].unit : "",
                 has_speed ? fmt::format("{:.6g}", steady.state.y[c.layout().positions + slot.speed + i]) : "-",
                 held ? "yes" : "no",
                 held ? fmt::format("{:.6g}", steady.efforts[static_cast<Eigen::Index>(slot.speed + i)]) : "-"});
    }
  }
  return table;
}

/// The continuous states of loads, and what sampled ones hold.
TextTable state_table(const study::Configuration& c, const SteadyState& steady) {
  TextTable table({"<state of a load", "value"});
  const Layout& layout = c.layout();
  for (std::size_t i = 0; i < layout.continuous; ++i)
    table.add(
        {layout.continuous_names[i], fmt::format("{:.6g}", steady.state.y[layout.positions + layout.speeds + i])});
  const Model& model = c.prepared().model();
  const std::vector<std::string> names = study::sampled_names(model);
  std::size_t next = 0;
  for (const LoadSlot& slot : study::sampled_slots(model))
    for (std::size_t i = slot.first; i < slot.first + slot.count; ++i)
      table.add({names[next++], fmt::format("{:.6g}", steady.state.y[i])});
  return table;
}

TextTable deflection_table(const study::Equilibrium& found) {
  TextTable table({"<tip", "deflection x\n[mm]", "y\n[mm]", "z\n[mm]"});
  for (const auto& [name, d] : found.deflections) {
    std::vector<std::string> cells = {name};
    for (const double x : d) cells.push_back(fmt::format("{:.6g}", 1e3 * x));
    table.add(std::move(cells));
  }
  return table;
}

}  // namespace

Json equilibrium_json(const study::Configuration& c, const study::Equilibrium& found) {
  Json j;
  j["scene"] = c.prepared().scene.file;
  j["formulation"] = c.prepared().scene.formulation_name;
  j.update(steady_json(c.prepared().model(), found.steady, c.held()));
  Json deflections = Json::object();
  for (const auto& [name, d] : found.deflections) deflections[name] = d;
  j["tip_deflections"] = std::move(deflections);
  j["stays_steady"] = found.stays;
  j["bent"] = found.bent;
  j["against_next"] = against_json(found.against);
  j["derivatives"] = found.derivatives;
  j["message"] = found.problem.empty() ? found.changing : found.problem;
  return j;
}

namespace {

std::string along_forces(const SteadyState& s) {
  return s.relaxations > 0 ? fmt::format("{} steps along the forces and ", s.relaxations) : "";
}

}  // namespace

std::string equilibrium_text(const study::Configuration& c, const study::Equilibrium& found) {
  const Scene& scene = c.prepared().scene;
  std::string text =
      fmt::format("{} in {}: {} after {}{} steps of Newton's method\n\n{}", scene.file, scene.formulation_name,
                  found.instant ? "balanced at this instant" : "steady", along_forces(found.steady),
                  found.steady.iterations, hinge_table(c, found.steady).str());
  if (c.layout().continuous > 0 || c.sampled()) text += '\n' + state_table(c, found.steady).str();
  if (!found.deflections.empty()) text += '\n' + deflection_table(found).str();
  if (const std::string words = study::against_next_text(found.against, "deflections"); !words.empty())
    text += '\n' + words + '\n';
  if (!found.bent.empty()) text += '\n' + found.bent + '\n';
  if (!found.changing.empty()) text += '\n' + found.changing + '\n';
  return text;
}

}  // namespace withy
