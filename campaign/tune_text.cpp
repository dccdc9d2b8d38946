#include <fmt/format.h>

#include <cmath>

#include "withy/campaign/tune_files.hpp"
#include "withy/results/text_table.hpp"
#include "withy/scene/names.hpp"

namespace withy::campaign {
namespace {

std::string parameters_text(const TuneResult& result) {
  TextTable table({"<parameter", "the scene's", "fitted", "standard\ndeviation", "<unit"});
  for (const FittedValue& p : result.parameters) {
    const bool held = p.state == FittedValue::State::undetermined;
    table.add({p.tuned.path, fmt::format("{:.6g}", p.tuned.start), held ? "-" : fmt::format("{:.6g}", p.value),
               p.deviation                               ? fmt::format("{:.2g}", *p.deviation)
               : p.state == FittedValue::State::at_bound ? "at bound"
               : held                                    ? "not known"
                                                         : "-",
               p.tuned.unit});
  }
  return table.str();
}

std::string columns_text(const TuneResult& result) {
  TextTable table({"<column", "values", "rms residual\nbefore", "after", "<unit"});
  for (std::size_t c = 0; c < result.columns.size(); ++c) {
    const ColumnFit& fit = result.columns[c];
    const MeasuredColumn& column = result.data.columns[c];
    table.add({column.name, std::to_string(column.count()),
               fit.at_start.empty() ? "-" : fmt::format("{:.3g}", fit.before), fmt::format("{:.3g}", fit.after),
               column.unit});
  }
  return table.str();
}

/// "1 % more", "0.03 mm less" where the value is 0. \param change of it in per cents
std::string change_text(const FittedValue& p, double change) {
  const char* direction = change > 0 ? "more" : "less";
  if (p.value != 0) return fmt::format("{:.2g} % {}", std::abs(change), direction);
  return fmt::format("{:.2g}{}{} {}", std::abs(change) / 100 * p.tuned.scale, p.tuned.unit.empty() ? "" : " ",
                     p.tuned.unit, direction);
}

/// "1 % more of it does the same as 1 % less of loads.spring.stiffness"; of a negative value, more is further from 0.
std::string sameness_text(const TuneResult& result, const FittedValue& p) {
  if (p.same_as.empty()) return "it has no effect on these columns";
  std::string text;
  for (const auto& [other, factor] : p.same_as)
    text += fmt::format("{}{} of {}", text.empty() ? "" : " and ", change_text(result.parameters[other], factor),
                        result.parameters[other].tuned.path);
  return change_text(p, 1) + " of it does the same as " + text;
}

std::string undetermined_text(const TuneResult& result) {
  std::string text;
  for (const FittedValue& p : result.parameters)
    if (p.state == FittedValue::State::undetermined)
      text += fmt::format(
          "Not determined: {}. To these data {}. It is kept at the scene's value, and the others are "
          "fitted beside it.\n",
          p.tuned.path, sameness_text(result, p));
  for (const FittedValue& p : result.parameters)
    if (p.deviation && *p.deviation > std::abs(p.value))
      text += fmt::format("Hardly determined: {}: its standard deviation is as large as itself.\n", p.tuned.path);
  return text;
}

std::string correlation_text(const TuneResult& result) {
  if (result.correlation.size() < 2) return {};
  std::vector<const FittedValue*> fitted;
  for (const FittedValue& p : result.parameters)
    if (p.state == FittedValue::State::fitted) fitted.push_back(&p);
  std::vector<std::string> head = {"<correlation"};
  for (std::size_t i = 0; i + 1 < fitted.size(); ++i) head.push_back(std::to_string(i + 1));
  TextTable table(head);
  for (std::size_t i = 1; i < fitted.size(); ++i) {
    std::vector<std::string> row = {fmt::format("{}: {}", i + 1, fitted[i]->tuned.path)};
    for (std::size_t j = 0; j + 1 < fitted.size(); ++j)
      row.push_back(j < i ? fmt::format("{:+.3f}", result.correlation[i][j]) : "");
    table.add(row);
  }
  return fmt::format("{}1: {}\n\n", table.str(), fitted[0]->tuned.path);
}

/// Residuals that are no noise.
std::string neighbours_text(const TuneResult& result) {
  std::string text;
  for (std::size_t c = 0; c < result.columns.size(); ++c)
    if (const auto& r = result.columns[c].correlation)
      text += fmt::format(
          "What is left of {} is no noise: neighbouring residuals are correlated by {:.2f}. The model "
          "lacks something, and the standard deviations are too small.\n",
          result.data.columns[c].name, *r);
  return text;
}

std::string search_text(const TuneResult& result) {
  const SearchEnd& best = result.starts.front();
  std::string text = best.converged ? "The search ended where " + best.reason : "The search ended: " + best.reason;
  text += fmt::format(". Weighted residual {:.4g}", result.after);
  if (result.before > 0) text += fmt::format(", of the scene's values {:.4g}", result.before);
  text += fmt::format("; {} runs", result.runs);
  if (result.failed > 0) text += fmt::format(", {} of which failed, the last: {}", result.failed, result.last_failure);
  text += ".\n";
  if (result.starts.size() < 2)
    return text + "One start: whether another minimum lies lower is not known; --starts 10 looks.\n";
  text += fmt::format("{} of {} starts came to this {}", result.agreeing, result.starts.size(),
                      best.converged ? "minimum" : "point");
  for (const SearchEnd& s : result.starts) {
    // Residuals of rounding differ by themselves.
    if (s.agrees || !std::isfinite(s.residual) || s.residual <= 1.01 * best.residual) continue;
    if (best.residual == 0) return text + fmt::format("; the next lowest has a residual of {:.3g}.\n", s.residual);
    return text + fmt::format("; the next lowest has a residual {:.3g} times as large.\n", s.residual / best.residual);
  }
  return text + ".\n";
}

}  // namespace

std::string interrupted_text(const TuneResult& result) {
  if (!result.nearest) return {};
  std::string text = fmt::format("nearest to the data of {} run{}, with a weighted residual of {:.4g}", result.runs,
                                 result.runs == 1 ? "" : "s", result.nearest->residual);
  if (result.before > 0) text += fmt::format(" ({:.4g} with the scene's values)", result.before);
  text += ", came";
  for (const std::string& setting : result.nearest->settings) text += fmt::format(" --set '{}'", setting);
  return text;
}

std::string tune_text(const TuneResult& result, const std::string& title) {
  const Measured& data = result.data;
  std::string text = fmt::format("{}: {} values of {} column{} in {}, t = {:g} to {:g} s\n\n", title, data.count(),
                                 data.columns.size(), data.columns.size() == 1 ? "" : "s", data.file,
                                 data.times.front(), data.times.back());
  text += parameters_text(result) + '\n' + columns_text(result) + '\n' + correlation_text(result);
  text += undetermined_text(result) + neighbours_text(result) + search_text(result);
  if (!data.ignored.empty()) text += "Columns left out: " + listed(data.ignored) + ".\n";
  return text;
}

}  // namespace withy::campaign
