#include "withy/results/modes_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "withy/results/blade_branches.hpp"
#include "withy/results/text_table.hpp"

namespace withy {
namespace {

double in_hertz(const Mode& m) { return m.frequency() / (2 * std::numbers::pi); }

std::string component(const std::complex<double>& x) {
  if (std::abs(x) < 5e-5) return "·";
  if (std::abs(x.imag()) < 5e-5) return fmt::format("{:.4f}", x.real());
  return fmt::format("{:.4f}∠{:.0f}°", std::abs(x), std::arg(x) * 180 / std::numbers::pi);
}

/// A state of a load, in whatever dimensions.
std::string of_load(const std::complex<double>& x) {
  if (std::abs(x) < 1e-12) return "·";
  if (std::abs(x.imag()) < 5e-4 * std::abs(x)) return fmt::format("{:.3g}", x.real());
  return fmt::format("{:.3g}∠{:.0f}°", std::abs(x), std::arg(x) * 180 / std::numbers::pi);
}

}  // namespace

std::string modes_text(const study::ModesOf& run, std::size_t count) {
  const study::ModesAt& at = run.points.front();
  // Rigid motions are listed beside those that are asked for, and have no shapes worth a column.
  const auto rigid =
      static_cast<std::size_t>(std::count_if(at.modes.begin(), at.modes.end(), [](const Mode& m) { return m.rigid; }));
  count = std::min(count + rigid, at.modes.size());
  TextTable table({"mode", "frequency\n[rad/s]", "\n[Hz]", "damping\nratio", "growth\n[1/s]", "<", "<dominated by"});
  for (std::size_t i = 0; i < count; ++i) {
    const Mode& m = at.modes[i];
    table.add({std::to_string(i + 1), fmt::format("{:.6g}", m.frequency()), fmt::format("{:.6g}", in_hertz(m)),
               m.rigid ? "-" : fmt::format("{:.3g}", -study::resolved_growth(at, m) / m.frequency() + 0.0),
               fmt::format("{:.3g}", study::resolved_growth(at, m)), study::behaviour(at, m),
               study::dominating(at, m)});
  }
  std::string text = table.str();
  if (count < at.modes.size())
    text += fmt::format("{} more: --count {}\n", at.modes.size() - count, at.modes.size() - rigid);
  std::vector<std::string> head = {"<shape"};
  for (std::size_t i = 0; i < count; ++i)
    if (!at.modes[i].rigid) head.push_back(std::to_string(i + 1));
  if (head.size() == 1) return text;
  TextTable shapes(head);
  const std::size_t speeds = at.model->layout().speeds;
  for (std::size_t s = 0; s < at.names.size(); ++s) {
    std::vector<std::string> cells = {at.names[s]};
    bool moves = false;
    for (std::size_t i = 0; i < count; ++i) {
      if (at.modes[i].rigid) continue;
      const std::complex<double> x = at.modes[i].shape[static_cast<Eigen::Index>(s)];
      moves = moves || x != 0.0;
      cells.push_back(s < speeds ? component(x) : of_load(x));
    }
    if (moves) shapes.add(std::move(cells));
  }
  return text + '\n' + shapes.str();
}

std::string sweep_text(const study::ModesOf& run, const study::Sweep& sweep, std::size_t count) {
  const std::string &label = sweep.path, unit = sweep.shown_unit();
  count = std::min(count, run.branches());
  std::vector<std::string> head = {unit.empty() ? label : label + "\n[" + unit + "]"};
  for (std::size_t i = 0; i < count; ++i) head.push_back(run.name(i) + "\n[rad/s]");
  TextTable table(head);
  bool any_unstable = false;
  std::string problems;
  for (const study::ModesAt& at : run.points) {
    std::vector<std::string> cells = {fmt::format("{:.6g}", at.value)};
    for (std::size_t i = 0; i < count; ++i) {
      const Mode* m = at.on(i);
      if (m == nullptr) {
        cells.emplace_back("-");
        continue;
      }
      const bool grows = study::unstable(at, *m);
      any_unstable = any_unstable || grows;
      cells.push_back(grows ? fmt::format("+{:.6g}/s", m->growth()) : fmt::format("{:.6g}", m->frequency()));
    }
    table.add(std::move(cells));
    if (const std::string words = study::jump_text(at.jump); !words.empty())
      problems += fmt::format("{} = {:.6g}: {}\n", label, at.value, words);
    if (!at.problem.empty()) problems += fmt::format("{} = {:.6g}: {}\n", label, at.value, at.problem);
  }
  std::string text = table.str();
  if (any_unstable) text += "+x/s: unstable, grows as exp(x t)\n";
  return text + problems;
}

std::string poles_text(const study::ModesAt& at) {
  struct Row {
    std::complex<double> pole;
    std::string name;
  };
  std::vector<Row> rows;
  for (const Mode& m : at.modes) {
    rows.push_back({m.eigenvalue, study::dominating(at, m)});
    if (m.eigenvalue.imag() == 0 && !m.rigid && !m.single)
      rows.push_back({m.partner, at.names[static_cast<std::size_t>(m.partner_dominant)]});
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Row& a, const Row& b) { return std::abs(a.pole) < std::abs(b.pole); });
  TextTable table({"pole", "real\n[1/s]", "imaginary\n[rad/s]", "modulus\n[rad/s]", "<dominated by"});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::complex<double> p = rows[i].pole;
    table.add({std::to_string(i + 1), fmt::format("{:.6g}", p.real()),
               p.imag() != 0 ? fmt::format("±{:.6g}", p.imag()) : std::string("-"), fmt::format("{:.6g}", std::abs(p)),
               rows[i].name});
  }
  return table.str();
}

