#include "withy/campaign/measured.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <system_error>

#include "withy/results/csv.hpp"
#include "withy/scene/csv_rows.hpp"
#include "withy/scene/describe.hpp"
#include "withy/scene/document.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/units.hpp"

namespace withy::campaign {
namespace {

/// A cell of the head: "tip.x[mm]".
struct HeadCell {
  std::string name, unit;
  explicit HeadCell(const std::string& text) : name(text) {
    const std::size_t bracket = text.rfind('[');
    if (bracket == std::string::npos || !text.ends_with(']')) return;
    name = text.substr(0, bracket);
    unit = text.substr(bracket + 1, text.size() - bracket - 2);
  }
};

class MeasuredReader {
 public:
  MeasuredReader(const MeasuredWish& wish, const std::vector<Column>& results, std::vector<std::string>& problems)
      : wish_(wish), results_(results), problems_(problems) {
    data_.file = wish.file;
  }

  Measured read() {
    const std::optional<std::string> text = wish_.text ? wish_.text : text_of_file();
    if (!text) return data_;
    CsvRows rows(*text);
    if (const std::string wrong = rows.head_problem(); !wrong.empty()) {
      problem(1, 1, wrong);
      return data_;
    }
    read_head(rows.head());
    for (CsvRow row; rows.next(row);) read_row(rows, row);
    number_ = rows.line() + 1;
    if (time_ && data_.times.size() < 2) problem(number_, 1, "need at least two rows of data");
    for (MeasuredColumn& column : data_.columns) weigh(column);
    leave_out_constant();
    if (late_ > 1)
      problem(number_ - 1, 1,
              fmt::format("and {} more rows lie after it; --set time.end={:g}", late_ - 1, data_.times.back()));
    check_wishes();
    if (hidden_ > 0) problems_.push_back(fmt::format("{}: {} more lines like these", wish_.file, hidden_));
    return std::move(data_);
  }

 private:
  std::optional<std::string> text_of_file() {
    try {
      return read_bytes(wish_.file);
    } catch (const std::system_error& e) {
      problems_.emplace_back(e.what());
      return {};
    }
  }

  /// Of what is wrong in the rows, the first are told.
  void problem(std::size_t line, std::size_t column, const std::string& message) {
    constexpr std::size_t most = 10;
    if (line > 1 && ++told_ > most) {
      ++hidden_;
      return;
    }
    problems_.push_back(fmt::format("{}:{}:{}: {}", wish_.file, line, column, message));
  }

  /// Whether a name stands for a result: a result's own name for that one alone ("pivot" not for "pivot.rate"), the
  /// first part of names for all that begin so ("tip" for "tip.x").
  [[nodiscard]] bool covers(const std::string& name, const std::string& result) const {
    const std::string plain = column_name(name);
    if (std::find(known_.begin(), known_.end(), plain) != known_.end()) return result == plain;
    return result.starts_with(plain + '.');
  }

  double factor(const HeadCell& cell, const std::string& si_unit, std::size_t place) {
    if (cell.unit.empty() || (cell.unit == "1" && si_unit.empty())) return 1;
    const QuantityReading one = read_quantity("1 " + cell.unit, si_unit.empty() ? "1" : si_unit);
    if (!one.value) problem(1, place, fmt::format("column {}: {}", in_quotes(cell.name), one.problem));
    return one.value.value_or(1);
  }

  void read_head(const CsvRow& head) {
    for (const Column& c : results_) known_.push_back(column_name(c.name));
    for (std::size_t k = 0; k < head.cells.size(); ++k) {
      const HeadCell cell(head.cells[k]);
      if ((cell.name == "t" || cell.name == "time") && !time_) {
        time_ = k;
        to_seconds_ = factor(cell, "s", head.columns[k]);
        continue;
      }
      add_column(cell, head.cells[k], k, head.columns[k]);
    }
    if (!time_) problem(1, 1, "need a column t[s]");
    if (data_.columns.empty() && wish_.outputs.empty())
      problem(1, 1, "no column has the name of a result; the scene's are " + listed(known_));
  }

