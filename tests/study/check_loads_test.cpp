// Loads and integrators that are wrong about themselves are refused at their place before anything rests on them.
#include "withy/study/check_loads.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <memory>
#include <stdexcept>

#include "withy/core/plugin/integrator.hpp"
#include "withy/core/plugin/load.hpp"
#include "withy/plugins/host/plugin_host.hpp"
#include "withy/study/comparison.hpp"
#include "withy/study/configuration.hpp"
#include "withy/study/linear_model.hpp"
#include "withy/study/probe.hpp"
#include "withy/study/run.hpp"
#include "withy/study/term_study.hpp"
#include "withy/study/trade.hpp"

namespace withy::study {
namespace {

using testing::HasSubstr;

/// A filter ż = x − z that pushes with −2 z; it may forget that it measures x, measure the acceleration too, or set its
/// effort.
class Filter final : public ContinuousPart {
 public:
  explicit Filter(std::string fault) : fault_(std::move(fault)) {}
  std::size_t states() const override { return 1; }
  std::string name(std::size_t) const override { return "z"; }
  void begin(const LoadView&, std::span<double> z) const noexcept override { z[0] = 0; }
  void rates(const LoadView& view, std::span<double> rates) const noexcept override {
    rates[0] = view.positions()[0] - view.continuous[0];
    if (fault_ == "filter-feels") rates[0] += view.accelerations[0];
  }
  void add(const LoadView& view, std::span<double> efforts) const noexcept override {
    efforts[0] = (fault_ == "filter-sets" ? 0 : efforts[0]) - 2 * view.continuous[0];
  }
  bool add_derivatives(const LoadView&, ContinuousDerivatives& to) const override {
    to.effort_by_state(0, 0) -= 2;
    to.rate_by_position(0, 0) += fault_ == "filter-forgets" ? 0 : 1;
    to.rate_by_state(0, 0) -= 1;
    return true;
  }

 private:
  std::string fault_;
};

/// A number that is held, with a function that switches it; either may be none. It may set an effort of zero.
class Relay final : public DiscretePart {
 public:
  Relay(double held, double function, bool sets) : held_(held), function_(function), sets_(sets) {}
  std::size_t states() const override { return 1; }
  std::size_t switches() const override { return 1; }
  void switching(double, std::span<const double>, std::span<const double>, std::span<const double>,
                 std::span<double> values) const noexcept override {
    values[0] = function_;
  }
  void renew(double, std::span<const double>, std::span<const double>, const Crossing&, std::span<double> d,
             std::span<double>) const noexcept override {
    d[0] = held_;
  }
  void add(double, std::span<const double>, std::span<double> efforts) const noexcept override {
    if (sets_) efforts[0] = 0;
  }

 private:
  double held_, function_;
  bool sets_;
};

/// A spring of 3 N/m on the first speed, twice as stiff beyond 0.05 m if asked for; `fault` is in what it says.
class BoundSpring final : public BoundLoad {
 public:
  explicit BoundSpring(std::string fault) : fault_(std::move(fault)) {
    const double nan = std::nan("");
    if (fault_.starts_with("filter")) filter_ = std::make_unique<Filter>(fault_);
    if (fault_ == "switch" || fault_ == "held" || fault_.starts_with("relay"))
      relay_ =
          std::make_unique<Relay>(fault_ == "held" ? nan : 0, fault_ == "switch" ? nan : 1, fault_ == "relay-sets");
  }
  std::size_t scratch() const override { return 0; }
  void add(double, std::span<const double> x, std::span<const double>, std::span<double> efforts,
           std::span<double>) const noexcept override {
    if (fault_ == "remembers") efforts[0] += 0.1 * ++calls_;
    efforts[0] = (fault_ == "sets" ? 0 : efforts[0]) - (is_stiff(x[0]) ? 6 * x[0] - 3 * kink : 3 * x[0]);
  }
  bool add_derivatives(double, std::span<const double> x, std::span<const double>,
                       Eigen::Ref<Eigen::MatrixXd> by_position, Eigen::Ref<Eigen::MatrixXd>) const override {
    if (fault_ == "throws") throw std::runtime_error("out of order");
    if (fault_ == "forgets") return true;
    by_position(0, 0) += fault_ == "sign" ? 300 : is_stiff(x[0]) ? -6 : -3;
    return true;
  }
  std::vector<double> discontinuities() const override { return {}; }
  double end() const override { return 0; }
  void begin(State&) const override {}
  const DiscretePart* discrete() const override { return relay_.get(); }
  const ContinuousPart* continuous() const override { return filter_.get(); }

