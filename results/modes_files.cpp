#include "withy/results/modes_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "withy/results/blade_branches.hpp"
#include "withy/results/effective_mass_files.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/mounted_damping_files.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/report/modes_page.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/svg_plot.hpp"
#include "withy/scene/units.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

double hertz(const Mode& m) { return m.frequency() / (2 * std::numbers::pi); }

/// The steady state that modes are about.
Json found_json(const study::ModesAt& at) {
  Json j = steady_json(*at.model, at.steady->steady, at.steady->held);
  if (at.steady->stays) {
    j["stays_steady"] = *at.steady->stays;
    j["derivatives"] = at.steady->derivatives;
  }
  return j;
}

/// \param branches of each mode along a sweep; empty: nobody followed them
Json exponents_json(const std::vector<study::NamedMode>& modes, const std::vector<std::size_t>& branches = {}) {
  Json list = Json::array();
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const study::NamedMode& m = modes[i];
    Json lines = Json::array();
    for (const auto& [frequency, share] : m.lines) lines.push_back({{"frequency", frequency}, {"share", share}});
    list.push_back({{"exponent", {m.exponent.real(), m.exponent.imag()}},
                    {"dominated_by", m.dominated_by},
                    {"resolved", m.resolved},
                    {"lines", std::move(lines)}});
    if (!branches.empty()) list.back()["branch"] = branches[i] + 1;
  }
  return list;
}

/// What a turn says of the modes.
Json turn_json(const study::TurningModes& turn) {
  Json j;
  j["period"] = turn.check.turning.period > 0 ? Json(turn.check.turning.period) : Json();
  j["periodic"] = turn.check.periodic();
  j["change"] = turn.check.change;
  j["balanced"] = turn.check.steady;
  j["problem"] = turn.problem.empty() ? turn.check.turning.problem : turn.problem;
  // Whose motion or change makes the state an instant, by name: what the text tells in sentences.
  j["passing"] = turn.passing;
  j["uneven"] = turn.uneven;
  j["timed"] = turn.timed;
  j["shaking"] = turn.shaking;
  j["commanding"] = turn.commanding;
  j["sampled"] = turn.sampled;
  j["narrow"] = turn.narrow.empty() ? Json() : Json(turn.narrow);
  if (turn.floquet)
    j["floquet"] = {{"stable", turn.floquet->stable},
                    {"resolution", turn.floquet->resolution},
                    {"exponents", exponents_json(turn.floquet->modes)}};
  if (turn.blades)
    j["multiblade"] = {{"blades", turn.blades->blades},
                       {"change", turn.blades->change},
                       {"modes", exponents_json(turn.blades->modes, turn.blades->branches)}};
  if (!turn.blade_problem.empty()) j["blade_problem"] = turn.blade_problem;
  return j;
}

/// The head of a column of values, "spin.shaft[rpm]".
std::string swept_column(const study::Sweep& sweep) {
  if (sweep.none()) return "value";
  const std::string unit = sweep.shown_unit();
  return unit.empty() ? sweep.path : sweep.path + '[' + unit + ']';
}

constexpr double growth_height = 160;

void include_growth(Panel& growths, double growth) {
  growths.y_range.first = std::min(growths.y_range.first, growth);
  growths.y_range.second = std::max(growths.y_range.second, growth);
}

/// Both panels, the second where something grows. What decays by far faster than anything grows leaves the picture: the
/// axis shows where growth begins.
std::vector<Panel> with_growth(Panel frequencies, Panel growths) {
  constexpr double far = 4;
  std::vector<Panel> panels = {std::move(frequencies)};
  auto& [least, greatest] = growths.y_range;
  if (!(greatest > 0)) return panels;
  least = std::max(least, -far * greatest);
  panels.push_back(std::move(growths));
  return panels;
}

/// A branch of equal blades, with gaps where it has no mode.
struct BladeCurves {
  Curve frequency, growth;
};