  void add_column(const HeadCell& cell, const std::string& head, std::size_t k, std::size_t place) {
    const auto result = std::find(known_.begin(), known_.end(), column_name(cell.name));
    const bool wanted =
        wish_.outputs.empty() || std::any_of(wish_.outputs.begin(), wish_.outputs.end(),
                                             [&](const std::string& o) { return covers(o, column_name(cell.name)); });
    if (result == known_.end() && wanted) {
      const std::string guess = nearest(cell.name, known_);
      if (!guess.empty() && !cell.name.empty())
        problem(1, place, fmt::format("no result {}; did you mean '{}'?", in_quotes(cell.name), guess));
    }
    if (result != known_.end()) comparable_.push_back(*result);
    if (result == known_.end() || !wanted) {
      data_.ignored.push_back(head);
      return;
    }
    const auto index = static_cast<std::size_t>(result - known_.begin());
    for (const MeasuredColumn& c : data_.columns)
      if (c.result == index) problem(1, place, fmt::format("column {} is there twice", in_quotes(cell.name)));
    const std::string& unit = results_[index].unit;
    sources_.push_back({k, factor(cell, unit, place)});
    data_.columns.push_back({*result, unit, index, {}, 0, false});
  }

  static bool is_missing(const std::string& cell) { return cell.empty() || cell == "nan" || cell == "NaN"; }

  std::optional<double> number(const std::string& cell, std::size_t place) {
    if (is_missing(cell)) return {};
    const auto x = plain_number(cell);
    if (!x) problem(number_, place, fmt::format("got {}; need a number, or nothing", in_quotes(cell)));
    return x;
  }

  void read_row(const CsvRows& rows, const CsvRow& row) {
    number_ = row.line;
    if (const std::string wrong = rows.problem(row); !wrong.empty()) {
      problem(number_, 1, wrong);
      return;
    }
    const std::vector<std::string>& cells = row.cells;
    const std::vector<std::size_t>& places = row.columns;
    if (!time_) return;
    const auto time = number(cells[*time_], places[*time_]);
    if (!time) {
      if (is_missing(cells[*time_])) problem(number_, places[*time_], "the time is missing");
      return;
    }
    const double t = to_seconds_ * *time;
    check_time(t, places[*time_]);
    data_.times.push_back(t);
    for (std::size_t c = 0; c < sources_.size(); ++c) {
      const auto x = number(cells[sources_[c].cell], places[sources_[c].cell]);
      data_.columns[c].values.push_back(x ? sources_[c].factor * *x : std::numeric_limits<double>::quiet_NaN());
    }
  }

  void check_time(double t, std::size_t place) {
    const double apart = leeway(t);
    if (!data_.times.empty() && !(t > data_.times.back()))
      problem(number_, place, fmt::format("the time does not increase: {:g} s after {:g} s", t, data_.times.back()));
    else if (t < wish_.from - apart)
      problem(number_, place, fmt::format("{:g} s lies before the scene's initial time, {:g} s", t, wish_.from));
    else if (t > wish_.end + apart && late_++ == 0)
      problem(number_, place, fmt::format("{:g} s lies after the scene's end, {:g} s", t, wish_.end));
  }

  /// The unit of the first result that a name stands for: "ball", of a spherical hinge, are its coordinates, and its
  /// rates have another one.
  [[nodiscard]] std::string unit_of(const std::string& name) const {
    for (std::size_t i = 0; i < known_.size(); ++i)
      if (covers(name, known_[i])) return results_[i].unit;
    return {};
  }

  /// The text that gives a column's deviation: of those that stand for it the one with the longest name, as the name
  /// itself is longer than its first part.
  [[nodiscard]] const std::string* deviation_of(const MeasuredColumn& column) const {
    const std::string* found = nullptr;
    std::size_t longest = 0;
    for (const std::string& text : wish_.deviations) {
      const std::size_t equals = text.find('=');
      if (equals == std::string::npos || equals < longest) continue;
      const std::string name = text.substr(0, equals);
      if (!covers(name, column.name) || column.unit != unit_of(name)) continue;
      found = &text, longest = equals;
    }
    return found;
  }

