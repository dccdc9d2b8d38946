#include "withy/campaign/collect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <system_error>

#include "withy/campaign/cases.hpp"
#include "withy/campaign/histories_picture.hpp"
#include "withy/campaign/own_part.hpp"
#include "withy/results/csv.hpp"
#include "withy/results/output_file.hpp"

namespace withy::campaign {
namespace {

constexpr std::size_t most_numbers = 8'000'000;  // in memory

/// A file that takes its name when it is whole.
class Table {
 public:
  /// Each process has a part of its own: two may collect at once.
  explicit Table(std::filesystem::path path) : path_(std::move(path)), part_(own_part(path_)), file_(part_) {
    clear_parts(path_);
  }
  /// What is not finished is cleared away: it would hold the space that there was too little of.
  ~Table() {
    std::error_code ignored;
    if (!finished_) std::filesystem::remove(part_, ignored);
  }
  Table(const Table&) = delete;
  Table& operator=(const Table&) = delete;
  void line(const std::string& text) { file_.write(text + '\n'); }
  void finish() {
    file_.close();
    std::filesystem::rename(part_, path_);
    finished_ = true;
  }

 private:
  std::filesystem::path path_, part_;
  OutputFile file_;
  bool finished_ = false;
};

/// Empty where the scene's own value stays, "null" where it is taken away.
std::string cell(const std::optional<Value>& value) {
  if (!value) return "";
  if (value->kind() == Value::Kind::number) return fmt::format("{}", value->number());
  return value->kind() == Value::Kind::null ? "null" : csv_text(value->text());
}

/// Empty where a result is not finite, as in results.csv.
std::string result_cell(double x) { return std::isfinite(x) ? fmt::format("{}", x) : std::string(); }

std::string joined(const std::vector<std::string>& cells) {
  std::string text;
  for (const std::string& c : cells) text += (text.empty() ? "" : ",") + csv_text(c);
  return text;
}

/// The value and the ends of its interval; nothing for an end that is not known.
std::string cells_of(const Estimate& e) {
  const auto end = [](double x) { return std::isfinite(x) ? fmt::format(",{}", x) : std::string(","); };
  return fmt::format("{}", e.value) + end(e.low) + end(e.high);
}

class Collector {
 public:
  Collector(const std::filesystem::path& store)
      : store_(store), about_(read_description(store)), index_(store, about_) {}

  Collected collect() {
    Collected all{about_.size, index_.done(), index_.failed(), index_.lost(), false, false, false, {}};
    if (all.done > 0) all.failed_share = share(all.failed, all.done);
    write_rows();
    all.statistics = about_.by_draws() && !about_.columns.empty();
    remove_unless(all.statistics, "statistics.csv");
    if (all.statistics) write_statistics();
    all.histories = !about_.histories.empty();
    remove_unless(all.histories, "histories.csv");
    remove_unless(all.histories, "histories.svg");
    if (all.histories) write_histories();
    all.indices = about_.design != Design::product && !about_.columns.empty();
    remove_unless(all.indices, "indices.csv");
    if (about_.design == Design::one_at_a_time && all.indices) write_differences();
    if (about_.design == Design::morris && all.indices) write_morris();
    if (about_.design == Design::saltelli && all.indices) write_sobol();
    return all;
  }

 private:
  void remove_unless(bool kept, const char* name) const {
    if (!kept) std::filesystem::remove(store_ / name);
  }

  void write_rows() {
    Table table(store_ / "table.csv"), failed(store_ / "failed.csv");
    std::vector<std::string> head = {"case", "status"};
    head.insert(head.end(), about_.paths.begin(), about_.paths.end());
    head.insert(head.end(), about_.derived.begin(), about_.derived.end());
    head.insert(head.end(), about_.columns.begin(), about_.columns.end());
    table.line(joined(head));
    failed.line("case,status,message,command");
    for (std::uint64_t i = 0; i < about_.size; ++i) {
      const auto result = index_.read(i);
      std::string row = fmt::format("{},{}", i, result ? result->status : "missing");
      for (std::size_t a = 0; a < about_.paths.size() + about_.derived.size(); ++a)
        row += ',' + (result ? cell(result->values.at(a)) : "");
      for (std::size_t c = 0; c < about_.columns.size(); ++c)
        row += ',' + (result && result->completed() ? result_cell(result->numbers.at(c)) : "");
      table.line(row);
      if (result && !result->completed())
        failed.line(fmt::format("{},{},{},{}", i, result->status, csv_text(result->message), csv_text(repeat_of(i))));
    }
    table.finish();
    failed.finish();
  }

  /// The command that runs a case alone.
  std::string repeat_of(std::uint64_t index) const { return case_command(about_) + fmt::format(" {}", index); }

