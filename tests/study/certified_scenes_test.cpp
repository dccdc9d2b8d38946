// What certificates say of every scene in every formulation and in a mix, over a short time, against the dense
// reference along the outputs, runs at a tolerance of 1e-10 and eigenvalues of differences: algorithms that
// certificates do not use.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <span>

#include "withy/core/analysis/fastest_pole.hpp"
#include "withy/core/model/closing.hpp"
#include "withy/core/plugin/central_difference.hpp"
#include "withy/core/plugin/measured_place.hpp"
#include "withy/core/shape/section_fields.hpp"
#include "withy/core/simulation/mass_centre.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/tests/study/certified_run.hpp"

namespace withy::study {
namespace {

using namespace certified_scenes;

bool truncates(const Certified& c) {
  const auto whole = [](const Terms& t) { return t.truncation == Truncation::none && t.products_of_speeds; };
  bool all = whole(c.prepared.scene.formulation->terms());
  for (const BodyNode& body : c.model().bodies()) all = all && (!body.terms || whole(*body.terms));
  return !all && flexible(c.model());
}

/// Greatest drifts over some outputs, by the dense reference, over the scales of the run.
Drifts drifts_over(const Certified& c, std::span<const State> seen) {
  const RunSummary& s = c.run.summary;
  Drifts most;
  std::optional<Energies> first;
  std::optional<MassCentre> centre;
  if (s.momentum.conserved) centre.emplace(c.model(), c.equations(), s.final.y);
  Vector3 first_spin = Vector3::Zero();
  for (const State& state : seen) {
    const Energies e = c.equations().energies(state.y);
    const Vector3 turns = centre ? spin(e, centre->at(state.y).position) : Vector3(Vector3::Zero());
    if (!first) first = e, first_spin = turns;
    const double gained = e.kinetic + e.potential - first->kinetic - first->potential;
    // Where a truncated mass matrix is nearly singular it makes much motion of little energy, its own.
    if (!truncates(c)) {
      EXPECT_LE(e.kinetic, s.energy_scale * 1.01) << "the scale is no less than the energies";
    }
    const auto apart = [](const auto& a, const auto& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); };
    const auto raise = [](double& drift, double error, double scale) {
      if (scale > 0) drift = std::max(drift, error / scale);
    };
    raise(most.energy, std::abs(gained - state.y.back() + c.seen.front().y.back()), s.energy_scale);
    raise(most.linear, apart(e.linear_momentum, first->linear_momentum), s.momentum.linear_scale);
    raise(most.angular, (turns - first_spin).norm(), s.momentum.angular_scale);
  }
  return most;
}

Drifts drifts_seen(const Certified& c) { return drifts_over(c, c.seen); }

void expect_formulations_and_modes(const Certified& c) {
  EXPECT_EQ(c.certificate().formulation, c.formulation);
  EXPECT_FALSE(c.certificate().meaning.empty());
  ASSERT_EQ(c.certificate().own.size(), c.mixed.empty() ? 0U : 1U);
  if (!c.mixed.empty()) {
    EXPECT_EQ(c.certificate().own[0].body, c.mixed);
    EXPECT_EQ(c.certificate().own[0].formulation, "ruthless");
  }
  std::size_t modes = 0, listed = 0;
  for (const Slot& slot : c.model().layout().bodies) modes += slot.positions;
  for (const BodyFamilies& f : c.certificate().families) listed += f.modes;
  // A body in segments lists the modes of one.
  if (std::none_of(c.model().bodies().begin(), c.model().bodies().end(), [](const BodyNode& b) { return b.segment; })) {
    EXPECT_EQ(listed, modes);
  }
}

/// No drift at an output is greater than the one that is said; whose it is, a tight run in the same equations shows.
void expect_drifts(const Certified& c, const Certified& tight) {
  const Certificate& said = c.certificate();
  const Drifts seen = drifts_seen(c), model = drifts_seen(tight);
  // Outputs are interpolated between steps, which the energy feels; the last is the end of a step.
  const double most = std::max(said.untruncated_drift, said.energy_drift);
  EXPECT_LE(seen.energy, 1.01 * most + 3e-5);
  if (!c.seen.empty() && c.seen.back().time == c.run.summary.final.time) {
    EXPECT_LE(drifts_over(c, std::vector<State>{c.seen.front(), c.seen.back()}).energy, 1.01 * most + 1e-12);
  }
  EXPECT_EQ(said.momentum.conserved, tight.certificate().momentum.conserved);
  if (said.momentum.conserved) {
    EXPECT_LE(seen.linear, 1.01 * said.momentum.linear + 1e-6);
    EXPECT_LE(seen.angular, 1.01 * said.momentum.angular + 1e-6);
  }
  if (!truncates(c)) {
    if (tight.run.summary.status == RunStatus::completed) {
      EXPECT_LE(model.energy, 1e-6) << "what is not truncated conserves energy";
      if (said.momentum.conserved) {
        EXPECT_LE(std::max(model.linear, model.angular), 1e-6);
      }
    }
    if (!said.shares) return;
    EXPECT_EQ(said.shares->energy.value().model, 0);
    EXPECT_EQ(said.shares->energy->integration, said.energy_drift);
  } else if (said.shares && tight.run.summary.status == RunStatus::completed) {
    const auto expect = [](const std::optional<DriftShare>& share, double real, double whole, const char* what) {
      if (!share) return;
      EXPECT_NEAR(share->model, std::min(real, whole), 0.25 * real + 2e-6) << what;
    };
    expect(said.shares->energy, model.energy, said.untruncated_drift, "energy");
    if (!said.momentum.conserved) return;
    expect(said.shares->linear, model.linear, said.momentum.linear, "linear momentum");
    expect(said.shares->angular, model.angular, said.momentum.angular, "angular momentum");
  }
}

/// Of the place that a body is measured at, over its length, or the greatest of several. Where that is no tip its
/// expansion is evaluated.
double deflection_over_length(const Certified& c, const State& state, std::size_t b) {
  const BodyNode& node = c.model().bodies()[b];
  double most = 0;
  for (const MeasuredPlace& place : measured_places(*node.body)) {
    if (place.name == "tip") {
      const auto d = c.equations().deflection(state.y, static_cast<int>(b), node.frame("tip"));
      most = std::max(most, std::hypot(d[0], d[1], d[2]));
      continue;
    }
    const PointExpansion& at = place.at;
    const Eigen::Map<const Eigen::VectorXd> q(state.y.data() + c.model().layout().modes(b)->position, at.phi.cols());
    Vector3 d = at.phi * q;
    for (std::size_t k = 0; k < 3; ++k) d[static_cast<Eigen::Index>(k)] += 0.5 * q.dot(at.gamma[k] * q);
    most = std::max(most, d.norm());
  }
  return most / node.body->shape().length;
}

void expect_deflections(const Certified& c) {
  for (std::size_t b = 0; b < c.model().bodies().size(); ++b) {
    const std::string& name = c.model().bodies()[b].name;
    const auto said = c.run.summary.peak_deflection_ratio.find(name);
    if (said == c.run.summary.peak_deflection_ratio.end()) continue;
    double most = 0;
    for (const State& s : c.seen) most = std::max(most, deflection_over_length(c, s, b));
    EXPECT_LE(most, 1.001 * said->second + 1e-9) << name;
    if (c.run.summary.status != RunStatus::completed) continue;
    EXPECT_LE(said->second, 2 * most + 1e-6) << name << ": peaks between outputs are no twice as high";
  }
}

/// Extremes of indicators against every output, by the dense reference: the rate of each body's frame, by differences
/// of its rotations, never exceeds what is said to be its greatest.
void expect_rates(const Certified& c) {
  if (c.seen.size() < 10) return;
  for (const BodyValidity& b : c.certificate().bodies) {
    const int body = c.model().body(b.name);
    if (body < 0 || !(b.fundamental > 0)) continue;
    // A root that turns with the modes, as one that is pinned, is not the body's frame.
    if (moved_by_modes(c.model().bodies()[static_cast<std::size_t>(body)].frames[0].section)) continue;
    double most = 0;
    for (std::size_t i = 1; i < c.seen.size(); ++i) {
      const double h = c.seen[i].time - c.seen[i - 1].time;
      if (!(h > 0)) continue;
      const auto p = c.equations().frame_pose(c.seen[i - 1].y, body, 0).rotation,
                 q = c.equations().frame_pose(c.seen[i].y, body, 0).rotation;
      double trace = 0;
      for (std::size_t k = 0; k < 9; ++k) trace += p[k] * q[k];
      most = std::max(most, std::acos(std::clamp((trace - 1) / 2, -1.0, 1.0)) / h);
    }
    if (most * (c.seen[1].time - c.seen[0].time) > 1) continue;  // turns are not told apart
    EXPECT_GE(b.rate_ratio * b.fundamental, 0.85 * most - 1e-6)
        << b.name << ": samples miss no more than their spacing";
    EXPECT_LE(b.rate_time, c.run.summary.final.time) << b.name;
  }
}

/// The mean step, and the modulus of the fastest pole: the greatest eigenvalue of differences of the equations.
void expect_steps(const Certified& c) {
  const StepLimit& said = c.certificate().steps;
  const RunSummary& s = c.run.summary;
  if (s.steps.accepted == 0) return;
  if (s.energy_scale == 0) {
    EXPECT_EQ(c.run.summary.final.y, c.seen.front().y) << "nothing moves";
    EXPECT_EQ(said.mean, 0) << "steps that nothing limits are not told";
    return;
  }
  EXPECT_NEAR(said.mean, (s.reached - c.prepared.scene.initial.time) / static_cast<double>(s.steps.accepted),
              1e-9 * said.mean);
  const auto n = static_cast<Eigen::Index>(c.model().layout().moving());
  if (s.status != RunStatus::completed || said.product == 0 || n == 0 || n > 40 || !loops_of(c.model()).empty()) return;
  // Next to a zero of det M the accelerations have a pole, and differences tell nothing.
  if (s.conditioning.condition > 1e6) return;
  Work work = c.equations().make_work();
  Eigen::MatrixXd J(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    J.col(j) = central_difference(
        [&](double h) {
          std::vector<double> y = s.final.y, f(y.size());
          y[static_cast<std::size_t>(j)] += h;
          EXPECT_TRUE(c.equations().derivatives(s.final.time, y, f, work).ok());
          return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(f.data(), n));
        },
        1e-6);
  }
  const double fastest = J.eigenvalues().cwiseAbs().maxCoeff();
  EXPECT_NEAR(said.fastest, fastest, 0.02 * fastest);
}