 private:
  static constexpr double kink = 0.05;
  bool is_stiff(double x) const { return fault_ == "kink" && x > kink; }

  std::string fault_;
  std::unique_ptr<Filter> filter_;
  std::unique_ptr<Relay> relay_;
  mutable int calls_ = 0;
};

class Spring final : public Load {
 public:
  explicit Spring(std::string fault) : fault_(std::move(fault)) {}
  std::unique_ptr<BoundLoad> bind(const Model&) const override { return std::make_unique<BoundSpring>(fault_); }

 private:
  std::string fault_;
};

/// Euler's steps, which fail after the first ten.
class Euler final : public Stepper {
 public:
  Euler(const EquationsOfMotion& equations, const State& state)
      : equations_(equations), state_(state), rates_(state.y.size()), work_(equations.make_work()) {}
  StepResult step(double t_limit) override {
    if (++statistics_.accepted > 10) throw std::runtime_error("out of order");
    const double to = std::min(t_limit, state_.time + 1e-3);
    equations_.derivatives(state_.time, state_.y, rates_, work_);
    for (std::size_t i = 0; i < rates_.size(); ++i) state_.y[i] += (to - state_.time) * rates_[i];
    state_.time = to;
    return {};
  }
  const State& state() const override { return state_; }
  void interpolate(double, std::span<double> y) const override {
    std::copy(state_.y.begin(), state_.y.end(), y.begin());
  }
  void restart() override {}
  void jump(const State& state) override { state_ = state; }
  std::vector<double> memory() const override { return {}; }
  void resume(const State& state, std::span<const double>) override { state_ = state; }
  const StepStatistics& statistics() const override { return statistics_; }

 private:
  const EquationsOfMotion& equations_;
  State state_;
  std::vector<double> rates_;
  Work work_;
  StepStatistics statistics_;
};

class Failing final : public Integrator {
 public:
  explicit Failing(std::string fault) : fault_(std::move(fault)) {}
  std::unique_ptr<Stepper> start(const EquationsOfMotion& equations, const State& state) const override {
    return fault_ == "none" ? nullptr : std::make_unique<Euler>(equations, state);
  }
  int order() const override { return fault_ == "order" ? -3 : 1; }

