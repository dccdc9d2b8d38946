#include "withy/campaign/sweep_page.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include "withy/campaign/estimates.hpp"
#include "withy/campaign/random.hpp"
#include "withy/campaign/store.hpp"
#include "withy/results/csv.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/scene/csv_rows.hpp"
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

/// The numbers of a column case by case, NaN where there is none.
struct Numbers {
  std::string name;
  bool result = false;
  bool numeric = true;
  std::vector<double> all;

  [[nodiscard]] std::vector<double> known() const {
    std::vector<double> finite;
    std::copy_if(all.begin(), all.end(), std::back_inserter(finite), [](double x) { return std::isfinite(x); });
    return finite;
  }
};

/// Of numbers of which there is one at least: their ends, and what lies between.
void add_spread(std::vector<double> values, Json& j) {
  constexpr double shares[] = {0, 0.05, 0.5, 0.95, 1};
  const std::vector<double> at = percentiles(std::move(values), shares);
  j.update({{"least", at[0]}, {"p05", at[1]}, {"median", at[2]}, {"p95", at[3]}, {"greatest", at[4]}});
}

Json column_json(const Numbers& column) {
  std::vector<double> known = column.known();
  Json j{{"name", column.name}, {"role", column.result ? "result" : "varied"}};
  j["numeric"] = false;
  if (!column.numeric || known.empty()) return j;
  const auto [low, high] = std::minmax_element(known.begin(), known.end());
  const double least = *low, width = (*high - least) / static_cast<double>(bins);
  j["numeric"] = column.result || *low < *high;
  if (!j["numeric"]) return j;
  std::vector<std::size_t> counts(bins);
  for (const double x : known)
    ++counts[width > 0 ? std::min(static_cast<std::size_t>((x - least) / width), bins - 1) : bins / 2];
  add_spread(std::move(known), j);
  j["bins"] = counts;
  return j;
}

/// Where envelopes over a column are told: at each of its values, or where these are many at the middles of equal
/// stretches of it.
class Levels {
 public:
  explicit Levels(const Numbers& axis) {
    const std::vector<double> known = axis.known();
    std::set<double> some;
    for (auto x = known.begin(); x != known.end() && some.size() <= most_levels_shown; ++x) some.insert(*x);
    few_ = some.size() <= most_levels_shown;
    places_.assign(some.begin(), some.end());
    if (few_) return;
    const auto [low, high] = std::minmax_element(known.begin(), known.end());
    least_ = *low, width_ = (*high - least_) / static_cast<double>(most_levels_shown);
    places_.resize(most_levels_shown);
    for (std::size_t k = 0; k < places_.size(); ++k) places_[k] = least_ + (static_cast<double>(k) + 0.5) * width_;
  }
  [[nodiscard]] const std::vector<double>& places() const { return places_; }
  /// Index of that of a value of the column.
  [[nodiscard]] std::size_t of(double x) const {
    if (few_) return static_cast<std::size_t>(std::lower_bound(places_.begin(), places_.end(), x) - places_.begin());
    return std::min(static_cast<std::size_t>((x - least_) / width_), most_levels_shown - 1);
  }

 private:
  bool few_ = false;
  std::vector<double> places_;
  double least_ = 0, width_ = 0;
};

/// A result over what varies.
Json envelope_json(const Numbers& axis, const Levels& levels, const Numbers& result) {
  std::vector<std::vector<double>> values(levels.places().size());
  for (std::size_t i = 0; i < axis.all.size(); ++i) {
    const double x = axis.all[i], y = result.all[i];
    if (std::isfinite(x) && std::isfinite(y)) values[levels.of(x)].push_back(y);
  }
  Json list = Json::array();
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (values[k].empty()) continue;
    Json level{{"at", levels.places()[k]}, {"count", values[k].size()}};
    add_spread(std::move(values[k]), level);
    list.push_back(std::move(level));
  }
  return list;
}

class Page {
 public:
  Page(std::filesystem::path store, const Collected& collected)
      : store_(std::move(store)), collected_(collected), about_(read_description(store_)) {
    const std::size_t columns = about_.paths.size() + about_.derived.size() + about_.columns.size();
    counted_ = std::min<std::uint64_t>(collected_.cases, most_outputs_shown / std::max<std::size_t>(1, columns));
    shown_ = std::min<std::uint64_t>(counted_, most_rows);
  }