  /// Some of the numbers of the completed cases among these, where they are finite.
  std::vector<std::vector<double>> samples(std::uint64_t begin, std::uint64_t end, std::size_t first,
                                           std::size_t count) {
    std::vector<std::vector<double>> all(count);
    for (std::uint64_t i = begin; i < end; ++i) {
      const auto result = index_.read(i);
      if (!result || !result->completed()) continue;
      for (std::size_t c = 0; c < count; ++c)
        if (const double x = result->numbers.at(first + c); std::isfinite(x)) all[c].push_back(x);
    }
    return all;
  }

  /// The values that all cases of a point share; nothing for those that are drawn, and where no case of the point has
  /// run.
  CaseValues point_values(std::uint64_t point) {
    std::vector<CaseResult> some;
    for (std::uint64_t i = point * about_.draws; i < (point + 1) * about_.draws && some.size() < 2; ++i)
      if (auto result = index_.read(i)) some.push_back(std::move(*result));
    CaseValues values(about_.paths.size());
    for (std::size_t a = 0; a < values.size() && !some.empty(); ++a) {
      const std::optional<Value>& value = some.front().values.at(a);
      // Stores of earlier versions do not say what is drawn: there two cases tell it.
      const bool shared = about_.shared.empty() ? some.size() == 2 && cell(value) == cell(some.back().values.at(a))
                                                : about_.shared.at(a);
      if (shared) values[a] = value;
    }
    return values;
  }

  /// ",0.5,".
  static std::string point_cells(const CaseValues& values) {
    std::string text;
    for (const std::optional<Value>& value : values) text += ',' + cell(value);
    return text;
  }

  void write_statistics() {
    Table table(store_ / "statistics.csv");
    table.line("point," + joined(about_.paths) +
               ",result,cases,mean,mean.low,mean.high,deviation,least,greatest,p05,p05.low,p05.high,median,median.low,"
               "median.high,p95,p95.low,p95.high");
    const std::size_t at_once = std::clamp<std::size_t>(most_numbers / about_.draws, 1, about_.columns.size());
    for (std::uint64_t point = 0; point < about_.size / about_.draws; ++point) {
      const std::string where = fmt::format("{}{}", point, point_cells(point_values(point)));
      for (std::size_t first = 0; first < about_.columns.size(); first += at_once) {
        auto columns = samples(point * about_.draws, (point + 1) * about_.draws, first,
                               std::min(at_once, about_.columns.size() - first));
        for (std::size_t c = 0; c < columns.size(); ++c)
          table.line(where + ',' + csv_text(about_.columns[first + c]) + ',' + statistics_cells(std::move(columns[c])));
      }
    }
    table.finish();
  }

  static std::string statistics_cells(std::vector<double> sample) {
    if (sample.empty()) return "0,,,,,,,,,,,,,,,";
    const Statistics s = statistics(std::move(sample));
    std::string text = fmt::format("{},{},", s.count, s.mean);
    text += s.mean_interval ? fmt::format("{},{},", s.mean_interval->low, s.mean_interval->high) : ",,";
    text += fmt::format("{},{},{}", s.deviation, s.least, s.greatest);
    for (const Estimate& q : s.quantiles) text += ',' + cells_of(q);
    return text;
  }

  /// Percentiles at each time: over the draws of each point of the grids, or over all cases where nothing is drawn.
  void write_histories() {
    Table table(store_ / "histories.csv");
    table.line("point," + joined(about_.paths) + ",result,t[s],cases,least,p05,p25,median,p75,p95,greatest");
    HistoriesPicture picture(about_.name.empty() ? about_.plan : about_.name);
    const std::uint64_t group = about_.by_draws() ? about_.draws : about_.size;
    const std::size_t times = about_.times.size(), count = times * about_.histories.size();
    const std::size_t at_once = std::clamp<std::size_t>(most_numbers / group, 1, count);
    for (std::uint64_t point = 0; point < about_.size / group; ++point) {
      const CaseValues shared = about_.by_draws() ? point_values(point) : CaseValues(about_.paths.size());
      const std::string values = point_cells(shared), title = title_of_point(about_.paths, shared);
      for (std::size_t first = 0; first < count; first += at_once) {
        auto all = samples(point * group, (point + 1) * group, about_.columns.size() + first,
                           std::min(at_once, count - first));
        for (std::size_t k = 0; k < all.size(); ++k) {
          const std::string& name = about_.histories[(first + k) / times];
          const double t = about_.times[(first + k) % times];
          const std::size_t cases = all[k].size();
          std::vector<double> shown;
          if (cases > 0) shown = percentiles(std::move(all[k]), shares_of_histories);
          std::string line = fmt::format("{}{},{},{},{}", point, values, csv_text(name), t, cases);
          for (std::size_t p = 0; p < shares_of_histories.size(); ++p)
            line += shown.empty() ? "," : fmt::format(",{}", shown[p]);
          table.line(line);
          if (!shown.empty()) picture.add(point, title, name, t, shown);
        }
      }
    }
    table.finish();
    write_lasting_file(store_ / "histories.svg", picture.svg());
  }

