#include "withy/study/recorded_motion.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <system_error>

#include "withy/core/model/columns.hpp"
#include "withy/scene/csv_rows.hpp"
#include "withy/scene/document.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/units.hpp"
#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

constexpr std::size_t cubic_points = 4;

/// A column of the head: "shoulder[deg]" has the name shoulder and the unit deg.
struct Head {
  std::string name, unit;
  explicit Head(const std::string& text) {
    const auto bracket = text.find('[');
    name = text.substr(0, bracket);
    if (bracket != std::string::npos && text.ends_with(']')) unit = text.substr(bracket + 1, text.size() - bracket - 2);
  }
};

/// A column that is read.
struct Source {
  std::size_t column = 0;
  double factor = 1;            ///< to SI units
  std::vector<double>* values;  ///< where they go
};

/// The place of a cell, as "path.csv:3:7".
std::string place_of(const std::string& file, const CsvRow& row, std::size_t cell) {
  return fmt::format("{}:{}:{}", file, row.line, row.columns[cell]);
}

double factor_of(const Head& head, const std::string& si_unit, const std::string& place) {
  if (head.unit.empty()) return 1;
  const QuantityReading one = read_quantity("1 " + head.unit, si_unit);
  if (!one.value) throw InputError(fmt::format("{}: column '{}': {}", place, head.name, one.problem));
  return *one.value;
}

/// The polynomial through points, at most a cubic, and its derivative.
struct Extended {
  double value = 0, rate = 0;
};
Extended extended(const std::vector<double>& times, const std::vector<double>& values, std::size_t first,
                  std::size_t count, double t) {
  const auto n = static_cast<Eigen::Index>(count);
  const double scale = times[first + count - 1] - times[first];
  Eigen::MatrixXd powers(n, n);
  Eigen::VectorXd x(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t row = first + static_cast<std::size_t>(i);
    for (Eigen::Index k = 0; k < n; ++k) powers(i, k) = std::pow((times[row] - t) / scale, k);
    x[i] = values[row];
  }
  const Eigen::VectorXd c = powers.fullPivLu().solve(x);
  return {c[0], c[1] / scale};
}

/// Notes the columns that are left out. Refuses one that is hardly meant to be: its name is near that of a hinge which
/// has no column.
void leave_out(const CsvRow& head, const Model& model, const std::string& file, RecordedMotion& motion) {
  std::vector<std::string> missing;
  for (const HingeNode& hinge : model.hinges())
    if (coordinate_columns(hinge).size() == 1 && !motion.coordinates.contains(hinge.name))
      missing.push_back(hinge.name);
  for (std::size_t k = 0; k < head.cells.size(); ++k) {
    const Head h(head.cells[k]);
    if (h.name == "t" || motion.coordinates.contains(h.name)) continue;
    motion.ignored.push_back(head.cells[k]);
    const std::string guess = h.name.find('.') != std::string::npos ? "" : nearest(h.name, missing);
    if (!guess.empty())
      throw InputError(
          fmt::format("{}: no hinge is named '{}'; did you mean '{}'?", place_of(file, head, k), h.name, guess));
  }
}

/// The columns of the head that are read, time first.
std::vector<Source> sources_of(const CsvRow& head, const Model& model, const std::string& file,
                               RecordedMotion& motion) {
  std::vector<Source> sources;
  const auto twice = [&](std::size_t k) {
    return InputError(fmt::format("{}: column '{}' is there twice", place_of(file, head, k), Head(head.cells[k]).name));
  };
  bool timed = false;
  for (std::size_t k = 0; k < head.cells.size(); ++k) {
    const Head h(head.cells[k]);
    const std::string place = place_of(file, head, k);
    if (h.name == "t") {
      if (timed) throw twice(k);
      sources.insert(sources.begin(), {k, factor_of(h, "s", place), &motion.times});
      timed = true;
    }
    for (const HingeNode& hinge : model.hinges()) {
      const auto columns = coordinate_columns(hinge);
      if (hinge.name != h.name || columns.size() != 1) continue;
      const auto [made, is_new] = motion.coordinates.emplace(h.name, std::vector<double>());
      if (!is_new) throw twice(k);
      sources.push_back({k, factor_of(h, columns[0].unit, place), &made->second});
    }
  }
  if (timed) leave_out(head, model, file, motion);
  if (timed && !motion.coordinates.empty()) return sources;
  if (!timed) throw InputError(file + ":1:1: need a column t[s]");
  std::vector<std::string> known;
  for (const HingeNode& hinge : model.hinges())
    if (coordinate_columns(hinge).size() == 1) known.push_back(hinge.name);
  throw InputError(fmt::format("{}:1:1: need a column named after a hinge of one coordinate; there are {}", file,
                               fmt::join(known, ", ")));
}

