#include "withy/apps/withy/modes_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "withy/apps/withy/text_table.hpp"
#include "withy/results/svg_plot.hpp"

namespace withy::app {
namespace {

using Json = nlohmann::ordered_json;

double hertz(const Mode& m) { return m.frequency() / (2 * std::numbers::pi); }

/// What rounding leaves of a growth: eigenvalues are found to about 1e-9 of the greatest.
double greatest_of(const ModesAt& at) {
  double g = 0;
  for (const Mode& m : at.modes) g = std::max({g, std::abs(m.eigenvalue), std::abs(m.partner)});
  return g;
}
/// A growth without what rounding leaves of it.
double shown_growth(const ModesAt& at, const Mode& m) {
  return std::abs(m.growth()) > 1e-10 * greatest_of(at) ? m.growth() : 0.0;
}

std::string state_of(const ModesAt& at, const Mode& m) {
  if (m.rigid) return "rigid";
  if (unstable(at, m)) return m.eigenvalue.imag() == 0 ? "diverges" : "flutters";
  return m.eigenvalue.imag() == 0 ? "overdamped" : "stable";
}

std::string component(const std::complex<double>& x) {
  if (std::abs(x) < 5e-5) return "·";
  if (std::abs(x.imag()) < 5e-5) return fmt::format("{:.4f}", x.real());
  return fmt::format("{:.4f}∠{:.0f}°", std::abs(x), std::arg(x) * 180 / std::numbers::pi);
}

}  // namespace

bool unstable(const ModesAt& at, const Mode& m) { return !m.rigid && m.growth() > 1e-10 * greatest_of(at); }

std::string dominating(const ModesAt& at, const Mode& mode) {
  return at.names[static_cast<std::size_t>(mode.dominant)];
}

std::string modes_text(const ModesOf& run, std::size_t count) {
  const ModesAt& at = run.points.front();
  count = std::min(count, at.modes.size());
  TextTable table({"mode", "frequency\n[rad/s]", "\n[Hz]", "damping\nratio", "growth\n[1/s]", "<", "<dominated by"});
  for (std::size_t i = 0; i < count; ++i) {
    const Mode& m = at.modes[i];
    table.add({std::to_string(i + 1), fmt::format("{:.6g}", m.frequency()), fmt::format("{:.6g}", hertz(m)),
               m.rigid ? "-" : fmt::format("{:.3g}", -shown_growth(at, m) / m.frequency() + 0.0),
               fmt::format("{:.3g}", shown_growth(at, m)), state_of(at, m), dominating(at, m)});
  }
  std::string text = table.str();
  if (count < at.modes.size()) text += fmt::format("{} more: --count {}\n", at.modes.size() - count, at.modes.size());
  std::vector<std::string> head = {"<shape"};
  for (std::size_t i = 0; i < count; ++i) head.push_back(std::to_string(i + 1));
  TextTable shapes(head);
  for (std::size_t s = 0; s < at.names.size(); ++s) {
    std::vector<std::string> cells = {at.names[s]};
    bool moves = false;
    for (std::size_t i = 0; i < count; ++i) {
      const std::complex<double> x = at.modes[i].shape[static_cast<Eigen::Index>(s)];
      moves = moves || x != 0.0;
      cells.push_back(component(x));
    }
    if (moves) shapes.add(std::move(cells));
  }
  return text + '\n' + shapes.str();
}

std::string sweep_text(const ModesOf& run, const std::string& label, std::size_t count) {
  std::size_t most = 0;
  const ModesAt* named = nullptr;
  for (const ModesAt& at : run.points) {
    if (named == nullptr && !at.modes.empty()) named = &at;
    most = std::max(most, at.modes.size());
  }
  count = std::min(count, most);
  std::vector<std::string> head = {label};
  for (std::size_t i = 0; i < count; ++i)
    head.push_back((i < named->modes.size() ? dominating(*named, named->modes[i]) : std::string("-")) + "\n[rad/s]");
  TextTable table(head);
  bool any_unstable = false;
  std::string problems;
  for (const ModesAt& at : run.points) {
    std::vector<std::string> cells = {fmt::format("{:.6g}", at.value)};
    for (std::size_t i = 0; i < count; ++i) {
      if (i >= at.modes.size()) {
        cells.emplace_back("-");
        continue;
      }
      const Mode& m = at.modes[i];
      const bool grows = unstable(at, m);
      any_unstable = any_unstable || grows;
      cells.push_back(grows ? fmt::format("+{:.6g}/s", m.growth()) : fmt::format("{:.6g}", m.frequency()));
    }
    table.add(std::move(cells));
    if (!at.problem.empty()) problems += fmt::format("{} = {:.6g}: {}\n", label, at.value, at.problem);
  }
  std::string text = table.str();
  if (any_unstable) text += "+x/s: unstable, grows as exp(x t)\n";
  return text + problems;
}

Json modes_json(const ModesOf& run) {
  Json points = Json::array();
  for (const ModesAt& at : run.points) {
    Json modes = Json::array();
    for (const Mode& m : at.modes) {
      Json shape = Json::object();
      for (std::size_t s = 0; s < at.names.size(); ++s) {
        const std::complex<double> x = m.shape[static_cast<Eigen::Index>(s)];
        shape[at.names[s]] = {x.real(), x.imag()};
      }
      Json j;
      j["eigenvalue"] = {m.eigenvalue.real(), m.eigenvalue.imag()};
      j["partner"] = {m.partner.real(), m.partner.imag()};
      j["frequency"] = m.frequency();
      j["hertz"] = hertz(m);
      j["squared_frequency"] = m.squared_frequency();
      j["damping_ratio"] = m.rigid ? Json() : Json(m.damping_ratio());
      j["growth"] = m.growth();
      j["state"] = state_of(at, m);
      j["dominated_by"] = dominating(at, m);
      j["shape"] = std::move(shape);
      modes.push_back(std::move(j));
    }
    Json point;
    point["value"] = at.value;
    point["steady"] = at.steady;
    point["problem"] = at.problem;
    point["modes"] = std::move(modes);
    points.push_back(std::move(point));
  }
  return {{"formulation", run.formulation}, {"points", std::move(points)}};
}

std::string modes_csv(const std::vector<ModesOf>& runs, const std::string& label) {
  std::string text = "formulation," + label +
                     ",branch,dominated_by,frequency[rad/s],frequency[Hz],squared_frequency[1/s^2],damping_ratio,"
                     "real[1/s],imaginary[rad/s],state\n";
  for (const ModesOf& run : runs) {
    for (const ModesAt& at : run.points) {
      for (std::size_t i = 0; i < at.modes.size(); ++i) {
        const Mode& m = at.modes[i];
        text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", run.formulation, at.value, i + 1, dominating(at, m),
                            m.frequency(), hertz(m), m.squared_frequency(),
                            m.rigid ? std::string() : fmt::format("{}", m.damping_ratio()), m.eigenvalue.real(),
                            m.eigenvalue.imag(), state_of(at, m));
      }
    }
  }
  return text;
}

