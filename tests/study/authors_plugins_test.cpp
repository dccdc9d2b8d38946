// Plugins of others that are not what studies take them for, or wrong where nothing else shows it, are told of.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/equations/compile_equations.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/core/plugin/hinge.hpp"
#include "withy/core/plugin/integrator.hpp"
#include "withy/plugins/host/plugin_host.hpp"
#include "withy/scene/scene_error.hpp"
#include "withy/study/candidates.hpp"
#include "withy/study/configuration.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/run.hpp"

namespace withy::study {
namespace {

using testing::HasSubstr;

/// Heun's steps, as long as Euler's differ from them by `tol`; within a step the chord, or what `fault` makes of it.
class HeunEuler final : public Stepper {
 public:
  HeunEuler(const EquationsOfMotion& equations, const State& state, double tol, std::string fault)
      : equations_(equations),
        state_(state),
        before_(state),
        first_(state.y.size()),
        second_(first_),
        ahead_(first_),
        work_(equations.make_work()),
        tol_(tol),
        fault_(std::move(fault)) {}
  StepResult step(double t_limit) override {
    for (;;) {
      const double left = t_limit - state_.time, h = std::min(h_, left);
      double error = 0;
      equations_.derivatives(state_.time, state_.y, first_, work_);
      for (std::size_t i = 0; i < ahead_.size(); ++i) ahead_[i] = state_.y[i] + h * first_[i];
      equations_.derivatives(state_.time + h, ahead_, second_, work_);
      for (std::size_t i = 0; i < ahead_.size(); ++i)
        error = std::max(error, h / 2 * std::abs(second_[i] - first_[i]) / tol_);
      const bool good = error <= 1;
      h_ = h * std::clamp(0.9 / std::sqrt(error + 1e-12), 0.2, 3.0);
      if (!good) continue;
      before_ = state_;
      for (std::size_t i = 0; i < ahead_.size(); ++i) state_.y[i] += h / 2 * (first_[i] + second_[i]);
      state_.time = h < left ? state_.time + h : t_limit;
      auto& s = statistics_;
      s.smallest_step = s.accepted == 0 ? h : std::min(s.smallest_step, h);
      s.largest_step = std::max(s.largest_step, h);
      ++s.accepted;
      s.evaluations += 2;
      return {};
    }
  }
  const State& state() const override { return state_; }
  void interpolate(double t, std::span<double> y) const override {
    if (fault_ == "leaves") return;
    double share = (t - before_.time) / (state_.time - before_.time);
    if (fault_ == "end") share = 1;
    if (fault_ == "start") share = 0;
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = before_.y[i] + share * (state_.y[i] - before_.y[i]);
  }
  void restart() override {}
  void jump(const State& state) override { state_ = before_ = state; }
  std::vector<double> memory() const override { return {}; }
  void resume(const State& state, std::span<const double>) override { jump(state); }
  const StepStatistics& statistics() const override { return statistics_; }

 private:
  const EquationsOfMotion& equations_;
  State state_, before_;
  std::vector<double> first_, second_, ahead_;
  Work work_;
  double tol_, h_ = 1e-3;
  std::string fault_;
  StepStatistics statistics_;
};

class ByTol final : public Integrator {
 public:
  ByTol(double tol, std::string fault) : tol_(tol), fault_(std::move(fault)) {}
  std::unique_ptr<Stepper> start(const EquationsOfMotion& equations, const State& state) const override {
    return std::make_unique<HeunEuler>(equations, state, tol_, fault_);
  }
  int order() const override { return 2; }

 private:
  double tol_;
  std::string fault_;
};

/// Says that it keeps what `quadratic` does, and compiles that or what `linear` does.
class SaysQuadratic final : public Formulation {
 public:
  explicit SaysQuadratic(StrainOrder compiled) : compiled_(compiled) {}
  Terms terms() const override { return {StrainOrder::quadratic, Truncation::none}; }
  std::unique_ptr<EquationsOfMotion> compile(std::shared_ptr<const Model> model) const override {
    return compile_equations(std::move(model), {compiled_, Truncation::none});
  }

