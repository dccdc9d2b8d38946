#include "elastodyn.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>

#include "withy/core/plugin/body.hpp"
#include "withy/core/shape/modal_mass.hpp"
#include "withy/core/shape/vibrations.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/scene_error.hpp"

namespace withy::exchange {
namespace {

/// Words of a line, without the quotes that some files put round their headings.
std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> words;
  for (;;) {
    const std::size_t first = line.find_first_not_of(" \t\r,");
    if (first == std::string_view::npos) return words;
    line.remove_prefix(first);
    const std::size_t end = std::min(line.find_first_of(" \t\r,"), line.size());
    std::string word(line.substr(0, end));
    std::erase(word, '"');
    words.push_back(std::move(word));
    line.remove_prefix(end);
  }
}

/// What stands up to the first blank.
std::string first_of(const std::string& line) {
  const std::size_t first = std::min(line.find_first_not_of(" \t"), line.size());
  return line.substr(first, line.find_first_of(" \t\r", first) - first);
}

std::optional<double> fortran_number(std::string text) {
  for (char& c : text)
    if (c == 'd' || c == 'D') c = 'e';
  const std::size_t sign = text.starts_with('+') ? 1 : 0;
  double x = 0;
  const auto [at, wrong] = std::from_chars(text.data() + sign, text.data() + text.size(), x);
  if (wrong != std::errc{} || at != text.data() + text.size() || !std::isfinite(x)) return {};
  return x;
}

class ElastoDynReader {
 public:
  ElastoDynReader(std::string_view text, Diagnostics& diagnostics) : diagnostics_(diagnostics) {
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      lines_.emplace_back(text.substr(0, end));
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
  }

  ElastoDynBeam read() {
    find_table();
    if (heading_ == lines_.size()) {
      error(1, "no table of distributed properties, whose heading begins with BlFract or HtFract");
      return beam_;
    }
    if (!diagnostics_.ok()) return beam_;
    if (lines_.size() > 1 && words_of(lines_[1]).size() > 1) beam_.title = lines_[1];
    if (!beam_.title.empty() && beam_.title.back() == '\r') beam_.title.pop_back();
    table();
    if (diagnostics_.ok()) {
      adjust();
      remark();
    }
    return std::move(beam_);
  }

 private:
  /// Before the first value, whose own first words may be a number and a name, as "5 MW".
  static constexpr int title_lines = 3;
  struct Keyed {
    double value = 0;
    int line = 0;
  };

  void error(int line, std::string what) const { diagnostics_.error({line, 1, "/"}, std::move(what)); }

  /// Values before their keywords, as "1.04536 AdjBlMs - Factor…", up to the heading of the table.
  void find_table() {
    for (heading_ = 0; heading_ < lines_.size(); ++heading_) {
      const auto words = words_of(lines_[heading_]);
      if (words.empty() || words[0].starts_with("--")) continue;
      if (words[0] == "BlFract" || words[0] == "HtFract") {
        beam_.tower = words[0] == "HtFract";
        return;
      }
      if (words.size() > 1) parameter(words, static_cast<int>(heading_) + 1);
    }
  }

  /// Fortran ends a number at a comma and takes no notice of what follows: 0,7 would be 0.
  void parameter(const std::vector<std::string>& words, int line) {
    const auto value = fortran_number(words[0]);
    const bool titled = line <= title_lines, cut = value && fortran_number(words[1]);
    if (!titled && (cut || (!value && is_read(words[1]))))
      error(line,
            fmt::format("got {}; need a finite number, whose decimals follow a point, and the name of a parameter",
                        in_quotes(first_of(lines_[static_cast<std::size_t>(line) - 1]))));
    else if (value)
      take(words[1], {*value, line});
  }

  /// A title may begin as a parameter does, so what it seems to say gives way.
  void take(const std::string& key, const Keyed& given) {
    Keyed& kept = keyed_.try_emplace(key, given).first->second;
    if (kept.line > title_lines && kept.line != given.line && (is_read(key) || is_tuner(key)))
      error(given.line, fmt::format("{} stands on line {} already; need it once", key, kept.line));
    kept = given;
  }

  double keyed(const std::string& key, double otherwise) const {
    const auto found = keyed_.find(key);
    return found != keyed_.end() ? found->second.value : otherwise;
  }

