#include "withy/campaign/case_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "withy/campaign/derived.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/run_command.hpp"
#include "withy/results/text_table.hpp"
#include "withy/study/point.hpp"

namespace withy::campaign {
namespace {

using Json = nlohmann::ordered_json;

/// The run of the case by itself, with all its results.
std::string run_command_of(const Plan& plan, const SceneValues& scene, const CaseValues& values) {
  std::string text = command_with("withy run", scene.file(), plan.plugin_folders);
  const auto add = [&](const std::string& path, const Value& value) {
    text += " --set " + quoted(study::Change{path, value}.text());
  };
  for (const auto& [path, value] : plan.set) add(path, value);
  const std::vector<std::string> paths = varied_paths(plan);
  for (std::size_t a = 0; a < values.size(); ++a)
    if (values[a] && (values[a]->kind() != Value::Kind::null || scene.find(paths[a]) != nullptr))
      add(paths[a], *values[a]);
  return text;
}

Json finite_or_null(double x) { return std::isfinite(x) ? Json(x) : Json(); }

/// \param numbers of Histories
Json histories_json(const Plan& plan, std::span<const double> numbers) {
  const std::vector<double>& times = plan.history.times;
  Json j = {{"t[s]", times}};
  for (const std::string& name : history_columns(plan)) {
    Json& column = j[name] = Json::array();
    for (const double x : numbers.first(times.size())) column.push_back(finite_or_null(x));
    numbers = numbers.subspan(times.size());
  }
  return j;
}

}  // namespace

Json case_json(const Plan& plan, const CaseResult& result) {
  Json j = {{"case", result.index},
            {"status", result.status},
            {"message", result.message},
            {"values", Json::object()},
            {"results", Json::object()}};
  const std::vector<std::string> paths = varied_paths(plan), columns = kept_columns(plan);
  for (std::size_t a = 0; a < result.values.size(); ++a)
    if (const auto& value = result.values[a]) j["values"][paths[a]] = value_json(*value);
  if (result.completed()) {
    for (std::size_t i = 0; i < columns.size(); ++i) j["results"][columns[i]] = finite_or_null(result.numbers.at(i));
    if (!plan.history.of.empty())
      j["histories"] = histories_json(plan, std::span(result.numbers).subspan(columns.size()));
  }
  j["command"] = run_command_of(plan, plan.base->values, result.values);
  return j;
}

std::string case_text(const Json& j) {
  TextTable table({"<of the case", "value"});
  for (const char* part : {"values", "results"})
    for (const auto& [name, value] : j.at(part).items()) table.add({name, plain_text(value)});
  if (j.contains("histories"))
    table.add({"over time", fmt::format("{} columns at {} times, with --json", j["histories"].size() - 1,
                                        j["histories"]["t[s]"].size())});
  return fmt::format("case {}: {}\n\n{}\nThe same run with all its results:\n  {}\n", j.at("case").dump(),
                     j.at("status").get<std::string>(), table.str(), j.at("command").get<std::string>());
}

}  // namespace withy::campaign