 private:
  std::string fault_;
};

/// The project's plugins with these two.
Registry& with_faulty() {
  static const PluginHost host({PluginHost::default_directory()});
  static Registry* const registry = [] {
    auto* made = new Registry;  // plugins stay for the life of the process
    host.attach(*made);
    Enrollment e;
    const auto fault = text("fault", "what is wrong with it").otherwise("nothing");
    e.add(Plugin<Load>{"faulty", "a spring", {fault}, [](const Value& p, const MakeContext&) -> std::unique_ptr<Load> {
                         return std::make_unique<Spring>(p.text_at("fault"));
                       }});
    e.add(Plugin<Integrator>{
        "faulty", "Euler's", {fault}, [](const Value& p, const MakeContext&) -> std::unique_ptr<Integrator> {
          return std::make_unique<Failing>(p.text_at("fault"));
        }});
    made->admit(std::move(e), "test");
    return made;
  }();
  return *registry;
}

Prepared slider(const std::string& more, const std::string& position = "0.05") {
  return prepare(
      SceneValues::parse("format: withy/1\ntime: {end: 1}\nbodies: {b: {type: rigid, mass: 2, inertia: [1, 1, 1, 0, 0, "
                         "0]}}\nhinges: {h: {type: prismatic, axis: [1, 0, 0], parent: world, child: b}}\ninitial: "
                         "{hinges: {h: {position: [" +
                             position + "]}}}\n" + more,
                         "s.yaml"),
      with_faulty());
}

/// What is said of a load before a run, or before its small motions are looked at; from its path on.
std::string said_of_load(const std::string& load, bool run, const std::string& position) {
  try {
    const Prepared prepared = slider("loads:\n  l: {type: " + load + "}\n", position);
    if (run)
      check_start(prepared);
    else
      static_cast<void>(Configuration(prepared, prepared.scene.initial, {}));
  } catch (const SceneError& e) {
    const std::string text = e.what();
    return text.starts_with("s.yaml:7:") ? text.substr(text.find("/loads")) : text;
  }
  return {};
}

std::string said_of(const std::string& fault, bool run, const std::string& position = "0.05") {
  return said_of_load("faulty, fault: " + fault, run, position);
}

TEST(CheckLoads, WithFalseDerivativesAreRefusedAtTheirPlace) {
  const std::string at = "/loads/l: load 'l' ", says = at + "says that ";
  const std::string along = " with a displacement along 'h.0' (add_derivatives), where it changes by ";
  for (const bool run : {true, false}) {
    EXPECT_EQ(said_of("nothing", run), "");
    EXPECT_EQ(said_of("sign", run), says + "its effort on 'h.0' changes by 300" + along + "-3");
    EXPECT_EQ(said_of("forgets", run), says + "its effort on 'h.0' changes by 0" + along + "-3");
    EXPECT_EQ(said_of("throws", run), at + "does not say its derivatives: out of order");
    EXPECT_EQ(said_of("filter", run), "");
    EXPECT_EQ(said_of("filter-forgets", run), says + "the rate of its state 'z' changes by 0" + along + "1");
  }
}

/// Where the digits of a coordinate are 1e-8 and 6e-8 m, and at 1e-3 m.
TEST(CheckLoads, FarFromTheOriginAreRightAndTheirFaultsAreSeen) {
  for (const std::string& far : {std::string("4.2164e7"), std::string("3.844e8"), std::string("1e13")}) {
    for (const std::string& law :
         {"hinge-spring, hinge: h, stiffness: 0.1, damping: 0.3, free_position: " + far,
          "pd-controller, duration: 1, hinges: {h: {from: " + far + ", to: " + far + ", stiffness: 10, damping: 1}}",
          "pid, hinge: h, reference: " + far + ", proportional: 10, derivative: 1, integral: 1",
          "transfer-function, hinge: h, reference: " + far + ", numerator: [40, 80], denominator: [0.02, 1]"}) {
      EXPECT_EQ(said_of_load(law, true, far), "") << far << ": " << law;
      EXPECT_EQ(said_of_load(law, false, far), "") << far << ": " << law;
    }
    if (far == "1e13") continue;  // what is wrong by 300 N/m is lost in 3e13 N
    EXPECT_THAT(said_of("sign", true, far), HasSubstr("its effort on 'h.0' changes by 300 with a displacement along"));
    EXPECT_THAT(said_of("forgets", true, far), HasSubstr("its effort on 'h.0' changes by 0 with a displacement along"));
  }
}

/// Studies of a scene refuse it as a run does, before they run anything.
TEST(CheckLoads, WithFalseDerivativesAreRefusedByStudiesToo) {
  const Prepared wrong = slider("loads:\n  l: {type: faulty, fault: sign}\n");
  const Outputs outputs = Outputs::all(wrong.model());
  const auto told = [](const auto& study) -> std::string {
    try {
      study();
    } catch (const SceneError& e) {
      return e.what();
    }
    return {};
  };
  const std::string says = "load 'l' says that its effort on 'h.0' changes by 300";
  EXPECT_THAT(told([&] { const Evaluator evaluator(wrong, with_faulty(), outputs, {}); }), HasSubstr(says)) << "advise";
  EXPECT_THAT(told([&] { const TradeStudy trade(wrong, with_faulty(), {}, {}); }), HasSubstr(says));
  EXPECT_THAT(told([&] { const TermStudy terms(wrong, with_faulty()); }), HasSubstr(says));
  EXPECT_THAT(told([&] {
                static_cast<void>(
                    compare(wrong.values, with_faulty(), {"ruthless"}, "quadratic",
                            [](const Prepared&, const auto&) -> RunSummary { throw std::logic_error("it ran"); }));
              }),
              HasSubstr(says));
}

TEST(CheckLoads, WithAKinkWhereTheMotionBeginsAreRight) {
  EXPECT_EQ(said_of("kink", true), "");
  EXPECT_EQ(said_of("kink", false), "");
}

/// The efforts of other loads on 'h.0' would be lost, or not, by the order of the loads.
TEST(CheckLoads, ThatSetTheirEffortsAreRefusedAtTheirPlace) {
  const auto refusal = [](const std::string& function) {
    return "/loads/l: load 'l' does not add its effort on 'h.0' (" + function +
           "): it sets efforts, and is to add to them";
  };
  for (const bool run : {true, false}) {
    EXPECT_EQ(said_of("sets", run), refusal("BoundLoad::add"));
    EXPECT_EQ(said_of("filter-sets", run), refusal("ContinuousPart::add"));
  }
  EXPECT_EQ(said_of("relay-sets", true), refusal("DiscretePart::add")) << "small motions refuse what switches";
}

TEST(CheckLoads, ThatRememberCallsAreRefusedAtTheirPlace) {
  for (const bool run : {true, false})
    EXPECT_EQ(said_of("remembers", run),
              "/loads/l: load 'l' gives another effort at a second call for the same state on 'h.0' (BoundLoad::add): "
              "what it remembers is to stand in its discrete or continuous states");
}

/// The body of 2 kg: u̇ = (−3 x − 2 z) / 2, ż = x − z + u̇, where add_derivatives has no place for u̇.
TEST(CheckLoads, WhoseRatesMeasureAccelerationsAreDifferentiatedWithThem) {
  const Prepared prepared = slider("loads:\n  l: {type: faulty, fault: filter-feels}\n");
  const LinearModel m = linear_model({prepared, prepared.scene.initial, {}}, {{"h"}, {}});
  ASSERT_EQ(m.states.size(), 3U);
  EXPECT_LT((m.system.A.row(2) - Eigen::RowVector3d(-0.5, 0, -2)).cwiseAbs().maxCoeff(), 1e-9) << m.system.A;
  EXPECT_NEAR(m.system.B(2, 0), 0.5, 1e-9);
  EXPECT_THAT(m.derivatives, HasSubstr("the loads l"));
}

TEST(CheckLoads, WithoutNumbersWhereTheySwitchOrHoldAreRefused) {
  EXPECT_EQ(said_of("relay", true), "");
  EXPECT_THAT(said_of("switch", true), HasSubstr("/loads/l: load 'l' switches where functions are zero, and number 0 "
                                                 "of them has no value at 0 s"));
  EXPECT_THAT(said_of("held", true), HasSubstr("/loads/l: load 'l' begins with no number in its discrete states"));
}

TEST(CheckIntegrator, ThatFailsIsToldAtItsPlaceWithItsName) {
  const auto told = [](const std::string& fault, const auto& use) -> std::string {
    try {
      use(slider("integrator: {name: faulty, fault: " + fault + "}\n"));
    } catch (const SceneError& e) {
      return e.what();
    }
    return {};
  };
  EXPECT_THAT(told("none", [](const Prepared& p) { check_start(p); }),
              HasSubstr("/integrator: integrator 'faulty' cannot begin and does not say why"));
  EXPECT_THAT(told("order", [](const Prepared& p) { check_start(p); }),
              HasSubstr("/integrator: integrator 'faulty' says that it is of order -3; need at least 1"));
  EXPECT_THAT(told("step", [](const Prepared& p) { static_cast<void>(run(p, with_faulty())); }),
              HasSubstr("/integrator: integrator 'faulty' does not step: out of order"));
}

}  // namespace
}  // namespace withy::study