  void table() {
    const std::vector<std::string> heading = words_of(lines_[heading_]);
    const auto column = [&](const char* name) {
      const auto found = std::find(heading.begin(), heading.end(), name);
      if (found == heading.end())
        error(static_cast<int>(heading_) + 1, fmt::format("the table has no column {}", name));
      return static_cast<std::size_t>(found - heading.begin());
    };
    const std::size_t mass = column(beam_.tower ? "TMassDen" : "BMassDen"),
                      y = column(beam_.tower ? "TwFAStif" : "FlpStff"),
                      z = column(beam_.tower ? "TwSSStif" : "EdgStff"), twist = beam_.tower ? 0 : column("StrcTwst");
    const char* counter = beam_.tower ? "NTwInpSt" : "NBlInpSt";
    const double count = keyed(counter, 0);
    if (!(count >= 2 && count <= 100000 && count == std::floor(count)))
      error(1, fmt::format("got {} stations; need {}, a whole number of at least 2", count, counter));
    if (!diagnostics_.ok()) return;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const std::size_t line = heading_ + 2 + i;  // a line of units stands between
      const auto numbers = line < lines_.size() ? row(line, heading.size()) : std::nullopt;
      if (!numbers) return;
      beam_.fraction.push_back((*numbers)[0]);
      beam_.mass_per_length.push_back((*numbers)[mass]);
      beam_.along_y.push_back((*numbers)[y]);
      beam_.along_z.push_back((*numbers)[z]);
      // Towards feather: the trailing edge turns downwind, from z to y.
      if (!beam_.tower) beam_.twist.push_back((0.0 - (*numbers)[twist]) * std::numbers::pi / 180);  // no −0
      check_row(i, static_cast<int>(line) + 1);
      note_unread(heading, *numbers, {0, mass, y, z, twist});
    }
    if (beam_.fraction.front() != 0 || std::abs(beam_.fraction.back() - 1) > 1e-9)
      error(static_cast<int>(heading_) + 1, fmt::format("got stations from {} to {} of the length; need 0 to 1",
                                                        beam_.fraction.front(), beam_.fraction.back()));
  }

  std::optional<std::vector<double>> row(std::size_t line, std::size_t columns) const {
    const auto words = words_of(lines_[line]);
    std::vector<double> numbers;
    for (std::size_t c = 0; c < words.size(); ++c) {
      const auto x = fortran_number(words[c]);
      if (!x && c >= columns) break;  // a remark behind the row
      if (!x) {
        error(static_cast<int>(line) + 1, fmt::format("got {}; need a finite number", in_quotes(words[c])));
        return {};
      }
      numbers.push_back(*x);
    }
    if (numbers.size() == columns) return numbers;
    error(static_cast<int>(line) + 1,
          fmt::format("got {} numbers; need {}, one for each column{}", numbers.size(), columns,
                      lines_[line].find(',') != std::string::npos ? "; decimals follow a point" : ""));
    return {};
  }

  /// Nothing is lost with a column of zeros.
  void note_unread(const std::vector<std::string>& heading, const std::vector<double>& numbers,
                   std::initializer_list<std::size_t> read) {
    for (std::size_t c = 0; c < heading.size(); ++c) {
      if (std::find(read.begin(), read.end(), c) != read.end() || numbers[c] == 0) continue;
      std::vector<std::string>& unread = unread_[heading[c] == "PitchAxis" || heading[c] == "AeroCent"];
      if (std::find(unread.begin(), unread.end(), heading[c]) == unread.end()) unread.push_back(heading[c]);
    }
  }

  void check_row(std::size_t i, int line) const {
    if (i > 0 && !(beam_.fraction[i] > beam_.fraction[i - 1])) error(line, "need stations in ascending order");
    for (const auto* column : {&beam_.mass_per_length, &beam_.along_y, &beam_.along_z})
      if (!((*column)[i] > 0)) error(line, fmt::format("got {}; need mass and stiffness above 0", (*column)[i]));
  }

  void adjust() {
    const bool t = beam_.tower;
    const double m = keyed(t ? "AdjTwMa" : "AdjBlMs", 1), y = keyed(t ? "AdjFASt" : "AdjFlSt", 1),
                 z = keyed(t ? "AdjSSSt" : "AdjEdSt", 1);
    for (double& x : beam_.mass_per_length) x *= m;
    for (double& x : beam_.along_y) x *= y;
    for (double& x : beam_.along_z) x *= z;
    beam_.damping_y = damping(t ? "TwrFADmp" : "BldFlDmp");
    beam_.damping_z = damping(t ? "TwrSSDmp" : "BldEdDmp");
  }

  /// Ratios of the first modes in a direction, from per cent.
  std::vector<double> damping(const std::string& key) const {
    std::vector<double> ratios{keyed(key + "(1)", 0) / 100};
    if (keyed_.contains(key + "(2)")) ratios.push_back(keyed(key + "(2)", 0) / 100);
    return ratios;
  }

