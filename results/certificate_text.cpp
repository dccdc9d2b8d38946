#include "withy/results/certificate_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

#include "withy/core/model/columns.hpp"
#include "withy/core/simulation/validity_limits.hpp"
#include "withy/scene/units.hpp"

namespace withy {
namespace {

std::string percent(double ratio) { return fmt::format("{:.{}g} %", 100 * ratio, ratio < 0.995 ? 2 : 3); }

/// A group of the ledger (docs/terms.md) for a reader who has no page at hand.
std::string_view in_words(std::string_view group) {
  using Words = std::pair<std::string_view, std::string_view>;
  static constexpr std::array<Words, 13> all = {
      Words{"M*1 a", "inertia of first order"},      {"M*2 a", "inertia of foreshortening"},
      {"M*3 a", "inertia beyond first order"},       {"f1", "forces of speeds, as of rigid bodies"},
      {"f2-1", "forces of speeds, first order"},     {"f2-2", "forces of speeds on foreshortening"},
      {"f3", "forces of speeds beyond first order"}, {"weight*1", "weight of first order"},
      {"weight*2", "weight on foreshortening"},      {"weight*3", "weight beyond first order"},
      {"loads*1", "loads of first order"},           {"loads*2", "loads on foreshortening"},
      {"loads*3", "loads beyond first order"}};
  const auto* found = std::find_if(all.begin(), all.end(), [&](const Words& w) { return w.first == group; });
  return found == all.end() ? group : found->second;
}

/// A term of the motion that stiffens or compresses a body, the same way.
std::string motion_in_words(std::size_t term) {
  constexpr const char* axes = "xyz";
  const int axis = static_cast<int>(term % 3);
  if (term < 3) return fmt::format("turning about {}", axes[axis]);
  if (term < 6) return fmt::format("turning about {} and {} at once", axes[axis], axes[(axis + 1) % 3]);
  if (term < 9) return fmt::format("angular acceleration about {}", axes[axis]);
  if (term < 12) return fmt::format("acceleration along {} and weight", axes[axis]);
  if (term + 1 < motion_terms) return "the bodies that it carries";
  return "loads at frames";
}

/// Errors of one kind, in the order of the model; of many the greatest.
class ErrorList {
 public:
  void add(double size, std::string text) { all_.push_back({size, std::move(text)}); }
  void append_to(std::string& out) {
    constexpr std::size_t most = 4;
    const std::size_t left_out = all_.size() > most ? all_.size() - most : 0;
    if (left_out > 0) {
      std::stable_sort(all_.begin(), all_.end(), [](const Error& a, const Error& b) { return a.size > b.size; });
      all_.resize(most);
    }
    for (const Error& error : all_) out += (out.empty() ? "" : ", ") + error.text;
    if (left_out > 0) out += fmt::format(", {} others no more", left_out);
  }