/// Places of tips against those in the model up, both at a tolerance of 1e-10. Where the certificate says that coarse
/// runs leave this one by a part of a range, it claims no more than that.
void expect_error(const Certified& c, const Certified& tight, const Certified& up) {
  const ErrorEstimate& said = *c.certificate().estimate;
  if (tight.seen.size() != up.seen.size() || said.distances.until < said.end) return;
  constexpr double worth_saying = 0.1;
  const double left = said.off > worth_saying ? said.off : 0;
  for (const Tip& tip : tips(c.model())) {
    const auto found = said.distances.tips.find(tip.body + ".tip");
    if (found == said.distances.tips.end() || tip.in_segments()) continue;
    const auto place = [&](const Certified& of, std::size_t i) {
      const auto p = of.equations().frame_pose(of.seen[i].y, tip.tip.body, tip.tip.frame).position;
      return Vector3(p[0], p[1], p[2]);
    };
    double real = 0, range = 0;
    for (std::size_t i = 0; i < up.seen.size(); ++i) {
      real = std::max(real, (place(tight, i) - place(up, i)).norm());
      range = std::max(range, (place(tight, i) - place(tight, 0)).norm());
    }
    const double beside = left * range + 1e-5 * tip.length;
    EXPECT_LE(real, 1.15 * found->second + beside) << tip.body;
    if (said.at_most.count(found->first) == 0) {
      EXPECT_LE(found->second, 1.5 * real + beside) << tip.body;
    }
  }
}