namespace {

std::string lines_of(const study::NamedMode& mode) {
  std::string text;
  for (std::size_t i = 1; i < mode.lines.size() && i < 4; ++i)
    text += fmt::format("{}{:.4g} ({:.0f} %)", i > 1 ? ", " : "", std::abs(mode.lines[i].first),
                        100 * mode.lines[i].second);
  return text;
}

std::string exponents_text(const std::vector<study::NamedMode>& modes, double resolution) {
  TextTable table({"mode", "growth\n[1/s]", "frequency\n[rad/s]", "[Hz]", "<dominated by", "<seen beside at\n[rad/s]"});
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const study::NamedMode& m = modes[i];
    const double growth = std::abs(m.exponent.real()) > resolution ? m.exponent.real() : 0.0;
    table.add({std::to_string(i + 1), m.resolved ? fmt::format("{:.4g}", growth) : fmt::format("< {:.4g}", growth),
               m.resolved ? fmt::format("{:.6g}", m.exponent.imag()) : "-",
               m.resolved ? fmt::format("{:.6g}", m.exponent.imag() / (2 * std::numbers::pi)) : "-", m.dominated_by,
               lines_of(m)});
  }
  return table.str();
}

}  // namespace

std::string turning_text(const study::TurningModes& turn, const std::string& label) {
  std::string text;
  const std::string at = label.empty() ? "" : " at " + label;
  if (turn.moves && (turn.floquet || turn.blades))
    text += fmt::format("\nThe free coordinates follow a motion of the same period{}: by up to {} from the start.\n",
                        at, turn.greatest_displacement);
  if (turn.floquet)
    text += fmt::format("\nWhole turn of {:.6g} s{}: {} (Floquet; growth to {:.1g}/s)\n\n{}", turn.check.turning.period,
                        at, turn.floquet->stable ? "stable" : "unstable", turn.floquet->resolution,
                        exponents_text(turn.floquet->modes, turn.floquet->resolution));
  if (turn.blades) {
    text += fmt::format("\nSeen from where the rotor does not turn{}, {} (multi-blade; {})\n\n{}", at,
                        fmt::join(turn.blades->blades, ", "),
                        turn.blades->change < 1e-9 ? std::string("constant over the turn")
                                                   : fmt::format("averaged over the turn, which leaves out {:.2g} %",
                                                                 100 * turn.blades->change),
                        exponents_text(turn.blades->modes, growth_resolution(*turn.blades)));
  }
  return text;
}

}  // namespace withy
