#include "withy/campaign/sweep_page.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "withy/campaign/store.hpp"
#include "withy/results/csv.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/scene/units.hpp"

namespace withy::campaign {
namespace {

using Json = nlohmann::ordered_json;
using Cells = std::vector<std::string>;

constexpr std::size_t most_rows = 1000;                ///< whole cases on the page
constexpr std::size_t most_outputs_shown = 8'000'000;  ///< in memory
constexpr std::size_t most_failures = 200;             ///< of them on the page
constexpr std::size_t bins = 24;                       ///< of a histogram
constexpr std::size_t most_levels_shown = 12;          ///< of an envelope
constexpr std::size_t most_envelopes = 120;            ///< pairs of what varies and a result
constexpr std::size_t most_histories = 60;             ///< pairs of a point of the grids and a result over time

/// The lines of a table behind its head. Texts in quotes may hold ends of lines.
void read_rows(const std::filesystem::path& file, const std::function<void(const Cells&)>& take) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::system_error(errno, std::generic_category(), file.string());
  std::string line, more;
  while (std::getline(in, line)) {
    while (std::count(line.begin(), line.end(), '"') % 2 == 1 && std::getline(in, more)) line += '\n' + more;
    take(csv_cells(line));
  }
}

Json table_json(const std::filesystem::path& file) {
  Json table;
  read_rows(file, [&](const Cells& cells) {
    if (table.is_null())
      table = {{"head", cells}, {"rows", Json::array()}};
    else
      table["rows"].push_back(cells);
  });
  return table;
}

double nothing() { return std::numeric_limits<double>::quiet_NaN(); }

/// The quantile of sorted numbers, between its neighbours linearly.
double quantile(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const double rest = at - static_cast<double>(below);
  return below + 1 < sorted.size() ? sorted[below] + rest * (sorted[below + 1] - sorted[below]) : sorted[below];
}

/// The numbers of a column case by case, NaN where there is none.
struct Numbers {
  std::string name;
  bool result = false;
  bool numeric = true;
  std::vector<double> all;

  [[nodiscard]] std::vector<double> sorted() const {
    std::vector<double> known;
    std::copy_if(all.begin(), all.end(), std::back_inserter(known), [](double x) { return std::isfinite(x); });
    std::sort(known.begin(), known.end());
    return known;
  }
};

Json column_json(const Numbers& column) {
  const std::vector<double> sorted = column.sorted();
  Json j{{"name", column.name}, {"role", column.result ? "result" : "varied"}};
  j["numeric"] = column.numeric && !sorted.empty() && (column.result || sorted.front() < sorted.back());
  if (!j["numeric"]) return j;
  const double least = sorted.front(), width = (sorted.back() - least) / static_cast<double>(bins);
  std::vector<std::size_t> counts(bins);
  for (const double x : sorted)
    ++counts[width > 0 ? std::min(static_cast<std::size_t>((x - least) / width), bins - 1) : bins / 2];
  j.update({{"least", least},
            {"greatest", sorted.back()},
            {"p05", quantile(sorted, 0.05)},
            {"median", quantile(sorted, 0.5)},
            {"p95", quantile(sorted, 0.95)},
            {"bins", counts}});
  return j;
}

Json level_json(double at, std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {{"at", at},
          {"count", values.size()},
          {"least", values.front()},
          {"p05", quantile(values, 0.05)},
          {"median", quantile(values, 0.5)},
          {"p95", quantile(values, 0.95)},
          {"greatest", values.back()}};
}

/// A result over what varies: at each of its values, or where these are many over equal stretches of it, told at their
/// middles.
Json envelope_json(const Numbers& axis, const Numbers& result) {
  std::vector<double> places = axis.sorted();
  if (places.empty()) return {};
  const double least = places.front(), width = (places.back() - least) / static_cast<double>(most_levels_shown);
  places.erase(std::unique(places.begin(), places.end()), places.end());
  const bool few = places.size() <= most_levels_shown;
  if (!few) {
    places.resize(most_levels_shown);
    for (std::size_t k = 0; k < most_levels_shown; ++k) places[k] = least + (static_cast<double>(k) + 0.5) * width;
  }
  std::vector<std::vector<double>> values(places.size());
  for (std::size_t i = 0; i < axis.all.size(); ++i) {
    const double x = axis.all[i], y = result.all[i];
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    const std::size_t k =
        few ? static_cast<std::size_t>(std::lower_bound(places.begin(), places.end(), x) - places.begin())
            : std::min(static_cast<std::size_t>((x - least) / width), most_levels_shown - 1);
    values[k].push_back(y);
  }
  Json levels = Json::array();
  for (std::size_t k = 0; k < places.size(); ++k)
    if (!values[k].empty()) levels.push_back(level_json(places[k], std::move(values[k])));
  return levels;
}

class Page {
 public:
  Page(std::filesystem::path store, const Collected& collected)
      : store_(std::move(store)), collected_(collected), about_(read_description(store_)) {}