BladeCurves blade_curves(const study::ModesOf& run, const BladeBranch& branch, std::size_t pen) {
  BladeCurves curves;
  Curve& f = curves.frequency;
  std::size_t next = 0;  // value that would go on without a gap
  for (std::size_t k = 0; k < branch.at.size(); ++k) {
    if (branch.at[k] == nullptr) continue;
    const std::complex<double> exponent = branch.at[k]->exponent;
    if (!f.x.empty() && k > next) f.behind_gaps.push_back(f.x.size());
    next = k + 1;
    f.x.push_back(run.points[k].value);
    f.y.push_back(exponent.imag());
    curves.growth.y.push_back(
        std::abs(exponent.real()) > growth_resolution(*run.points[k].turn->blades) ? exponent.real() : 0.0);
  }
  f.pen = pen;
  f.points = f.x.size() == 1;
  Curve& g = curves.growth;
  g.x = f.x, g.pen = f.pen, g.points = f.points, g.behind_gaps = f.behind_gaps;
  return curves;
}

/// |slope · x| for x from `low` to `high`, where it is below `top`: one curve, or two that meet at zero.
Curve multiple_of_rate(double low, double high, double slope, double top) {
  Curve line;
  if (!(slope > 0 && top > 0)) return line;
  const double reach = top / slope;
  const auto add = [&](double x) {
    line.x.push_back(x);
    line.y.push_back(std::abs(slope * x));
  };
  if (low < 0 && high > -reach) add(std::max(low, -reach));
  if (low <= 0 && high >= 0) add(0);
  if (low < 0 && high < 0 && high > -reach) add(high);
  if (low > 0 && low < reach) add(low);
  if (high > 0 && low < reach) add(std::min(high, reach));
  return line;
}

}  // namespace

Json steady_json(const Model& model, const SteadyState& steady, const Held& held) {
  const std::vector<std::string>& names = model.layout().speed_names;
  Json efforts = Json::object();
  double left = 0;
  for (std::size_t s = 0; s < held.size(); ++s) {
    const double effort = steady.efforts[static_cast<Eigen::Index>(s)];
    if (held[s])
      efforts[names[s]] = effort;
    else
      left = std::max(left, std::abs(effort));
  }
  Json j;
  j["converged"] = steady.converged;
  j["iterations"] = steady.iterations;
  j["relaxations"] = steady.relaxations;
  j["strayed"] = steady.strayed;
  j["residual"] = left;
  j["efforts"] = std::move(efforts);
  if (model.layout().continuous > 0) {
    j["state_rates"] = Json::object();
    for (std::size_t i = 0; i < model.layout().continuous; ++i)
      j["state_rates"][model.layout().continuous_names[i]] = steady.rates[static_cast<Eigen::Index>(i)];
  }
  if (steady.renewed.size() > 0) {
    const std::vector<std::string> held_names = study::sampled_names(model);
    for (std::size_t i = 0; i < held_names.size(); ++i)
      j["changed_by_a_sample"][held_names[i]] = steady.renewed[static_cast<Eigen::Index>(i)];
  }
  j["state"] = Json::parse(write_state(model, steady.state));
  return j;
}

Json against_json(const std::optional<study::AgainstNext>& against) {
  if (!against) return {};
  return {{"formulation", against->formulation},
          {"most", against->problem.empty() ? Json(against->most) : Json()},
          {"of", against->of},
          {"compared", against->compared},
          {"problem", against->problem}};
}

