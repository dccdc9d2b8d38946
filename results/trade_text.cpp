#include "withy/results/trade_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "withy/results/formulation_words.hpp"
#include "withy/results/text_table.hpp"
#include "withy/results/trade_files.hpp"

namespace withy {
namespace {

std::string points_text(const std::vector<study::TradeResult>& results, const std::vector<bool>& front,
                        const study::Outputs& outputs) {
  const auto any = [&](auto&& has) { return std::any_of(results.begin(), results.end(), has); };
  const bool families = any([](const study::TradeResult& r) { return !r.point.family.empty(); });
  const bool overs = any([](const study::TradeResult& r) { return !r.point.over.empty(); });
  const bool hinges = measures_hinges(outputs), tips = measures_tips(outputs);
  std::vector<std::string> head = {"<", "<formulation", "modes"};
  if (families) head.emplace_back("<family");
  if (overs) head.emplace_back("<over");
  for (const char* h :
       {"<integrator", "tolerance", "<outcome", "hinge\nerror", "tip error\n[mm]", "error\n[%]", "steps", "CPU\n[ms]"})
    head.emplace_back(h);
  TextTable table(head);
  for (std::size_t i = 0; i < results.size(); ++i) {
    const study::TradeResult& r = results[i];
    std::vector<std::string> row = {front[i] ? "*" : "", r.point.formulation,
                                    r.point.modes > 0 ? std::to_string(r.point.modes) : "-"};
    if (families) row.push_back(r.point.family.empty() ? "scene's" : r.point.family);
    if (overs) row.push_back(trade_over_text(r.point));
    row.push_back(r.point.integrator);
    row.push_back(fmt::format("{:g}", r.point.tolerance));
    row.push_back(r.status);
    if (r.completed()) {
      for (std::string& cell : std::vector<std::string>{
               hinges ? fmt::format("{:.3g}", r.hinge_error) : "-",
               tips ? fmt::format("{:.3g}", 1e3 * r.tip_error) : "-", fmt::format("{:.3g}", 100 * r.relative_error),
               std::to_string(r.steps), fmt::format("{:.2f}", 1e3 * r.cpu_seconds)})
        row.push_back(std::move(cell));
    } else {
      row.insert(row.end(), 5, "-");
    }
    table.add(std::move(row));
  }
  return table.str();
}

/// Reasons of the points that failed, each said once.
std::string failures_text(const std::vector<study::TradeResult>& results) {
  std::map<std::string, std::pair<std::string, std::size_t>> reasons;  // by formulation, integrator and status
  for (const study::TradeResult& r : results) {
    if (r.completed()) continue;
    auto& [text, count] = reasons[r.point.formulation + ' ' + r.point.integrator + ' ' + r.status];
    if (text.empty()) text = r.point.text() + ": " + r.message;
    ++count;
  }
  std::string out;
  for (const auto& [key, reason] : reasons) {
    out += "\n" + reason.first;
    if (reason.second > 1) out += fmt::format(" ({} more like it)", reason.second - 1);
    out += '\n';
  }
  return out;
}

std::vector<std::string> formulations_of(const std::vector<study::TradeResult>& results) {
  std::vector<std::string> names;
  for (const study::TradeResult& r : results) names.push_back(r.point.formulation);
  return names;
}

std::string references_text(const study::TradeStudy& study) {
  std::string out;
  for (const auto& [over, r] : study.references()) {
    study::Point point = r.point;
    point.over.clear();
    out += fmt::format(
        "Reference{}: {}; what it may be off by, from what the last modes and ten times the tolerance changed: "
        "{}{}{:.2g} %.\n",
        over.empty() ? "" : " at " + over, point.text(),
        measures_hinges(study.outputs()) ? fmt::format("hinges {:.2g}, ", r.hinge_error) : "",
        measures_tips(study.outputs()) ? fmt::format("tips {:.2g} mm, ", 1e3 * r.tip_error) : "",
        100 * r.relative_error);
  }
  return out;
}

}  // namespace

std::string trade_text(const std::string& title, const study::TradeStudy& study,
                       const std::vector<study::TradeResult>& results, const std::vector<bool>& front,
                       Registry& registry, const std::vector<double>& shares) {
  return title + "\n\n" + cheapest_text(results, shares) + points_text(results, front, study.outputs()) +
         "\n*: no other point is both more accurate, as far as the reference can tell, and cheaper. Error "
         "in % of each output's own range, the greatest of all.\n" +
         references_text(study) + formulation_words(formulations_of(results), registry) + failures_text(results);
}

}  // namespace withy
