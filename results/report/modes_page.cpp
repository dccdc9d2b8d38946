#include "withy/results/report/modes_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <set>

#include "withy/results/blade_branches.hpp"
#include "withy/scene/units.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_shares = 8;
constexpr std::size_t least_branches = 10;

/// A shape in which equal numbers of coordinates that move alone are equal kinetic energies.
Eigen::VectorXcd weighted(const study::ModesAt& at, const Mode& mode) {
  return mode.shape.cwiseProduct(at.masses.cwiseAbs().cwiseSqrt().cast<std::complex<double>>());
}

double likeness(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
  const double sizes = a.squaredNorm() * b.squaredNorm();
  return a.size() == b.size() && sizes > 0 ? std::norm(a.dot(b)) / sizes : 0;
}

/// The shares of the kinetic energy, the greatest sizes first: name, share, phase [deg] against the first.
Json shares_json(const study::ModesAt& at, const Mode& mode) {
  const Eigen::VectorXd sizes = mode.shares.cwiseAbs();
  std::vector<Eigen::Index> order(static_cast<std::size_t>(sizes.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return sizes[a] > sizes[b]; });
  Json list = Json::array();
  if (sizes.isZero(0)) return list;  // nothing moves: a state of a load alone
  for (std::size_t k = 0; k < std::min(order.size(), most_shares); ++k) {
    const double share = mode.shares[order[k]];
    if (k > 0 && !(std::abs(share) > 1e-3)) break;
    const double phase = std::arg(mode.shape[order[k]] / mode.shape[order[0]]) * 180 / std::numbers::pi;
    list.push_back({at.names[static_cast<std::size_t>(order[k])], share, std::round(phase)});
  }
  return list;
}

Json branch_json(const study::ModesOf& run, std::size_t branch) {
  Json values = Json::array();
  Eigen::VectorXcd first;
  for (const study::ModesAt& at : run.points) {
    const Mode* on = at.on(branch);
    if (on == nullptr) {
      values.push_back(nullptr);
      continue;
    }
    const Mode& m = *on;
    const Eigen::VectorXcd shape = weighted(at, m);
    if (first.size() == 0) first = shape;
    values.push_back({{"value", at.value},
                      {"hertz", m.eigenvalue.imag() / (2 * std::numbers::pi)},
                      {"natural", m.frequency() / (2 * std::numbers::pi)},
                      {"damping_ratio", m.rigid ? Json() : Json(m.damping_ratio())},
                      {"growth", m.growth()},
                      {"unstable", study::unstable(at, m)},
                      {"state", study::behaviour(at, m)},
                      {"dominated_by", study::dominating(at, m)},
                      {"mac", likeness(first, shape)},
                      {"shape", shares_json(at, m)}});
  }
  return {{"number", branch + 1}, {"at", std::move(values)}};
}

std::string state_of(const study::BladeModes& seen, const study::NamedMode& m) {
  constexpr double constant = 1e-9;
  const bool growing = grows(seen, m);
  if (seen.change >= constant) return growing ? "grows on average" : "decays on average";
  if (m.exponent.imag() == 0) return growing ? "diverges" : "decays";
  return growing ? "flutters" : "stable";
}

/// Of one configuration the exponents of a whole turn; null where nobody asked or there are none.
Json floquet_json(const study::ModesOf& run) {
  if (run.points.size() != 1 || !run.points[0].turn || !run.points[0].turn->floquet) return {};
  const study::FloquetModes& found = *run.points[0].turn->floquet;
  Json modes = Json::array();
  for (const study::NamedMode& m : found.modes) {
    Json lines = Json::array();
    for (std::size_t i = 1; i < m.lines.size(); ++i)
      lines.push_back({std::abs(m.lines[i].first) / (2 * std::numbers::pi), m.lines[i].second});
    modes.push_back({{"hertz", m.exponent.imag() / (2 * std::numbers::pi)},
                     {"growth", std::abs(m.exponent.real()) > found.resolution ? m.exponent.real() : 0.0},
                     {"resolved", m.resolved},
                     {"dominated_by", m.dominated_by},
                     {"lines", std::move(lines)}});
  }
  return {{"stable", found.stable}, {"resolution", found.resolution}, {"modes", std::move(modes)}};
}