  void write_differences() {
    Table table(store_ / "indices.csv");
    table.line("result,parameter,value,at,difference");
    const auto base = index_.read(0);
    for (std::size_t c = 0; c < about_.columns.size(); ++c)
      for (std::uint64_t i = 1; i < about_.size; ++i) {
        const auto result = index_.read(i);
        if (!result || !base || !base->completed() || !result->completed()) continue;
        const double at = result->numbers.at(c), difference = at - base->numbers.at(c);
        if (!std::isfinite(difference)) continue;
        for (std::size_t a = 0; a < about_.paths.size(); ++a)
          if (result->values.at(a))
            table.line(fmt::format("{},{},{},{},{}", csv_text(about_.columns[c]), csv_text(about_.paths[a]),
                                   cell(result->values[a]), at, difference));
      }
    table.finish();
  }

  /// The results of a block of cases that belong together; nothing where one is missing or failed.
  std::vector<CaseResult> block(std::uint64_t number, std::size_t size) {
    std::vector<CaseResult> all;
    for (std::uint64_t i = number * size; i < (number + 1) * size; ++i) {
      auto result = index_.read(i);
      if (!result || !result->completed()) return {};
      all.push_back(std::move(*result));
    }
    return all;
  }

  void write_morris() {
    Table table(store_ / "indices.csv");
    table.line("result,parameter,mu,mu_star,mu_star.low,mu_star.high,sigma,trajectories");
    Plan plan;
    plan.seed = about_.seed;
    plan.levels = about_.levels;
    for (const std::string& path : about_.paths) plan.axes.emplace_back().path = path;
    const std::size_t n = about_.paths.size();
    // effects[column][axis]
    std::vector effects(about_.columns.size(), std::vector<std::vector<double>>(n));
    for (std::uint64_t t = 0; t < about_.draws; ++t) {
      const std::vector<CaseResult> results = block(t, n + 1);
      if (results.empty()) continue;
      const MorrisTrajectory trajectory = morris_trajectory(plan, t);
      for (std::size_t k = 0; k < n; ++k)
        for (std::size_t c = 0; c < effects.size(); ++c)
          if (const double change = results[k + 1].numbers.at(c) - results[k].numbers.at(c); std::isfinite(change))
            effects[c][trajectory.steps[k].axis].push_back(change / trajectory.steps[k].step);
    }
    for (std::size_t c = 0; c < effects.size(); ++c)
      for (std::size_t a = 0; a < n; ++a) {
        if (effects[c][a].empty()) continue;  // nothing is known, which is not that it depends on nothing
        const MorrisMeasure m = morris_measure(effects[c][a]);
        table.line(fmt::format("{},{},{},{},{},{}", csv_text(about_.columns[c]), csv_text(about_.paths[a]), m.mean,
                               cells_of(m.mean_size), m.deviation, m.count));
      }
    table.finish();
  }

  void write_sobol() {
    Table table(store_ / "indices.csv");
    table.line("result,parameter,first,first.low,first.high,total,total.low,total.high,samples");
    const std::size_t n = about_.paths.size();
    for (std::size_t c = 0; c < about_.columns.size(); ++c) {
      std::vector<SaltelliSample> samples;
      for (std::uint64_t s = 0; s < about_.draws; ++s) {
        const std::vector<CaseResult> results = block(s, n + 2);
        if (results.empty()) continue;
        SaltelliSample sample{results.front().numbers.at(c), results.back().numbers.at(c), {}};
        for (std::size_t a = 0; a < n; ++a) sample.mixed.push_back(results[a + 1].numbers.at(c));
        const bool known = std::all_of(results.begin(), results.end(),
                                       [c](const CaseResult& result) { return std::isfinite(result.numbers[c]); });
        if (known) samples.push_back(std::move(sample));
      }
      const std::vector<SobolIndex> indices = sobol_indices(samples);
      for (std::size_t a = 0; a < indices.size(); ++a)
        table.line(fmt::format("{},{},{},{},{}", csv_text(about_.columns[c]), csv_text(about_.paths[a]),
                               cells_of(indices[a].first), cells_of(indices[a].total), samples.size()));
    }
    table.finish();
  }

  std::filesystem::path store_;
  StoreDescription about_;
  StoreIndex index_;
};

}  // namespace

Collected collect(const std::filesystem::path& store) { return Collector(store).collect(); }

}  // namespace withy::campaign