void read_row(const CsvRow& row, const std::vector<Source>& sources, const std::string& file,
              const std::vector<double>& times) {
  for (const Source& s : sources) {
    const std::string& cell = row.cells[s.column];
    const auto value = plain_number(cell);
    if (!value)
      throw InputError(fmt::format("{}: got {} in column {}; need a number", place_of(file, row, s.column),
                                   in_quotes(cell), s.column + 1));
    s.values->push_back(s.factor * *value);
  }
  const std::string place = place_of(file, row, sources.front().column);
  const std::size_t rows = times.size();
  if (rows == 1 && times[0] != 0) throw InputError(fmt::format("{}: begins at {:g} s; need 0", place, times[0]));
  if (rows > 1 && !(times[rows - 1] > times[rows - 2]))
    throw InputError(fmt::format("{}: got the time {:g} s after {:g} s; need times that increase", place,
                                 times[rows - 1], times[rows - 2]));
}

Value pair(double a, double b) { return Value::list({Value(a), Value(b)}); }

/// The table of a hinge, as the file has it under `motions`.
Value table_of(const std::string& hinge, const std::vector<double>& t, const std::vector<double>& x) {
  const std::size_t n = t.size(), count = std::min(n, cubic_points);
  const double beyond = t[n - 1] + (t[n - 1] - t[n - 2]);
  const Extended start = extended(t, x, 0, count, t[0]), end = extended(t, x, n - count, count, beyond);
  std::vector<Value> rows;
  for (std::size_t i = 0; i < n; ++i) rows.push_back(pair(t[i], x[i]));
  rows.push_back(pair(beyond, end.value));
  return Value::map({{"hinge", Value(hinge)},
                     {"type", Value(std::string("table"))},
                     {"start_rate", Value(start.rate)},
                     {"end_rate", Value(end.rate)},
                     {"table", Value::list(std::move(rows))}});
}

std::string text_of(const std::string& file) {
  try {
    return read_bytes(file);
  } catch (const std::system_error& e) {
    throw InputError(fmt::format("{}: cannot be read: {}", file, e.code().message()));
  }
}

}  // namespace

RecordedMotion read_recorded_motion(const std::filesystem::path& path, const Model& model) {
  return parse_recorded_motion(text_of(path.string()), path.string(), model);
}

RecordedMotion parse_recorded_motion(const std::string& text, const std::string& file, const Model& model) {
  if (text.empty()) throw InputError(file + ": empty; need a head as t[s],shoulder[rad],elbow[rad]");
  CsvRows rows(text);
  if (const std::string problem = rows.head_problem(); !problem.empty())
    throw InputError(fmt::format("{}:1:1: {}", file, problem));
  RecordedMotion motion;
  const std::vector<Source> sources = sources_of(rows.head(), model, file, motion);
  for (CsvRow row; rows.next(row);) {
    if (const std::string problem = rows.problem(row); !problem.empty())
      throw InputError(fmt::format("{}:{}:1: {}", file, row.line, problem));
    read_row(row, sources, file, motion.times);
  }
  if (motion.times.size() < 2) throw InputError(file + ": need at least two rows");
  return motion;
}

SceneValues led_by(SceneValues values, const RecordedMotion& motion) {
  const std::string origin = "the recorded motion";
  std::vector<Value::Member> motions;
  for (const auto& [hinge, x] : motion.coordinates) motions.emplace_back(hinge, table_of(hinge, motion.times, x));
  values.motions(Value::map(std::move(motions)), origin);
  values.set("time.end", Value(motion.times.back()), origin);
  for (const auto& [hinge, x] : motion.coordinates) {  // they begin where the motion does
    const std::string start = "initial.hinges." + hinge;
    if (values.find(start) != nullptr) values.set(start, Value::map({}), origin);
  }
  return values;
}

LedScene led_scene(const Prepared& prepared, const MotionWish& wish, Registry& registry) {
  if (wish.file.empty() && !wish.text) return {prepared, {}};
  const RecordedMotion motion = wish.text ? parse_recorded_motion(*wish.text, wish.file, prepared.model())
                                          : read_recorded_motion(wish.file, prepared.model());
  return {prepare(led_by(prepared.values, motion), registry), motion.ignored};
}

}  // namespace withy::study