  void weigh(MeasuredColumn& column) {
    if (column.count() == 0) {
      problem(1, 1, fmt::format("column {} has no values", in_quotes(column.name)));
      return;
    }
    if (const std::string* text = deviation_of(column)) {
      const std::string unit = column.unit.empty() ? "1" : column.unit;
      const std::string given = text->substr(text->find('=') + 1);
      const auto bare = plain_number(given);
      const QuantityReading reading = bare ? QuantityReading{*bare, {}} : read_quantity(given, unit);
      if (!reading.value || !(*reading.value > 0))
        problems_.push_back(fmt::format("--deviations {}{}: {}", in_quotes(*text),
                                        text->starts_with(column.name + '=') ? "" : ", column " + column.name,
                                        reading.value ? "need a number > 0" : reading.problem));
      column.deviation = reading.value.value_or(1);
      column.deviation_given = true;
    }
    if (!column.deviation_given) column.deviation = column.range();
    // Of several columns those that nobody asked for are left out.
    if (column.deviation == 0 && !wish_.outputs.empty())
      problem(1, 1,
              fmt::format("column {} does not change, so that it has no range to weigh it by: give the standard "
                          "deviation of its measurement, --deviations {}=…",
                          in_quotes(column.name), column.name));
  }

  /// Columns that have no range to weigh them by, where nobody asked for them.
  void leave_out_constant() {
    if (!wish_.outputs.empty()) return;
    for (const MeasuredColumn& c : data_.columns)
      if (c.deviation == 0 && c.count() > 0) data_.ignored.push_back(c.name + " (does not change)");
    const bool any = !data_.columns.empty();
    std::erase_if(data_.columns, [](const MeasuredColumn& c) { return c.deviation == 0 && c.count() > 0; });
    if (any && data_.columns.empty())
      problem(1, 1,
              "no column changes: there is nothing to compare; give --output and --deviations of what to compare");
  }

  /// Names on the command line that stand for no column.
  void check_wishes() {
    const auto check = [&](const std::string& option, const std::string& text, const std::string& name) {
      for (const MeasuredColumn& c : data_.columns)
        if (covers(name, c.name)) return;
      problems_.push_back(fmt::format("{} {}: no column of {} is compared under this name{}", option, in_quotes(text),
                                      wish_.file, suggestion(name, comparable_)));
    };
    for (const std::string& o : wish_.outputs) check("--output", o, o);
    for (const std::string& d : wish_.deviations) check("--deviations", d, d.substr(0, d.find('=')));
  }

  struct Source {
    std::size_t cell;
    double factor;  ///< to SI units
  };
  const MeasuredWish& wish_;
  const std::vector<Column>& results_;
  std::vector<std::string>& problems_;
  Measured data_;
  std::vector<std::string> known_;       ///< names of results
  std::vector<std::string> comparable_;  ///< those of them that the data has
  std::optional<std::size_t> time_;
  double to_seconds_ = 1;
  std::vector<Source> sources_;  ///< one a column that is compared
  std::size_t number_ = 1, told_ = 0, hidden_ = 0, late_ = 0;
};

}  // namespace

std::size_t MeasuredColumn::count() const {
  return static_cast<std::size_t>(
      std::count_if(values.begin(), values.end(), [](double x) { return std::isfinite(x); }));
}

double MeasuredColumn::range() const {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const double x : values)
    if (std::isfinite(x)) least = std::min(least, x), most = std::max(most, x);
  return most - least;
}

std::size_t Measured::count() const {
  std::size_t all = 0;
  for (const MeasuredColumn& c : columns) all += c.count();
  return all;
}

double leeway(double time) { return 1e-9 * (1 + std::abs(time)); }

Measured read_measured(const MeasuredWish& wish, const std::vector<Column>& results,
                       std::vector<std::string>& problems) {
  return MeasuredReader(wish, results, problems).read();
}

}  // namespace withy::campaign