Json modes_json(const study::ModesOf& run) {
  Json points = Json::array();
  for (const study::ModesAt& at : run.points) {
    Json modes = Json::array();
    for (std::size_t i = 0; i < at.modes.size(); ++i) {
      const Mode& m = at.modes[i];
      Json shape = Json::object();
      for (std::size_t s = 0; s < at.names.size(); ++s) {
        const std::complex<double> x = m.shape[static_cast<Eigen::Index>(s)];
        shape[at.names[s]] = {x.real(), x.imag()};
      }
      Json j;
      j["branch"] = at.branches[i] + 1;
      j["eigenvalue"] = {m.eigenvalue.real(), m.eigenvalue.imag()};
      j["partner"] = {m.partner.real(), m.partner.imag()};
      if (at.period > 0) {
        const std::complex<double> multiplier = std::exp(m.eigenvalue * at.period);
        j["multiplier"] = {multiplier.real(), multiplier.imag()};
      }
      j["frequency"] = m.frequency();
      j["hertz"] = hertz(m);
      j["squared_frequency"] = m.squared_frequency();
      j["damping_ratio"] = m.rigid ? Json() : Json(m.damping_ratio());
      j["growth"] = m.growth();
      j["state"] = study::behaviour(at, m);
      j["dominated_by"] = study::dominating(at, m);
      j["shape"] = std::move(shape);
      modes.push_back(std::move(j));
    }
    Json point;
    point["value"] = at.value;
    if (!at.closing.empty()) point["closing"] = at.closing;
    point["jump"] = study::jump_text(at.jump);
    point["steady"] = at.steady ? found_json(at) : Json();
    point["turn"] = at.turn ? turn_json(*at.turn) : Json();
    if (at.period > 0) point["period"] = at.period, point["forgotten"] = at.forgotten;
    point["problem"] = at.problem;
    point["bent"] = at.bent;
    point["limited"] = at.limited;
    point["modes"] = std::move(modes);
    points.push_back(std::move(point));
  }
  return {{"formulation", run.formulation}, {"points", std::move(points)}};
}

std::string modes_csv(const std::vector<study::ModesOf>& runs, const std::string& label) {
  std::string text = "formulation," + label +
                     ",branch,dominated_by,frequency[rad/s],frequency[Hz],squared_frequency[1/s^2],damping_ratio,"
                     "real[1/s],imaginary[rad/s],state\n";
  for (const study::ModesOf& run : runs) {
    for (const study::ModesAt& at : run.points) {
      for (std::size_t i = 0; i < at.modes.size(); ++i) {
        const Mode& m = at.modes[i];
        text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", run.formulation, at.value, at.branches[i] + 1,
                            study::dominating(at, m), m.frequency(), hertz(m), m.squared_frequency(),
                            m.rigid ? std::string() : fmt::format("{}", m.damping_ratio()), m.eigenvalue.real(),
                            m.eigenvalue.imag(), study::behaviour(at, m));
      }
    }
  }
  return text;
}

std::string modes_picture(const std::vector<study::ModesOf>& runs, const std::string& title, const std::string& label,
                          std::size_t count) {
  Panel frequencies{label, "damped frequency [rad/s]", {0, 0}, {}, 420};
  Panel growths{label, "growth [1/s]", {0, 0}, {}, growth_height};
  std::vector<std::string> legend;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    // One formulation: a colour a branch, named after what dominates it at first. Several: a colour a formulation.
    if (runs.size() > 1) legend.push_back(runs[r].formulation);
    for (std::size_t i = 0; i < count; ++i) {
      Curve frequency, growth;
      frequency.pen = growth.pen = runs.size() > 1 ? r : i;
      if (runs.size() == 1) {
        const std::string name = runs[r].name(i);
        if (name.empty()) continue;
        legend.push_back(name);
      }
      for (const study::ModesAt& at : runs[r].points) {
        const Mode* mode = at.on(i);
        if (mode == nullptr) continue;
        const Mode& m = *mode;
        frequency.x.push_back(at.value);
        frequency.y.push_back(m.eigenvalue.imag());
        growth.x.push_back(at.value);
        growth.y.push_back(study::resolved_growth(at, m));
        frequencies.y_range.second = std::max(frequencies.y_range.second, frequency.y.back());
        include_growth(growths, growth.y.back());
      }
      if (frequency.x.empty()) continue;
      frequencies.curves.push_back(std::move(frequency));
      growths.curves.push_back(std::move(growth));
    }
  }
  return svg_plot(title, legend, with_growth(std::move(frequencies), std::move(growths)));
}

Json modes_study_json(const std::string& scene, const study::Sweep& sweep, const study::ModesFound& found) {
  Json j;
  j["scene"] = scene;
  j["sweep"] = sweep.none() ? Json() : Json(sweep.path);
  if (!sweep.none()) j["unit"] = sweep.shown_unit().empty() ? Json() : Json(sweep.shown_unit());
  j["runs"] = Json::array();
  for (std::size_t i = 0; i < found.runs.size(); ++i) {
    j["runs"].push_back(modes_json(found.runs[i]));
    j["runs"].back()["against_next"] = against_json(found.against[i]);
  }
  if (found.interrupted) j["interrupted"] = true;
  if (found.masses) j["effective_mass"] = effective_mass_json(*found.masses);
  if (found.damping) j["damping"] = mounted_damping_json(*found.damping);
  return j;
}