  /// What of the file is in no beam.
  void remark() {
    beam_.remarks.emplace_back(
        "The file's mode shapes are left out: modes of vibration found from the table take their place, as many as "
        "wanted.");
    remark_on_missing();
    for (const auto& [key, keyed] : keyed_) {
      const bool tuner = is_tuner(key);
      if (tuner ? keyed.value != 1 : keyed.line > title_lines && !is_read(key))
        beam_.remarks.push_back(fmt::format("{} = {} on line {} is left out{}.", key, keyed.value, keyed.line,
                                            tuner ? ": it tunes a single mode" : ""));
    }
    remark_on(unread_[true], "what air acts on is no matter of the beam");
    remark_on(unread_[false],
              "the beam bends in two directions along a straight axis, as in ElastoDyn, without torsion, extension, "
              "rotary inertia and masses beside the axis");
  }
  void remark_on(const std::vector<std::string>& columns, const char* why) {
    if (columns.empty()) return;
    const bool one = columns.size() == 1;
    beam_.remarks.push_back(fmt::format("Column{} {} of the table {} left out: {}.", one ? "" : "s",
                                        fmt::join(columns, ", "), one ? "is" : "are", why));
  }
  /// What ElastoDyn's own files always have, and this one leaves to be guessed.
  void remark_on_missing() {
    const bool t = beam_.tower;
    std::vector<std::string> missing;
    const auto look_for = [&](const std::string& key, const std::string& taken) {
      if (!keyed_.contains(key)) missing.push_back(fmt::format("{}, taken as {}", key, taken));
    };
    for (const char* factor : {t ? "AdjTwMa" : "AdjBlMs", t ? "AdjFASt" : "AdjFlSt", t ? "AdjSSSt" : "AdjEdSt"})
      look_for(factor, "1");
    for (const char* ratio : {t ? "TwrFADmp" : "BldFlDmp", t ? "TwrSSDmp" : "BldEdDmp"}) {
      const std::string first = fmt::format("{}(1)", ratio);
      look_for(first, "0");
      if (first != "BldEdDmp(1)") look_for(fmt::format("{}(2)", ratio), keyed_.contains(first) ? first : "0");
    }
    if (!missing.empty()) beam_.remarks.push_back(fmt::format("Not in the file: {}.", fmt::join(missing, "; ")));
  }
  static bool is_tuner(const std::string& key) { return key.find("StTunr") != std::string::npos; }
  /// Whether a keyword is one whose value the beam has.
  static bool is_read(const std::string& key) {
    for (const char* read : {"NBlInpSt", "NTwInpSt", "AdjBlMs", "AdjFlSt", "AdjEdSt", "AdjTwMa", "AdjFASt", "AdjSSSt"})
      if (key == read) return true;
    return key.find("Dmp(1)") != std::string::npos || key.find("Dmp(2)") != std::string::npos;
  }

  Diagnostics& diagnostics_;
  std::vector<std::string> lines_;
  std::map<std::string, Keyed> keyed_;
  std::size_t heading_ = 0;
  std::map<bool, std::vector<std::string>> unread_;  ///< columns that are not zero all along; true: those of air
  ElastoDynBeam beam_;
};

const char* direction(const ElastoDynBeam& beam, bool y) {
  return beam.tower ? (y ? "fore-aft" : "side to side") : (y ? "flapwise" : "edgewise");
}

/// Rows [x, value] of a table over the beam, four in a line.
std::string rows_text(const ElastoDynBeam& beam, const std::vector<double>& values, double length, const char* indent) {
  std::string text = "\n" + std::string(indent) + "[";
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) text += i % 4 == 0 ? ",\n" + std::string(indent) + " " : ", ";
    const double x = i + 1 == values.size() ? length : beam.fraction[i] * length;
    text += fmt::format("[{}, {}]", x, values[i]);
  }
  return text + "]\n";
}

/// Of each of a beam's own modes, in the order that damping counts them in: whether it moves along y more than along z.
/// What is apart is kept apart, so that directions of equal frequencies do not mix. None where a mode has no mass.
std::vector<bool> directions_of_modes(const Body& body) {
  const ModalShape& shape = body.shape();
  const Eigen::MatrixXd& K = shape.stiffness;
  const Eigen::MatrixXd G = modal_mass(shape);
  std::vector<std::pair<double, bool>> modes;
  for (const std::vector<Eigen::Index>& group : coupled_coordinates(K, G)) {
    const Eigen::MatrixXd inertia = G(group, group);
    if (Eigen::LLT<Eigen::MatrixXd>(inertia).info() != Eigen::Success) return {};
    const Vibrations found = vibrations(K(group, group), inertia);
    for (Eigen::Index k = 0; k < found.squares.size(); ++k) {
      const Eigen::VectorXd v = found.vectors.col(k), momentum = inertia * v;
      double along_y = 0;  // share of the modal mass, which is 1
      for (std::size_t i = 0; i < group.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(i);
        if (shape.mode_names[static_cast<std::size_t>(group[i])].starts_with("bending_y"))
          along_y += v[at] * momentum[at];
      }
      modes.emplace_back(found.squares[k], along_y > 0.5);
    }
  }
  std::stable_sort(modes.begin(), modes.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<bool> along;
  for (const auto& [square, y] : modes) along.push_back(y);
  return along;
}

}  // namespace