std::string modes_svg(const std::vector<ModesOf>& runs, const std::string& title, const std::string& label,
                      std::size_t count) {
  Panel frequencies{label, "frequency [rad/s]", {0, 0}, {}, 420};
  Panel growths{label, "growth [1/s]", {0, 0}, {}, 160};
  std::vector<std::string> legend;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    legend.push_back(runs[r].formulation);
    for (std::size_t i = 0; i < count; ++i) {
      Curve frequency, growth;
      frequency.pen = growth.pen = r;
      for (const ModesAt& at : runs[r].points) {
        if (i >= at.modes.size()) continue;
        const Mode& m = at.modes[i];
        frequency.x.push_back(at.value);
        frequency.y.push_back(m.eigenvalue.imag());
        growth.x.push_back(at.value);
        growth.y.push_back(unstable(at, m) ? m.growth() : 0.0);
        frequencies.y_range.second = std::max(frequencies.y_range.second, frequency.y.back());
        growths.y_range.second = std::max(growths.y_range.second, growth.y.back());
      }
      if (frequency.x.empty()) continue;
      frequencies.curves.push_back(std::move(frequency));
      growths.curves.push_back(std::move(growth));
    }
  }
  std::vector<Panel> panels = {std::move(frequencies)};
  if (growths.y_range.second > 0) panels.push_back(std::move(growths));
  return svg_plot(title, legend, panels);
}

}  // namespace withy::app
