#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "withy/results/response_files.hpp"
#include "withy/results/text_table.hpp"
#include "withy/study/at_limits.hpp"
#include "withy/study/formulation_meaning.hpp"

namespace withy {
namespace {

using Complex = std::complex<double>;

/// Roots of each kind that are shown; the JSON has all.
constexpr std::size_t most_roots = 20;

std::string hertz_text(double omega) {
  return std::isfinite(omega) ? fmt::format("{:.5g} Hz", omega / (2 * std::numbers::pi)) : "infinite frequency";
}

std::string gain_words(const GainMargin& g) {
  return fmt::format("the gain may {} to {:.4g} times ({:+.1f} dB) at {}", g.factor > 1 ? "rise" : "fall", g.factor,
                     20 * std::log10(g.factor), hertz_text(g.omega));
}

std::string angle_words(double angle) { return fmt::format("{:.1f}°", std::abs(angle) * 180 / std::numbers::pi); }

/// Of a stable loop: the phase either way, and the delay, which need not be reached at the same frequency.
std::string phase_words(const Margins& m, bool sampled) {
  std::string text;
  if (m.lag() != nullptr)
    text = fmt::format(", the phase may lag by {} at {}", angle_words(m.lag()->angle), hertz_text(m.lag()->omega));
  if (m.lead() != nullptr)
    text += fmt::format("{} lead by {} at {}", m.lag() != nullptr ? " or" : ", the phase may",
                        angle_words(m.lead()->angle), hertz_text(m.lead()->omega));
  if (const std::optional<int> samples = m.samples())
    text += *samples > 0 ? fmt::format(", the delay may grow by {} sample{} ({:.3g} ms), not by one more", *samples,
                                       *samples > 1 ? "s" : "", 1e3 * *samples * m.period)
                         : ", the delay may not grow by a whole sample";
  else if (m.delay() != nullptr)
    text +=
        fmt::format(", the delay may grow by {:.3g} ms at {}", 1e3 * m.delay()->delay, hertz_text(m.delay()->omega));
  if (!sampled && m.last >= 1)
    text += fmt::format(", no delay at all: the loop's gain at infinite frequency is {:.4g}, not below 1", m.last);
  return text;
}

/// "stable: …", or what grows.
std::string loop_words(const Margins& m, bool sampled) {
  if (m.hidden_growth > 0)
    return fmt::format("unstable: a pole that the loop does not move grows at {:.4g}/s, at any gain", m.hidden_growth);
  if (!m.stable)
    return std::isfinite(m.growth) && m.growth > 0 ? fmt::format("unstable, growing at {:.4g}/s", m.growth)
                                                   : "on the edge of stability";
  std::string text;
  if (m.upper() != nullptr) text += ", " + gain_words(*m.upper());
  if (m.lower() != nullptr) text += ", " + gain_words(*m.lower());
  text += phase_words(m, sampled);
  const bool any = m.upper() == nullptr && m.lower() == nullptr;
  return (any ? "stable at any gain" : "stable") + (text.empty() ? "" : ": " + text.substr(2));
}

std::string unit_of(const study::Response& r) {
  const std::string &out = r.model.outputs[0].unit, &in = r.model.inputs[0].unit;
  if (out == in || (out.empty() && in.empty())) return "";
  const auto named = [](const std::string& unit) { return unit.empty() || unit == "1" ? std::string("1") : unit; };
  return fmt::format(" ({})/({})", named(out), named(in));
}

std::string static_words(const study::Response& r) {
  if (r.integrators == 0) return fmt::format("static gain {:.5g}{}", r.static_gain, unit_of(r));
  return fmt::format("static gain infinite: {:.5g}/s{} for slow inputs", r.static_gain,
                     r.integrators > 1 ? fmt::format("^{}", r.integrators) : "");
}

std::string peak_words(const study::Response& r) {
  const auto greatest = std::max_element(r.peaks.begin(), r.peaks.end(), [](const Peak& a, const Peak& b) {
    return a.height.value_or(INFINITY) < b.height.value_or(INFINITY);
  });
  if (greatest == r.peaks.end()) return "no resonance";
  return greatest->height
             ? fmt::format("highest resonance {:.5g} at {}", *greatest->height, hertz_text(greatest->omega))
             : fmt::format("undamped resonance at {}", hertz_text(greatest->omega));
}

/// One row a root, of pairs the upper one.
std::string root_rows(const study::Response& r, const Eigen::VectorXcd& roots, bool poles) {
  const LinearSystem& s = r.model.system;
  std::vector<Eigen::Index> order;
  for (Eigen::Index i = 0; i < roots.size(); ++i)
    if (!(exponent_of(s, roots[i]).imag() < 0)) order.push_back(i);
  if (order.empty()) return "";
  const auto size = [&](Eigen::Index i) { return std::abs(exponent_of(s, roots[i])); };
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return size(a) < size(b); });
  std::vector<std::string> head = {poles ? "pole\n[Hz]" : "zero\n[Hz]", "damping", "value\n[1/s]"};
  if (s.sampled()) head.emplace_back("|multiplier|");
  if (!s.sampled() && poles) head.emplace_back("share of\nstatic");
  TextTable table(head);
  if (order.size() > most_roots) order.resize(most_roots);
  for (const Eigen::Index i : order) {
    const Complex root = exponent_of(s, roots[i]);
    std::vector<std::string> row = {
        fmt::format("{:.5g}", std::abs(root) / (2 * std::numbers::pi)),
        root == 0.0 || !std::isfinite(root.real()) ? "-" : fmt::format("{:.4g}", -root.real() / std::abs(root) + 0.0),
        fmt::format("{:.5g}{}", root.real(), root.imag() > 0 ? fmt::format(" ± {:.5g}i", root.imag()) : "")};
    if (s.sampled()) row.push_back(fmt::format("{:.6f}", std::abs(roots[i])));
    if (!s.sampled() && poles)
      row.push_back(
          fmt::format("{:.2f} %", (root.imag() > 0 ? 200 : 100) * r.participation[static_cast<std::size_t>(i)]));
    table.add(std::move(row));
  }
  return '\n' + table.str();
}

