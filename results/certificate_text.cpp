#include "withy/results/certificate_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "withy/core/model/columns.hpp"

namespace withy {
namespace {

std::string percent(double ratio) { return fmt::format("{:.2g} %", 100 * ratio); }

std::string error_text(const study::ErrorEstimate& e, const Model& model) {
  std::string out;
  for (const HingeNode& hinge : model.hinges()) {
    const auto found = e.distances.hinges.find(hinge.name);
    if (found == e.distances.hinges.end()) continue;
    const auto columns = coordinate_columns(hinge);
    const std::string unit = columns.size() == 1 ? columns[0].unit : "";
    out += out.empty() ? "" : ", ";
    out += hinge.name + ' ';
    out += unit == "rad" ? fmt::format("{:.2g} deg", found->second * 180 / std::numbers::pi)
                         : fmt::format("{:.2g}{}", found->second, unit.empty() ? "" : ' ' + unit);
  }
  for (const auto* const lengths : {&e.distances.tips, &e.distances.deflections})
    for (const auto& [name, d] : *lengths) out += fmt::format("{}{} {:.2g} mm", out.empty() ? "" : ", ", name, 1e3 * d);
  for (const auto& [name, d] : e.distances.moments)
    out += fmt::format("{}{} {:.2g} N m", out.empty() ? "" : ", ", name, d);
  for (const auto& [name, d] : e.distances.forces)
    out += fmt::format("{}{} {:.2g} N", out.empty() ? "" : ", ", name, d);
  if (out.empty()) return "no hinge moves and no body has a tip";
  out = fmt::format("against {}, estimated by a coarse run of both: {}", e.against, out);
  if (e.distances.until < e.end)
    out += fmt::format("; up to {:.4g} s, where the estimate's budget ended", e.distances.until);
  return out;
}

std::string body_text(const BodyValidity& b, const RunSummary& summary) {
  std::string out =
      fmt::format("turns at {:.2g} of its fundamental frequency {:.4g} rad/s", b.rate_ratio, b.fundamental);
  if (b.load.size() > 0) {
    const std::size_t most = study::greatest_share(b.load);
    out += fmt::format("; {} load {:.2g} of the buckling load, most of it from {}",
                       b.load.greatest > -b.load.least ? "stiffening" : "compressive", b.load.size(),
                       motion_term_name(most));
  }
  if (const auto d = summary.peak_deflection_ratio.find(b.name); d != summary.peak_deflection_ratio.end())
    out += fmt::format("; tip deflection {:.2g} of its length", d->second);
  for (const HighestMode& h : b.highest)
    if (h.modes > 1)
      out += fmt::format("; highest of {} {} modes has {} of their energy", h.modes, h.family, percent(h.share));
  return out;
}

std::vector<std::string> plan_text(const study::Certificate& certificate) {
  std::vector<std::string> lines;
  if (!certificate.plan) return lines;
  const study::RungPlan& plan = *certificate.plan;
  for (const study::PlannedStretch& s : plan.stretches)
    lines.push_back(fmt::format("{} from {:.4g} to {:.4g} s", certificate.rungs[s.stretch.rung], s.stretch.start,
                                s.stretch.end));
  if (plan.estimate)
    lines.push_back(fmt::format("asked {:.3g} % of each output's own range; estimated {:.2g} % of that of {}",
                                100 * plan.accuracy, 100 * plan.accuracy * plan.use, plan.worst));
  return lines;
}

}  // namespace

std::string step_limit_text(const study::StepLimit& s) {
  if (!s.limit) return fmt::format("mean step times fastest mode {:.2g}", s.product);
  if (std::isinf(*s.limit))
    return fmt::format("limited by {}: mean step times fastest mode {:.2g}, stable at any step", s.cause(), s.product);
  std::string text = fmt::format("limited by {}: mean step times fastest mode {:.2g}, stable to {:.3g}", s.cause(),
                                 s.product, *s.limit);
  if (!s.maker.empty() && s.cause() == "stability") text += "; the fastest pole is " + s.maker;
  if (s.fewer && s.fewer->fastest > 0 && s.fewer->fastest < s.fastest)
    text +=
        fmt::format("; without {} the fastest mode is {:.3g} rad/s in place of {:.3g}, for steps {:.2g} times as long",
                    s.fewer->mode, s.fewer->fastest, s.fastest, s.fastest / s.fewer->fastest);
  if (!s.unlimited.empty()) text += fmt::format("; no vibration limits the steps of {}", fmt::join(s.unlimited, ", "));
  return text;
}

std::string certificate_text(const Model& model, const RunSummary& summary, const study::Certificate& certificate) {
  std::string out = "\ncertificate\n";
  const auto line = [&out](const std::string& what, const std::string& text) {
    out += fmt::format("{:<23} {}\n", what, text);
  };
  line("modelled", certificate.meaning);
  for (const study::OwnFormulation& own : certificate.own)
    line("", fmt::format("but '{}' in {}: {}", own.body, own.formulation, own.meaning));
  if (!certificate.own.empty())
    line("",
         "a mix conserves no more than each of its formulations does, and may be further off than any of them alone");
  for (const std::string& text : plan_text(certificate)) line("", text);
  line("energy", fmt::format("off by {} of the greatest{}", percent(certificate.energy_drift),
                             certificate.untruncated_drift > 2 * certificate.energy_drift
                                 ? fmt::format("; the energy without truncation by {}, which the model leaves out",
                                               percent(certificate.untruncated_drift))
                                 : ""));
  if (certificate.momentum.conserved)
    line("momentum", fmt::format("linear off by {}, angular by {}: nothing outside acts on the tree, and it is to be "
                                 "conserved",
                                 percent(certificate.momentum.linear), percent(certificate.momentum.angular)));
  const NeglectedAcceleration& n = certificate.neglected;
  if (!certificate.against.empty() && n.samples > 0) {
    line("left out", fmt::format("{} of the accelerations in the mean, {} at the peaks, against {} ({} samples)",
                                 percent(n.rms), percent(n.peak), certificate.against, n.samples));
  }
  if (certificate.estimate) line("error", error_text(*certificate.estimate, model));
  for (const BodyValidity& b : certificate.bodies) line(b.name, body_text(b, summary));
  if (!certificate.indicators.empty()) {
    const study::Indicator& first = certificate.indicators.front();
    line("binds", fmt::format("{}: {:.2g}, limit {:.3g}{}", first.text, first.value, first.limit,
                              first.use() > 1 ? "; beyond it " + first.meaning : ""));
  }
  if (certificate.steps.product > 0) line("steps", step_limit_text(certificate.steps));
  return out;
}

}  // namespace withy