/// Equal blades seen from where the rotor does not turn; null where none were.
Json blades_json(const study::ModesOf& run, std::size_t count) {
  Json branches = Json::array();
  for (const BladeBranch& branch : blade_branches(run, std::max(count, least_branches))) {
    Json values = Json::array();
    for (std::size_t k = 0; k < branch.at.size(); ++k) {
      if (branch.at[k] == nullptr) {
        values.push_back(nullptr);
        continue;
      }
      const study::NamedMode& m = *branch.at[k];
      const study::BladeModes& seen = *run.points[k].turn->blades;
      const bool swings = m.exponent.imag() > 0;
      values.push_back({{"value", run.points[k].value},
                        {"hertz", m.exponent.imag() / (2 * std::numbers::pi)},
                        {"damping_ratio", swings ? Json(-m.exponent.real() / std::abs(m.exponent)) : Json()},
                        {"growth", m.exponent.real()},
                        {"unstable", grows(seen, m)},
                        {"state", state_of(seen, m)},
                        {"dominated_by", m.dominated_by}});
    }
    branches.push_back({{"number", branch.number + 1}, {"at", std::move(values)}});
  }
  const std::size_t blades = blades_seen(run);
  return blades == 0 ? Json() : Json{{"count", blades}, {"branches", std::move(branches)}};
}

/// Branches are followed from the first value and have the numbers of modes.csv; those of rigid motion alone are left
/// out, and counted.
Json run_json(const study::ModesOf& run, std::size_t count) {
  Json branches = Json::array();
  std::size_t rigid = 0;
  for (std::size_t b = 0; b < run.branches(); ++b) {
    const bool moves = std::any_of(run.points.begin(), run.points.end(),
                                   [b](const study::ModesAt& at) { return at.on(b) != nullptr && !at.on(b)->rigid; });
    if (!moves) ++rigid;
    if (moves && branches.size() < std::max(count, least_branches)) branches.push_back(branch_json(run, b));
  }
  return {{"formulation", run.formulation},
          {"branches", std::move(branches)},
          {"rigid", rigid},
          {"blades", blades_json(run, count)},
          {"floquet", floquet_json(run)}};
}

/// Each text once, without empty ones.
Json once(const std::vector<std::string>& texts) {
  std::set<std::string> said;
  Json list = Json::array();
  for (const std::string& text : texts)
    if (!text.empty() && said.insert(text).second) list.push_back(text);
  return list;
}

/// What must be known to read the picture.
Json remarks_json(const std::vector<study::ModesOf>& runs) {
  std::vector<std::string> texts;
  for (const study::ModesOf& run : runs)
    for (const study::ModesAt& at : run.points)
      if (!at.problem.empty()) texts.push_back(fmt::format("{}: {}", run.formulation, at.problem));
  for (const study::ModesOf& run : runs)
    if (const std::string words = study::sampling_text(run); !words.empty()) texts.push_back(words);
  return once(texts);
}

/// That modes are those of one angle of what turns, and what that does not tell.
Json frozen_json(const std::vector<study::ModesOf>& runs) {
  std::vector<std::string> texts;
  for (const study::ModesOf& run : runs) {
    const auto frozen = std::find_if(run.points.begin(), run.points.end(), [](const auto& at) { return at.frozen(); });
    if (frozen != run.points.end()) texts.push_back(study::turn_text(*frozen->turn));
  }
  return once(texts);
}

}  // namespace

std::string swept_label(const study::Sweep& sweep) {
  const std::string unit = sweep.shown_unit();
  return sweep.path + (unit.empty() ? "" : " [" + unit + "]");
}

Json modes_page(const std::vector<study::ModesOf>& runs, const study::Sweep& sweep, std::size_t count) {
  Json values = Json::array(), all = Json::array();
  for (const study::ModesAt& at : runs.front().points) values.push_back(at.value);
  for (const study::ModesOf& run : runs) all.push_back(run_json(run, count));
  const bool loops = std::any_of(runs.front().points.begin(), runs.front().points.end(), [](const study::ModesAt& at) {
    return at.period > 0 || (at.model != nullptr && at.model->layout().continuous > 0);
  });
  Json rate;  // of a rotor: rad/s in one unit of what is swept
  if (!sweep.spun().empty()) {
    rate = 1.0;
    if (!sweep.unit.empty()) rate = read_any_quantity("1 " + sweep.unit).value.value_or(0);
  }
  return {{"points", runs.front().points.size()},
          {"label", swept_label(sweep)},
          {"rate", std::move(rate)},
          {"loops", loops},
          {"values", std::move(values)},
          {"remarks", remarks_json(runs)},
          {"frozen", frozen_json(runs)},
          {"runs", std::move(all)}};
}

}  // namespace withy