/// Sizes of what is dropped wherever there is a model up, by the dense reference of both at the same states.
void expect_dropped(const Certified& c) {
  const std::vector<State>& along = c.run.summary.validity.along;
  EXPECT_LE(along.size(), 64 + 1);
  if (!c.certificate().estimate) {
    EXPECT_FALSE(c.certificate().without_estimate.empty()) << "why there is no estimate";
  }
  const std::optional<Beyond> up = next_model_up(c.prepared, plugins());
  if (!up || along.empty() || !loops_of(c.model()).empty()) {
    EXPECT_TRUE(c.certificate().dropped.empty());
    return;
  }
  double missing = 0;
  for (const State& state : along) {
    const DenseSystem ours = c.equations().system(state.time, state.y),
                      theirs = up->equations->system(state.time, state.y);
    std::vector<double> f(state.y.size());
    Work work = c.equations().make_work();
    ASSERT_TRUE(c.equations().derivatives(state.time, state.y, f, work).ok());
    for (std::size_t i = 0; i < ours.size; ++i) {
      double force = ours.force[i] - theirs.force[i];
      for (std::size_t j = 0; j < ours.size; ++j)
        force += (theirs.mass[i * ours.size + j] - ours.mass[i * ours.size + j]) * f[c.model().layout().positions + j];
      missing = std::max(missing, std::abs(force));
    }
  }
  double share = 0;
  for (const DroppedForces& d : c.certificate().dropped) {
    EXPECT_TRUE(std::isfinite(d.share) && d.share >= 0) << d.group;
    EXPECT_TRUE(std::isfinite(d.spread) && d.spread >= 0) << d.group;
    share = std::max(share, d.share);
    for (const DroppedTerm& t : d.terms) EXPECT_TRUE(std::isfinite(t.share) && t.share >= 0) << t.term;
  }
  if (missing > 1e-6) {
    EXPECT_GT(share, 0) << "where forces are missing they are told";
  }
}