  Json json() {
    read_cases();
    Json page{{"plan", about_.plan},
              {"cases", collected_.cases},
              {"done", collected_.done},
              {"failed", collected_.failed},
              {"failed_share",
               {{"value", collected_.failed_share.value},
                {"low", collected_.failed_share.low},
                {"high", collected_.failed_share.high}}},
              {"counted_every", counted_every()},
              {"columns", Json::array()}};
    for (const Numbers& column : columns_) page["columns"].push_back(column_json(column));
    page["envelopes"] = envelopes();
    page["sample"] = {{"every", shown_every()}, {"rows", std::move(sample_)}};
    if (collected_.statistics) page["statistics"] = table_json(store_ / "statistics.csv");
    if (collected_.indices) page["indices"] = table_json(store_ / "indices.csv");
    if (collected_.histories) page["histories"] = histories();
    page["failures"] = failures();
    return page;
  }

 private:
  /// Of so many cases one is counted, and one of these shown whole.
  [[nodiscard]] std::size_t counted_every() const {
    const std::size_t numbers =
        collected_.cases * (about_.paths.size() + about_.derived.size() + about_.columns.size());
    return std::max<std::size_t>(1, (numbers + most_outputs_shown - 1) / most_outputs_shown);
  }
  [[nodiscard]] std::size_t shown_every() const {
    const std::size_t counted = counted_every(), step = most_rows * counted;
    return counted * std::max<std::size_t>(1, (collected_.cases + step - 1) / step);
  }

  void read_cases() {
    std::size_t row = 0;
    const std::size_t varied = about_.paths.size() + about_.derived.size();
    read_rows(store_ / "table.csv", [&](const Cells& cells) {
      if (row++ == 0) {
        for (std::size_t c = 2; c < cells.size(); ++c) columns_.push_back({cells[c], c - 2 >= varied, true, {}});
        return;
      }
      if ((row - 2) % counted_every() != 0) return;
      Json values = Json::array();
      for (std::size_t c = 0; c < columns_.size(); ++c) {
        const std::optional<double> number = plain_number(cells[c + 2]);
        columns_[c].numeric = columns_[c].numeric && (number || cells[c + 2].empty());
        // What varies counts where the case has results.
        columns_[c].all.push_back(number && cells[1] == "completed" ? *number : nothing());
        values.push_back(number ? Json(*number) : cells[c + 2].empty() ? Json() : Json(cells[c + 2]));
      }
      if ((row - 2) % shown_every() == 0 && cells[1] != "missing")
        sample_.push_back({{"case", plain_number(cells[0]).value_or(0)}, {"status", cells[1]}, {"values", values}});
    });
  }

  Json envelopes() {
    Json all = Json::object();
    std::size_t count = 0;
    for (const Numbers& axis : columns_) {
      if (axis.result || !axis.numeric) continue;
      for (const Numbers& result : columns_)
        if (result.result && count++ < most_envelopes) all[axis.name][result.name] = envelope_json(axis, result);
    }
    return all;
  }

  /// For each result and point of the grids: times, and percentiles over the cases at each of them, which are null
  /// where no case has come to it.
  Json histories() const {
    Json list = Json::array();
    const std::size_t times = about_.paths.size() + 2;  // the column of the time
    bool head = true;
    read_rows(store_ / "histories.csv", [&](const Cells& cells) {
      if (std::exchange(head, false)) return;
      const std::string &name = cells.at(times - 1), &point = cells.at(0);
      if (list.empty() || list.back()["name"] != name || list.back()["point"] != point) {
        if (list.size() == most_histories) return;
        Json of = Json::object();
        for (std::size_t a = 0; a < about_.paths.size(); ++a)
          if (!cells.at(1 + a).empty()) of[about_.paths[a]] = cells[1 + a];
        list.push_back({{"name", name}, {"point", point}, {"of", of}, {"rows", Json::array()}});
      }
      Json row = Json::array();
      for (std::size_t c = times; c < cells.size(); ++c) {
        const std::optional<double> number = plain_number(cells[c]);
        row.push_back(number ? Json(*number) : Json());
      }
      list.back()["rows"].push_back(std::move(row));
    });
    return list;
  }

  Json failures() const {
    Json list = Json::array();
    bool head = true;
    read_rows(store_ / "failed.csv", [&](const Cells& cells) {
      if (!std::exchange(head, false) && list.size() < most_failures)
        list.push_back({{"case", plain_number(cells.at(0)).value_or(0)},
                        {"status", cells.at(1)},
                        {"message", cells.at(2)},
                        {"command", cells.at(3)}});
    });
    return list;
  }

  std::filesystem::path store_;
  const Collected& collected_;
  StoreDescription about_;
  std::vector<Numbers> columns_;
  Json sample_ = Json::array();
};

}  // namespace

Json sweep_page(const std::filesystem::path& store, const Collected& collected) {
  return Page(store, collected).json();
}

void write_sweep_page(const std::filesystem::path& store, const Collected& collected) {
  if (!has_report_page()) return;
  const StoreDescription about = read_description(store);
  const std::string title = about.name.empty() ? std::filesystem::path(about.plan).filename().string() : about.name;
  write_study_page(store / report_name, "sweep", title, sweep_page(store, collected));
}

}  // namespace withy::campaign