ElastoDynBeam read_elastodyn(std::string_view text, const std::string& file) {
  Diagnostics diagnostics;
  ElastoDynBeam beam = ElastoDynReader(text, diagnostics).read();
  if (!diagnostics.ok()) throw SceneError(file, diagnostics.errors());
  return beam;
}

void assign_damping(ElastoDynBeam& beam, const Body& body) {
  std::map<bool, std::size_t> known;  // of each direction, how many have gone before
  std::string told;
  int number = 0;
  for (const bool y : directions_of_modes(body)) {
    const std::vector<double>& ratios = y ? beam.damping_y : beam.damping_z;
    const double ratio = ratios[std::min(known[y]++, ratios.size() - 1)];
    ++number;
    if (known[y] <= ratios.size())
      told += fmt::format("{}{} ({}, {})", told.empty() ? "" : ", ", number, direction(beam, y), ratio);
    if (ratio != beam.damping_y.front()) beam.ratios[number] = ratio;
  }
  if (number == 0)
    beam.remarks.emplace_back(
        "All modes have the damping ratio of the first in the file: the masses are too far apart to "
        "tell the modes from one another.");
  if (!beam.ratios.empty())
    beam.remarks.push_back(
        fmt::format("The file has damping ratios of the beam's modes {}; of the others it says nothing, and each has "
                    "that of the last before it in its direction.",
                    told));
}

std::string scene_text(const ElastoDynBeam& beam, double length, double tip_mass, const std::string& source) {
  const std::string name = beam.tower ? "tower" : "blade";
  std::string out =
      fmt::format("# Made by `withy import` from {}{}. Edit it as any scene.\n",
                  std::filesystem::path(source).filename().string(), beam.title.empty() ? "" : ": " + beam.title);
  out += beam.tower
             ? "# Axes of the tower: x up, y fore-aft (downwind), z side to side. Metres, kilograms, N m^2.\n"
             : "# Axes of the blade: x to the tip, y flapwise (downwind), z edgewise. Metres, kilograms, N m^2.\n";
  for (const std::string& remark : beam.remarks) out += "# " + remark + "\n";
  out += fmt::format("format: withy/1\nname: {}\n", name);
  if (beam.tower) out += "gravity: [0, 0, -9.80665]\n";
  out += fmt::format(
      "time: {{end: 10, output: 0.01}}\n\nbodies:\n  {}:\n    type: beam\n    length: {}\n    mass_per_length:{}", name,
      length, rows_text(beam, beam.mass_per_length, length, "      "));
  if (std::any_of(beam.twist.begin(), beam.twist.end(), [](double angle) { return angle != 0; }))
    out += "    twist:   # rad" + rows_text(beam, beam.twist, length, "      ");
  out += fmt::format("    damping_ratio: {}\n", beam.damping_y.front());
  if (!beam.ratios.empty()) {
    std::string rows;
    for (const auto& [mode, ratio] : beam.ratios)
      rows += fmt::format("{}[{}, {}]", rows.empty() ? "" : ", ", mode, ratio);
    out += fmt::format("    damping: {{ratios: [{}]}}   # of single modes, in the order of frequency\n", rows);
  }
  const std::string family =
      tip_mass > 0 ? fmt::format("{{name: vibration-modes, tip_mass: {}}}", tip_mass) : "vibration-modes";
  for (const bool y : {true, false})
    out +=
        fmt::format("    bending_{}:   # {}\n      modes: 3\n      family: {}\n      stiffness:{}", y ? 'y' : 'z',
                    direction(beam, y), family, rows_text(beam, y ? beam.along_y : beam.along_z, length, "        "));
  if (tip_mass > 0)
    out += fmt::format("  top: {{type: rigid, mass: {}}}   # what the tip carries, as a point\n", tip_mass);
  out += fmt::format("\nhinges:\n  root: {{type: weld, parent: world, child: {}{}}}\n", name,
                     beam.tower ? ", offset: {orientation: [0.5, -0.5, -0.5, -0.5]}" : "");
  if (tip_mass > 0) out += fmt::format("  head: {{type: weld, parent: {}.tip, child: top}}\n", name);
  return out;
}

}  // namespace withy::exchange