std::string first_flexible(const Model& model) {
  for (std::size_t b = 0; b < model.bodies().size(); ++b)
    if (model.layout().modes(b) != nullptr && !model.bodies()[b].segment) return model.bodies()[b].name;
  return {};
}

class CertifiedScenes : public testing::TestWithParam<std::string> {};

TEST_P(CertifiedScenes, AreAsTheirCertificatesSay) {
  std::map<std::string, std::optional<Certified>> tight;  // of every body in one formulation
  const auto in = [&](const std::string& formulation) -> const std::optional<Certified>& {
    const auto known = tight.find(formulation);
    if (known != tight.end()) return known->second;
    return tight[formulation] = certified(GetParam(), formulation, "", true);
  };
  std::vector<std::pair<std::string, std::string>> cases;
  const bool few = GetParam().starts_with(whole) && std::getenv(everything) == nullptr;
  for (const char* f : {"quadratic", "ruthless", "inconsistent", "consistent", "linear", "symmetric", "exact"})
    if (cases.size() < 2 || !few) cases.emplace_back(f, "");
  std::size_t looked_at = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto [formulation, mixed] = cases[i];  // a copy: the list grows
    SCOPED_TRACE(formulation + (mixed.empty() ? "" : ", " + mixed + " ruthless"));
    const std::optional<Certified> c = certified(GetParam(), formulation, mixed, false);
    if (!c) continue;
    ++looked_at;
    if (i == 0 && !flexible(c->model())) cases.resize(1);  // all formulations are the same
    if (i == 0 && !first_flexible(c->model()).empty()) cases.emplace_back("quadratic", first_flexible(c->model()));
    const std::optional<Certified> own = mixed.empty() ? std::nullopt : certified(GetParam(), formulation, mixed, true);
    const std::optional<Certified>& exact_run = mixed.empty() ? in(formulation) : own;
    ASSERT_TRUE(exact_run);
    expect_formulations_and_modes(*c);
    expect_drifts(*c, *exact_run);
    expect_deflections(*c);
    expect_steps(*c);
    if (GetParam().starts_with(whole)) expect_rates(*c);
    expect_dropped(*c);
    if (!c->certificate().estimate) continue;
    if (const std::optional<Certified>& up = in(c->certificate().estimate->against); up)
      expect_error(*c, *exact_run, *up);
  }
  EXPECT_GE(looked_at, 1U);
}

std::vector<std::string> all_scenes() {
  std::vector<std::string> all;
  for (const char* folder : {"/scenes", "/scenes/gallery"})
    for (const auto& entry : std::filesystem::directory_iterator(std::string(WITHY_SOURCES) + folder))
      if (entry.path().extension() == ".yaml") all.push_back(entry.path().string());
  std::sort(all.begin(), all.end());
  return all;
}

/// What a tenth of a second does not show: rates that come late, loads that near buckling, errors that grow, drifts
/// over many turns.
std::vector<std::string> whole_scenes() {
  std::vector<std::string> all;
  if (std::getenv(everything) != nullptr) {
    for (const std::string& scene : all_scenes()) all.push_back(whole + scene);
    return all;
  }
  for (const char* scene : {"screw", "spin-up", "beam-on-base", "spinning-boom", "commanded-arm"})
    all.push_back(whole + WITHY_SOURCES + "/scenes/" + scene + ".yaml");
  return all;
}

INSTANTIATE_TEST_SUITE_P(Whole, CertifiedScenes, testing::ValuesIn(whole_scenes()), [](const auto& parameter) {
  std::string name = std::filesystem::path(parameter.param).stem();
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

INSTANTIATE_TEST_SUITE_P(All, CertifiedScenes, testing::ValuesIn(all_scenes()), [](const auto& parameter) {
  std::string name = std::filesystem::path(parameter.param).stem();
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace withy::study
