#include "withy/results/equilibrium_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "withy/core/model/columns.hpp"
#include "withy/core/model/hinge_rates.hpp"
#include "withy/results/modes_files.hpp"
#include "withy/results/text_table.hpp"
#include "withy/study/at_limits.hpp"
#include "withy/study/formulation_meaning.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

/// A row a coordinate with the rate that is its derivative. Where none is, as of quaternions, coordinates and rates
/// have rows of their own.
TextTable hinge_table(const study::Configuration& c, const SteadyState& steady) {
  TextTable table({"<coordinate", "value", "<unit", "rate\n[rad/s, m/s]", "<held", "effort\n[N m, N]"});
  const Model& model = c.prepared().model();
  const Held kept = c.kept();
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const Slot& slot = c.layout().hinges[h];
    const std::vector<HingeRate> rates = hinge_rates(*model.hinges()[h].hinge);
    const std::vector<Column> coordinates = coordinate_columns(model.hinges()[h]),
                              of_rates = rate_columns(model.hinges()[h]);
    const auto add = [&](const std::string& name, std::optional<std::size_t> coordinate, std::optional<std::size_t> i) {
      const bool held = i && kept[slot.speed + *i];
      table.add({name, coordinate ? fmt::format("{:.6g}", steady.state.y[slot.position + *coordinate]) : "-",
                 coordinate ? coordinates[*coordinate].unit : "",
                 i ? fmt::format("{:.6g}", steady.state.y[c.layout().positions + slot.speed + *i]) : "-",
                 !i                           ? "-"
                 : held                       ? "yes"
                 : c.follows(slot.speed + *i) ? "follows"
                                              : "no",
                 held ? fmt::format("{:.6g}", steady.efforts[static_cast<Eigen::Index>(slot.speed + *i)]) : "-"});
    };
    for (std::size_t k = 0; k < slot.positions; ++k) {
      const auto of_it = [k](const HingeRate& rate) { return rate.coordinate == k; };
      const auto rate = std::find_if(rates.begin(), rates.end(), of_it);
      add(coordinates[k].name, k,
          rate == rates.end() ? std::nullopt : std::optional(static_cast<std::size_t>(rate - rates.begin())));
    }
    for (std::size_t i = 0; i < rates.size(); ++i)
      if (!rates[i].coordinate) add(of_rates[i].name, std::nullopt, i);
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

Json stability_json(const std::optional<study::Stability>& stability) {
  if (!stability) return {};
  const study::Stability& s = *stability;
  return {{"stable", s.unknown.empty() ? Json(s.stable()) : Json()},
          {"growing", s.growing},
          {"growth", s.growth},
          {"dominated_by", s.most},
          {"unheld", s.unheld},
          {"unknown", s.unknown}};
}

}  // namespace

Json equilibrium_json(const study::Configuration& c, const study::Equilibrium& found) {
  Json j;
  j["scene"] = c.prepared().scene.file;
  j["formulation"] = c.prepared().scene.formulation_name;
  if (!c.closing().empty()) j["closing"] = c.closing();
  j.update(steady_json(c.prepared().model(), found.steady, c.kept()));
  Json deflections = Json::object();
  for (const auto& [name, d] : found.deflections) deflections[name] = d;
  j["tip_deflections"] = std::move(deflections);
  j["stays_steady"] = found.stays;
  j["stability"] = stability_json(found.stability);
  j["bent"] = found.bent;
  j["limited"] = found.limited;
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
  const bool grows = found.stability && found.stability->growing > 0;
  std::string text =
      fmt::format("{} in {}: {} after {}{} steps of Newton's method\n\n{}", scene.file, study::formulation_title(scene),
                  found.instant ? "balanced at this instant"
                  : grows       ? "steady but unstable"
                                : "steady",
                  along_forces(found.steady), found.steady.iterations, hinge_table(c, found.steady).str());
  if (c.layout().continuous > 0 || c.sampled()) text += '\n' + state_table(c, found.steady).str();
  if (!found.deflections.empty()) text += '\n' + deflection_table(found).str();
  if (const std::string words = study::against_next_text(found.against, "deflections"); !words.empty())
    text += '\n' + words + '\n';
  if (const std::string words = study::stability_text(found.stability); !words.empty()) text += '\n' + words + '\n';
  if (!found.bent.empty()) text += '\n' + found.bent + '\n';
  if (!found.limited.empty()) text += '\n' + study::at_limits_text(found.limited) + '\n';
  if (found.steady.strayed > 0)
    text += fmt::format(
        "\nA hinge is turned by {:.3g} rad from where it began, and following the forces led to no balance: "
        "there may be others, and nearer ones. --at begins elsewhere.\n",
        found.steady.strayed);
  if (!found.changing.empty()) text += '\n' + found.changing + '\n';
  return text;
}

}  // namespace withy