  Json json() {
    read_cases();
    Json page{{"command", case_command(about_)},
              {"cases", collected_.cases},
              {"done", collected_.done},
              {"failed", collected_.failed},
              {"failed_share",
               {{"value", collected_.failed_share.value},
                {"low", collected_.failed_share.low},
                {"high", collected_.failed_share.high}}},
              {"counted", counted_},
              {"columns", Json::array()}};
    for (const Numbers& column : columns_) page["columns"].push_back(column_json(column));
    page["envelopes"] = envelopes();
    page["envelopes_in_all"] = envelopes_;
    page["sample"] = {{"of", collected_.cases}, {"most", shown_}, {"rows", std::move(sample_)}};
    if (collected_.statistics) page["statistics"] = table_json(store_ / "statistics.csv");
    if (collected_.indices) page["indices"] = table_json(store_ / "indices.csv");
    if (collected_.histories) page["histories"] = histories();
    page["histories_in_all"] = histories_;
    page["failures"] = failures();
    return page;
  }

 private:
  /// Where a case comes in a random order of all. Every so many cases in the order of the plan would be those of one
  /// level of a grid, where their number and that of levels or draws have a factor in common.
  [[nodiscard]] std::uint64_t order_of(std::uint64_t index) const { return permuted(key_, index, collected_.cases); }

  void read_cases() {
    std::uint64_t row = 0;
    const std::size_t varied = about_.paths.size() + about_.derived.size();
    read_rows(store_ / "table.csv", [&](const Cells& cells) {
      if (row++ == 0) {
        for (std::size_t c = 2; c < cells.size(); ++c) columns_.push_back({cells[c], c - 2 >= varied, true, {}});
        return;
      }
      const std::uint64_t order = order_of(row - 2);
      if (order >= counted_) return;
      const bool shown = order < shown_ && cells[1] != "missing";
      Json values = Json::array();
      for (std::size_t c = 0; c < columns_.size(); ++c) {
        const std::optional<double> number = plain_number(cells[c + 2]);
        columns_[c].numeric = columns_[c].numeric && (number || cells[c + 2].empty());
        // What varies counts where the case has results.
        columns_[c].all.push_back(number && cells[1] == "completed" ? *number : nothing());
        if (shown) values.push_back(number ? Json(*number) : cells[c + 2].empty() ? Json() : Json(cells[c + 2]));
      }
      if (shown)
        sample_.push_back({{"case", plain_number(cells[0]).value_or(0)}, {"status", cells[1]}, {"values", values}});
    });
  }

  Json envelopes() {
    Json all = Json::object();
    for (const Numbers& axis : columns_) {
      if (axis.result || !axis.numeric) continue;
      const Levels levels(axis);
      for (const Numbers& result : columns_)
        if (result.result && envelopes_++ < most_envelopes)
          all[axis.name][result.name] = envelope_json(axis, levels, result);
    }
    return all;
  }

  /// For each result and point of the grids: times, and percentiles over the cases at each of them, which are null
  /// where no case has come to it.
  Json histories() {
    Json list = Json::array();
    const std::size_t times = about_.paths.size() + 2;  // the column of the time
    bool head = true;
    read_rows(store_ / "histories.csv", [&](const Cells& cells) {
      if (std::exchange(head, false)) return;
      const std::string &name = cells.at(times - 1), &point = cells.at(0);
      if (std::string place = point + ' ' + name; place != last_history_) {
        last_history_ = std::move(place);
        if (++histories_ > most_histories) return;  // they are counted all the same
        Json of = Json::object();
        for (std::size_t a = 0; a < about_.paths.size(); ++a)
          if (!cells.at(1 + a).empty()) of[about_.paths[a]] = cells[1 + a];
        list.push_back({{"name", name}, {"point", point}, {"of", of}, {"rows", Json::array()}});
      }
      if (histories_ > most_histories) return;
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
  Key key_ = Key(0)["page"];
  std::uint64_t counted_ = 0, shown_ = 0;  ///< cases that figures count, and of these those that are shown whole
  std::vector<Numbers> columns_;
  std::size_t envelopes_ = 0, histories_ = 0;  ///< that there are, on the page or not
  std::string last_history_;                   ///< its point and its result
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