std::string peak_rows(const study::Response& r) {
  if (r.peaks.empty()) return "";
  TextTable table({"peak\n[Hz]", "height", "height\n[dB]"});
  for (const Peak& p : r.peaks)
    table.add({fmt::format("{:.5g}", p.omega / (2 * std::numbers::pi)),
               p.height ? fmt::format("{:.5g}", *p.height) : "no bound",
               p.height ? fmt::format("{:.2f}", 20 * std::log10(*p.height)) : "-"});
  return '\n' + table.str();
}

std::string margin_rows(const Margins& m) {
  std::string text;
  for (const GainMargin& g : m.gains)
    text += fmt::format("  gain {:.6g} ({:+.2f} dB) at {}\n", g.factor, 20 * std::log10(g.factor), hertz_text(g.omega));
  for (const PhaseMargin& p : m.phases)
    text += fmt::format("  {} {:.2f}° (delay {:.4g} s) at {}\n", p.angle < 0 ? "lead" : "lag",
                        std::abs(p.angle) * 180 / std::numbers::pi, p.delay, hertz_text(p.omega));
  return text;
}

}  // namespace

std::string response_text(const study::Configuration& c, const study::Response& r) {
  const LinearSystem& s = r.model.system;
  std::string text;
  if (r.opened)
    text = fmt::format("{} opened: {}\n", r.model.inputs[0].name,
                       r.model.frozen ? "its stability is not known"
                       : r.margins    ? loop_words(*r.margins, s.sampled())
                                      : "the closed loop is not well posed");
  else
    text = fmt::format("{} to {}{}: {}, {}\n", r.model.inputs[0].name, r.model.outputs[0].name,
                       r.model.frozen ? ", at this instant alone" : "", peak_words(r), static_words(r));
  text += fmt::format("{} in {}, {}{}{}\n", c.prepared().title(), study::formulation_title(c.prepared().scene),
                      s.sampled() ? fmt::format("sampled every {:g} s, the input held between samples", s.period)
                                  : "continuous in time",
                      r.model.equilibrium ? ""
                                          : "; the state is no equilibrium: this is the neighbourhood of a motion "
                                            "(withy equilibrium --out FILE keeps one for --at)",
                      r.model.output_derivatives == "exact" ? "" : "; output " + r.model.output_derivatives);
  for (const std::string& note :
       {study::note_of_frozen(r.model), study::note_of_moving(r.model),
        study::note_of_changing(r.model, c.state().time), study::at_limits_text(r.model.limited)})
    if (!note.empty()) text += note + '\n';
  if (!r.follows.empty())
    text += fmt::format(
        "The gain is that of all that {0} does, beside following {1} too, as friction: --input {2} opens the loop "
        "at the command alone\n",
        r.model.inputs[0].name, fmt::join(r.follows, " and "), r.follows.front());
  if (r.opened) text += static_words(r) + "; " + peak_words(r) + '\n';
  text += root_rows(r, r.roots.poles, true) + root_rows(r, r.roots.zeros, false) + peak_rows(r);
  if (const auto hidden = r.roots.hidden.size(); hidden > 0)
    text += fmt::format("\nleft out: {} that the input does not move or the output does not see\n",
                        hidden == 1 ? "one pole" : fmt::format("{} poles", hidden));
  if (r.margins) {
    text += fmt::format("\nLoop closed by {} = -k {}, at k = 1: {}\n", r.model.inputs[0].name,
                        r.opened ? "answer" : r.model.outputs[0].name, loop_words(*r.margins, s.sampled()));
    text += margin_rows(*r.margins);
  }
  if (r.reduction)
    text += fmt::format(
        "\nReduced from {} to {} states ({} that do not decay are kept): greatest error {:.3g}, bound {:.3g}\n",
        s.A.rows(), r.reduction->system.A.rows(), r.reduction->kept, r.reduction_error, r.reduction->bound);
  return text;
}

}  // namespace withy