 private:
  StrainOrder compiled_;
};

/// Slides along x, and has no rate beyond 1 m.
class Short final : public Hinge {
 public:
  std::size_t coordinates() const override { return 1; }
  std::size_t speeds() const override { return 1; }
  void reference(std::span<double> x) const noexcept override { x[0] = 0; }
  void motion(std::span<const double> x, std::span<const double>, HingeMotion& of) const noexcept override {
    of.pose.R.setIdentity();
    of.pose.p = Vector3(x[0], 0, 0);
    of.H.setZero(6, 1);
    of.H(3, 0) = x[0] > 1 ? std::nan("") : 1;
    of.bias.setZero();
  }
  void derivatives(std::span<const double>, std::span<const double> rates,
                   std::span<double> x_dot) const noexcept override {
    x_dot[0] = rates[0];
  }
  void normalize(std::span<double>) const noexcept override {}
  std::optional<HingeKernel> kernel() const override { return {}; }
};

/// The project's plugins with these.
Registry& with_others() {
  static const PluginHost host({PluginHost::default_directory()});
  static Registry* const registry = [] {
    auto* made = new Registry;  // plugins stay for the life of the process
    host.attach(*made);
    Enrollment e;
    e.add(Plugin<Integrator>{
        "by-tol",
        "Heun's, with error control",
        {number("tol", "1", "error of a step").otherwise(1e-6), text("fault", "what its inside is").otherwise("none")},
        [](const Value& p, const MakeContext&) -> std::unique_ptr<Integrator> {
          return std::make_unique<ByTol>(p.number_at("tol"), p.text_at("fault"));
        }});
    e.add(Plugin<Formulation>{
        "half-true", "not what it says", {}, [](const Value&, const MakeContext&) -> std::unique_ptr<Formulation> {
          return std::make_unique<SaysQuadratic>(StrainOrder::linear);
        }});
    e.add(Plugin<Formulation>{
        "whole-truth", "what it says", {}, [](const Value&, const MakeContext&) -> std::unique_ptr<Formulation> {
          return std::make_unique<SaysQuadratic>(StrainOrder::quadratic);
        }});
    e.add(Plugin<Hinge>{"short", "a slider of 1 m", {}, [](const Value&, const MakeContext&) -> std::unique_ptr<Hinge> {
                          return std::make_unique<Short>();
                        }});
    made->admit(std::move(e), "test");
    return made;
  }();
  return *registry;
}

Prepared made(const std::string& more) {
  return prepare(SceneValues::parse("format: withy/1\n" + more, "s.yaml"), with_others());
}

/// A pendulum that begins level.
Prepared pendulum(const std::string& integrator, const std::string& more = "") {
  return made("gravity: [0, 0, -9.81]\ntime: {end: 1, output: 0.003}\nintegrator: {name: " + integrator +
              "}\nbodies: {b: {type: rigid, mass: 2, center_of_mass: [1, 0, 0], inertia: [1, 1, 1, 0, 0, 0]}}\n"
              "hinges: {h: {type: revolute, axis: [0, 1, 0], parent: world, child: b}}\n" +
              more);
}

/// A beam that turns at 5 rad/s, still and straight.
Prepared spinning(const std::string& formulation) {
  return made("formulation: " + formulation +
              "\nbodies: {b: {type: beam, length: 1.2, mass_per_length: 2, bending_y: {stiffness: 30, modes: 2}}}\n"
              "hinges: {h: {type: revolute, axis: [0, 0, 1], parent: world, child: b}}\n"
              "motions: {s: {type: constant-rate, hinge: h, rate: 5}}\n");
}

std::string told(const std::function<void()>& deed) {
  try {
    deed();
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return "nothing";
}

TEST(OthersIntegrators, WhoseToleranceStudiesCannotSetAreNotAdvised) {
  const Prepared prepared = pendulum("by-tol");
  const auto asked = [&](const std::string& integrator) {
    return told([&] {
      static_cast<void>(candidates_for(prepared, with_others(), {{}, {}, {}, {integrator}, {1e-2}, {}}));
    });
  };
  const std::string why =
      "' has no parameter 'rtol': studies set tolerances by 'rtol' and 'atol', and know of no other";
  EXPECT_EQ(asked("by-tol"), "integrator 'by-tol" + why);
  EXPECT_EQ(asked("rk4"), "integrator 'rk4" + why);
  EXPECT_EQ(asked("nobody"), "no integrator 'nobody'");
  EXPECT_EQ(asked("dopri5"), "nothing");
}

TEST(OthersIntegrators, ThatHaveNeitherStepNorToleranceChooseTheirSteps) {
  const auto cause = [](const std::string& integrator) {
    const Prepared prepared = pendulum(integrator);
    return run(prepared, with_others()).certificate.steps.cause();
  };
  EXPECT_EQ(cause("by-tol, tol: 1e-5"), "chosen");
  EXPECT_EQ(cause("rk4, step: 0.003"), "given");
}

TEST(OthersIntegrators, ThatDoNotInterpolateEndARunByTheirNames) {
  const auto said = [](const std::string& fault, const std::string& more = "") {
    return told([&] { static_cast<void>(run(pendulum("by-tol, fault: " + fault, more), with_others())); });
  };
  const std::string who = "integrator 'by-tol' does not interpolate ";
  EXPECT_EQ(said("none"), "nothing");
  EXPECT_THAT(said("leaves"), HasSubstr(who + "from where its steps begin"));
  EXPECT_THAT(said("end"), HasSubstr(who + "from where its steps begin"));
  EXPECT_THAT(said("start"), HasSubstr(who + "to where its steps end"));
  // Before an event is at a time that is none.
  const std::string event = "events: {e: {hinge: h, value: 0.05, direction: up, stop: true}}\n";
  EXPECT_EQ(said("none", event), "nothing");
  EXPECT_THAT(said("end", event), HasSubstr(who));
}

TEST(OthersFormulations, WhoseEquationsAreNotThoseOfTheirTermsHaveNoSmallMotions) {
  const auto said = [](const std::string& formulation) {
    const Prepared prepared = spinning(formulation);
    return told([&] { static_cast<void>(Configuration(prepared, prepared.scene.initial, {})); });
  };
  EXPECT_THAT(said("half-true"), HasSubstr("s.yaml: analyses of small motions and steady states go by the terms of a "
                                           "formulation, and those of 'half-true' are not its equations"));
  for (const char* right : {"whole-truth", "quadratic", "linear", "ruthless", "exact", "symmetric"})
    EXPECT_EQ(said(right), "nothing") << right;
}

TEST(OthersHinges, WithoutARateBeyondAPlaceAreNamedThere) {
  const Prepared prepared = made(
      "time: {end: 2, output: 0.1}\nbodies: {b: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, 0]}}\n"
      "hinges: {h: {type: short, parent: world, child: b}}\ninitial: {hinges: {h: {rate: [1]}}}\n");
  const RunSummary ended = run(prepared, with_others()).summary;
  EXPECT_EQ(ended.status, RunStatus::diverged);
  EXPECT_THAT(ended.message, HasSubstr("of hinge 'h' is not finite where its coordinate is 1"));
  EXPECT_THAT(ended.message, testing::Not(HasSubstr("next to no inertia")));
}

TEST(OthersHinges, AreNamedAndNotMadeWhereTheyCloseLoops) {
  EXPECT_THAT(
      told([] { pendulum("dopri5", "constraints: {c: {type: hinge, hinge: {type: short}, a: world, b: b}}\n"); }),
      HasSubstr("/constraints/c/hinge: got a map; need the name of a plugin (hinge); available: "));
}

}  // namespace
}  // namespace withy::study