bool sees_blades(const std::vector<study::ModesOf>& runs) {
  return std::any_of(runs.begin(), runs.end(), [](const study::ModesOf& run) { return blades_seen(run) > 0; });
}

std::string blades_csv(const std::vector<study::ModesOf>& runs, const std::string& label) {
  std::string text =
      "formulation," + label + ",mode,dominated_by,frequency[rad/s],frequency[Hz],damping_ratio,growth[1/s],branch\n";
  for (const study::ModesOf& run : runs) {
    for (const study::ModesAt& at : run.points) {
      if (!at.turn || !at.turn->blades) continue;
      for (std::size_t i = 0; i < at.turn->blades->modes.size(); ++i) {
        const study::NamedMode& m = at.turn->blades->modes[i];
        const double size = std::abs(m.exponent);
        text += fmt::format("{},{},{},{},{},{},{},{},{}\n", run.formulation, at.value, i + 1, m.dominated_by,
                            m.exponent.imag(), m.exponent.imag() / (2 * std::numbers::pi),
                            size > 0 ? fmt::format("{}", -m.exponent.real() / size) : std::string(), m.exponent.real(),
                            at.turn->blades->branches[i] + 1);
      }
    }
  }
  return text;
}

std::string blades_picture(const std::vector<study::ModesOf>& runs, const std::string& title, const study::Sweep& sweep,
                           std::size_t count) {
  Panel frequencies{swept_label(sweep), "frequency, from where the rotor does not turn [rad/s]", {0, 0}, {}, 420};
  Panel growths{swept_label(sweep), "growth [1/s]", {0, 0}, {}, growth_height};
  std::vector<std::string> legend;
  std::size_t blades = 0;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const study::ModesOf& run : runs) {
    for (const study::ModesAt& at : run.points) low = std::min(low, at.value), high = std::max(high, at.value);
    blades = std::max(blades, blades_seen(run));
    for (const BladeBranch& branch : blade_branches(run, count)) {
      BladeCurves curves = blade_curves(run, branch, legend.size());
      for (const double y : curves.frequency.y) frequencies.y_range.second = std::max(frequencies.y_range.second, y);
      for (const double y : curves.growth.y) include_growth(growths, y);
      legend.push_back(runs.size() > 1 ? run.formulation + ", " + branch.name : branch.name);
      frequencies.curves.push_back(std::move(curves.frequency));
      growths.curves.push_back(std::move(curves.growth));
    }
  }
  if (!sweep.spun().empty()) {
    const double unit = sweep.unit.empty() ? 1 : read_any_quantity("1 " + sweep.unit).value.value_or(0);
    for (const std::size_t times : {std::size_t{1}, blades, 2 * blades}) {
      Curve line = multiple_of_rate(low, high, unit * static_cast<double>(times), frequencies.y_range.second);
      if (line.x.size() < 2) continue;
      line.pen = legend.size();
      legend.push_back(times == 1 ? "once a turn" : fmt::format("{} times a turn", times));
      frequencies.curves.push_back(std::move(line));
    }
  }
  return svg_plot(title, legend, with_growth(std::move(frequencies), std::move(growths)));
}

void write_modes(const std::filesystem::path& folder, const std::vector<study::ModesOf>& runs, const Json& content,
                 const std::string& title, const study::Sweep& sweep, std::size_t count) {
  write_file(folder / "modes.json", json_text(content));
  write_file(folder / "modes.csv", modes_csv(runs, swept_column(sweep)));
  if (!sweep.none()) write_file(folder / "modes.svg", modes_picture(runs, title, swept_label(sweep), count));
  if (sees_blades(runs)) {
    write_file(folder / "blades.csv", blades_csv(runs, swept_column(sweep)));
    if (!sweep.none()) write_file(folder / "blades.svg", blades_picture(runs, title, sweep, count));
  }
  if (has_report_page()) write_study_page(folder / report_name, "modes", title, modes_page(runs, sweep, count));
}

}  // namespace withy