 private:
  struct Error {
    double size = 0;
    std::string text;
  };
  std::vector<Error> all_;
};

/// "shoulder 0.12 deg, elbow 0.3 deg; link2.tip 3.1 mm"; empty where no hinge moves and no body has a tip.
std::string distances_text(const study::NamedDistances& distances, const Model& model) {
  std::string out;
  ErrorList angles, positions;
  for (const HingeNode& hinge : model.hinges()) {
    const auto found = distances.hinges.find(hinge.name);
    if (found == distances.hinges.end()) continue;
    const auto columns = coordinate_columns(hinge);
    const std::string unit = columns.size() == 1 ? columns[0].unit : "";
    const double d = found->second;
    if (unit == "rad") {
      angles.add(d, fmt::format("{} {:.2g} deg", hinge.name, d * 180 / std::numbers::pi));
    } else {
      positions.add(d, fmt::format("{} {:.2g}{}", hinge.name, d, unit.empty() ? "" : ' ' + unit));
    }
  }
  angles.append_to(out);
  positions.append_to(out);
  const auto append = [&out](const std::map<std::string, double>& of, double factor, const char* unit) {
    ErrorList list;
    for (const auto& [name, d] : of) list.add(d, fmt::format("{} {:.2g} {}", name, factor * d, unit));
    list.append_to(out);
  };
  append(distances.tips, 1e3, "mm");
  append(distances.deflections, 1e3, "mm");
  append(distances.moments, 1, "N m");
  append(distances.forces, 1, "N");
  return out;
}

/// \param reached time [s] at which the run ended
std::string error_text(const study::ErrorEstimate& e, const Model& model, double reached) {
  std::string out = distances_text(e.distances, model);
  if (out.empty()) return "no hinge moves and no body has a tip";
  constexpr double worth_saying = 0.1;
  const std::string off =
      e.off > worth_saying ? fmt::format(" that leave this one by up to {} of a range", percent(e.off)) : "";
  out = fmt::format("against {}, estimated by coarse runs{}: {}", e.against, off, out);
  if (!e.at_most.empty())
    out += fmt::format("; the values of {} are rough upper bounds: coarse runs do not resolve them",
                       fmt::join(e.at_most, ", "));
  if (!e.lacks.empty()) out += "; " + e.lacks;
  if (e.distances.until < e.end)
    out += fmt::format("; up to {:.4g} s, to which the runs compared came", e.distances.until);
  else if (e.end < reached)
    out += fmt::format("; up to {:.4g} s, the last state that can be trusted", e.end);
  return out;
}

/// What the error does not contain; empty where no body has a number of modes.
std::string more_modes_text(const study::MoreModesOutcome& outcome, const Model& model, double reached) {
  if (!outcome.why_not.empty()) return "what too few modes add is not known: " + outcome.why_not;
  const std::string out = outcome.more ? distances_text(outcome.more->distances, model) : "";
  if (out.empty()) return "";
  const double until = outcome.more->distances.until;
  return fmt::format("too few modes: one more of each changes {}{}", out,
                     until < reached ? fmt::format("; up to {:.4g} s", until) : "");
}

/// Shares of an energy below this are rounding's.
constexpr double rounding_of_energy = 1e-12;

std::string body_text(const BodyValidity& b, const RunSummary& summary) {
  std::string out =
      b.rate_ratio > 0
          ? fmt::format("turns at {:.2g} of its lowest mounted frequency, {:.4g} rad/s", b.rate_ratio, b.fundamental)
          : fmt::format("its root does not turn; its lowest mounted frequency is {:.4g} rad/s", b.fundamental);
  if (b.load.size() > 0) {
    const std::size_t most = study::greatest_share(b.load);
    out += fmt::format("; {} load {:.2g} of the buckling load, most of it from {}",
                       b.load.stiffens ? "stiffening" : "compressive", b.load.size(), motion_in_words(most));
    if (b.load.stiffens && b.buckling > load_limit)
      out += fmt::format("; compressive load up to {:.2g} of it", b.buckling);
  }
  if (b.whole.size() > 0)
    out += fmt::format("; all segments as one piece: {} load {:.2g} of the buckling load",
                       b.whole.stiffens ? "stiffening" : "compressive", b.whole.size());
  if (const auto bend = study::greatest_bend(b, summary)) {
    out += fmt::format("; {} {:.2g} of its length", study::deflection_name(b), bend->deflection);
    if (bend->bent() && bend->by_angle()) out += fmt::format(", where the section turns by {:.2g} rad", bend->angle);
  }
  for (const HighestMode& h : b.highest)
    if (h.modes > 1)
      out += fmt::format("; highest of {} {}modes has {} of their energy", h.modes, study::before_mode(h.family),
                         h.share > rounding_of_energy ? percent(h.share) : "next to none");
  return out;
}

/// Of a drift, whose it is.
std::string whose(const study::Certificate& c, std::optional<study::DriftShare> study::DriftShares::*drift) {
  if (!c.shares) return "";
  const std::optional<study::DriftShare>& share = *c.shares.*drift;
  const double model = share ? share->model : 0, integration = share ? share->integration : 0;
  if (share && model == 0) return integration == 0 ? "" : ", all of it by integration";
  if (!share || integration >= model) return ", by the model or by integration: not told apart";
  return fmt::format(", {} by what the model leaves out and at most {} by integration", percent(model),
                     percent(integration));
}

std::string energy_text(const study::Certificate& c) {
  std::string text = fmt::format("off by {} of the greatest", percent(c.energy_drift));
  if (c.untruncated_drift > 2 * c.energy_drift)
    return text + fmt::format(" by integration; the energy without truncation by {}, which the model leaves out",
                              percent(c.untruncated_drift));
  return text + whose(c, &study::DriftShares::energy);
}

/// What the formulation drops, in shares of the greatest term on the same coordinates.
std::string dropped_text(const study::Certificate& c) {
  constexpr std::size_t named = 3;
  constexpr double worth_naming = 1e-4, worth_a_spread = 0.1;
  std::string text;
  for (const study::DroppedForces& d : c.dropped) {
    text += fmt::format("{}on {} ", text.empty() ? "" : "; ", d.group);
    // The moment says more than a spread, which is great there.
    if (!std::isfinite(d.share)) {
      text += "more than can be told, for that is beyond the range of numbers";
    } else if (!d.moment && d.spread > worth_a_spread * d.share) {
      text += fmt::format("{:.2g} ± {}", 100 * d.share, percent(d.spread));
    } else {
      text += percent(d.share);
    }
    std::string terms;
    for (std::size_t i = 0; i < std::min(named, d.terms.size()); ++i)
      if (d.terms[i].share > worth_naming && std::isfinite(d.terms[i].share))
        terms +=
            fmt::format("{}{} {}", terms.empty() ? "" : ", ", in_words(d.terms[i].term), percent(d.terms[i].share));
    if (!terms.empty()) text += fmt::format(" ({})", terms);
    if (d.moment) text += fmt::format(", most of it at {:.4g} s alone", *d.moment);
  }
  return "of the greatest force there: " + text;
}

std::vector<std::string> plan_text(const study::Certificate& certificate) {
  std::vector<std::string> lines;
  if (!certificate.plan) return lines;
  const study::RungPlan& plan = *certificate.plan;
  for (const study::PlannedStretch& s : plan.stretches)
    lines.push_back(
        fmt::format("{} from {:.4g} to {:.4g} s", certificate.rungs[s.stretch.rung], s.stretch.start, s.stretch.end));
  if (plan.throughout) {
    lines.push_back(fmt::format("asked {:.3g} % of each output's own range", 100 * plan.accuracy));
  } else if (plan.estimate) {
    lines.push_back(fmt::format("asked {:.3g} % of each output's own range; estimated {:.2g} % of that of {}",
                                100 * plan.accuracy, 100 * plan.accuracy * plan.use, plan.worst));
  }
  if (plan.estimate && !plan.above.empty())
    lines.push_back(
        fmt::format("that is against {0}: what {1} changes counts as it is at an instant, {2:.2g} % of the "
                    "range of deflections; over many vibrations, or near buckling, it comes to hundreds of "
                    "times that, which is not estimated (run it with --formulation {1} to know)",
                    plan.estimate->against, plan.above, 100 * plan.above_share));
  return lines;
}

/// A value to so many digits that it is seen on which side of its limit, of three digits, it lies.
std::string beside_limit(double value, double limit) {
  constexpr int most = 17;
  const double told = to_digits(limit, 3);
  for (int digits = 2; digits < most; ++digits) {
    const double rounded = to_digits(value, digits);
    if (value > limit ? rounded > told : rounded <= told) return fmt::format("{:.{}g}", value, digits);
  }
  return fmt::format("{:.{}g}", value, most);
}

std::string cause_text(const study::StepLimit& s) {
  if (s.cause() == "chosen") return "chosen by the integrator";
  if (s.cause() != "given") return "limited by " + s.cause();
  return s.controlled ? fmt::format("as long as the scene allows, {:.3g} s", s.longest) : "as the scene gives them";
}

}  // namespace

/// By how much longer steps have to become for a mode less to be proposed.
constexpr double worth_telling = 1.2;

std::string step_limit_text(const study::StepLimit& s) {
  if (!s.limit)
    return fmt::format("{}mean step times fastest mode {:.2g}", s.controlled ? "" : cause_text(s) + ": ", s.product);
  if (std::isinf(*s.limit))
    return fmt::format("{}: mean step times fastest mode {:.2g}, stable at any step", cause_text(s), s.product);
  std::string text =
      fmt::format("{}: mean step times fastest mode {:.2g}, stable to {:.3g}", cause_text(s), s.product, *s.limit);
  if (!s.controlled && s.product > *s.limit) text += fmt::format(", {:.2g} times that", s.product / *s.limit);
  if (s.fastest_rests()) text += ", for what is so fast rests or has just begun";
  if (!s.resting.empty()) text += fmt::format("; {}, faster at {:.3g}/s, rests and limits none", s.resting, s.fastest);
  if (!s.maker.empty() && s.cause() == "stability") text += "; the fastest pole is " + s.maker;
  if (s.fewer && s.fewer->fastest > 0 && s.moving > worth_telling * s.fewer->fastest)
    text +=
        fmt::format("; without {} the fastest mode is {:.3g} rad/s in place of {:.3g}, for steps {:.2g} times as long",
                    s.fewer->mode, s.fewer->fastest, s.moving, s.moving / s.fewer->fastest);
  if (!s.unlimited.empty()) text += fmt::format("; no vibration limits the steps of {}", fmt::join(s.unlimited, ", "));
  return text;
}

std::string families_text(const std::vector<study::BodyFamilies>& families) {
  std::string text, body;
  for (const study::BodyFamilies& f : families) {
    text += f.body == body ? ", " : fmt::format("{}{}: ", text.empty() ? "" : "; ", f.body);
    text += fmt::format("{}{}{}{}{}", f.modes, f.strain.empty() ? "" : " ", f.strain, f.family.empty() ? "" : " ",
                        f.strain.empty() && f.family.empty() ? " of its own" : f.family);
    body = f.body;
  }
  return text;
}

std::string limits_text(const std::vector<study::Indicator>& indicators) {
  if (indicators.empty()) return {};
  const study::Indicator& first = indicators.front();
  const std::string how =
      fmt::format("{}: {}, limit {:.3g}", first.text, beside_limit(first.value, first.limit), first.limit);
  const auto passed =
      std::count_if(indicators.begin(), indicators.end(), [](const study::Indicator& i) { return i.use() > 1; });
  if (passed == 0) return "all are kept; nearest is " + how;
  return fmt::format("{} exceeded, {}{}; beyond it {}", passed == 1 ? "one is" : fmt::format("{} are", passed),
                     passed == 1 ? "" : "most of all ", how, first.meaning);
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
  if (!certificate.families.empty()) line("modes", families_text(certificate.families));
  line("energy", energy_text(certificate));
  if (certificate.momentum.conserved)
    line("momentum",
         fmt::format("linear off by {}{}; angular by {}{}: nothing outside acts on the tree, and it is to "
                     "be conserved",
                     percent(certificate.momentum.linear), whose(certificate, &study::DriftShares::linear),
                     percent(certificate.momentum.angular), whose(certificate, &study::DriftShares::angular)));
  if (!certificate.dropped.empty()) line("dropped", dropped_text(certificate));
  const NeglectedAcceleration& n = certificate.neglected;
  // Vibrations that hardly move an output are in it: where the error of outputs is known, that says it.
  if (!certificate.estimate && !certificate.against.empty() && n.samples > 0 && n.rms > 0) {
    line("left out", fmt::format("{} of the accelerations in the mean, {} at the peaks, against {} ({} samples)",
                                 percent(n.rms), percent(n.peak), certificate.against, n.samples));
  }
  if (certificate.estimate) {
    line("error", error_text(*certificate.estimate, model, summary.reached));
  } else if (!certificate.without_estimate.empty()) {
    line("error", certificate.without_estimate);
  }
  if (const std::string text = more_modes_text(certificate.more_modes, model, summary.reached); !text.empty())
    line("", text);
  for (const BodyValidity& b : certificate.bodies) line(b.name, body_text(b, summary));
  if (const std::string limits = limits_text(certificate.indicators); !limits.empty()) line("limits", limits);
  if (certificate.steps.product > 0) line("steps", step_limit_text(certificate.steps));
  if (summary.steps.accepted > 0 && summary.energy_scale == 0)
    line("steps", "nothing moves: there is no energy in the tree, and no work is done on it");
  return out;
}

}  // namespace withy
