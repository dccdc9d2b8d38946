/// \file
/// Numbers that are none, from loads, bodies, tables; steps that collapse; jumps that nobody declared.
#include <algorithm>
#include <cmath>

#include "campaign.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/tests/conformance/integrator_problems.hpp"
#include "withy/tests/simulation/oscillator.hpp"

namespace withy::extremes {
namespace {

const std::string swinging =
    "format: withy/1\ngravity: [0, -9.81, 0]\ntime: {end: 1}\nbodies:\n  arm: {type: beam, length: 1, mass_per_length: "
    "1, "
    "bending_y: {stiffness: 50, modes: 2}}\n  bob: {type: rigid, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}\nhinges:\n"
    "  pivot: {type: revolute, axis: [0, 0, 1], parent: world, child: arm}\n  tip: {type: weld, parent: arm.tip, "
    "child: bob}\n";

std::shared_ptr<const Integrator> with_default_options(const std::string& id, bool loose = false) {
  Registry registry;
  enroll_static_plugins(registry);
  const auto& parameters = registry.find<Integrator>(id)->parameters;
  const bool step = std::any_of(parameters.begin(), parameters.end(),
                                [](const ParameterSpec& p) { return p.key == "step" && p.required; });
  return integrator(step ? "{name: " + id + ", step: 0.001}"
                         : "{name: " + id + (loose ? ", rtol: 1e-4, atol: 1e-6}" : "}"));
}

struct Ended {
  RunSummary summary;
  bool finite = true;
};

Ended run(const Model& model, const EquationsOfMotion& equations, const Integrator& method, const State& from,
          double end = 1) {
  RunOptions options;
  options.end = end;
  options.most_seconds = 20;
  Ended e;
  e.summary = simulate(model, equations, method, from, options, [&](const State& s) {
    for (const double y : s.y) e.finite = e.finite && std::isfinite(y);
  });
  for (const double y : e.summary.final.y) e.finite = e.finite && std::isfinite(y);
  return e;
}

/// An attempt of these asks for stages again and again, and some for a Jacobian by differences.
bool linearly_implicit(const std::string& id) { return id == "rosenbrock-w" || id == "imex"; }
bool iterates(const std::string& id) {
  return id == "radau" || id == "gauss" || id == "generalized-alpha" || id == "cvode";
}

void from_loads(Campaign& campaign) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const auto& [what, value] : {std::pair("NaN", std::nan("")), {"Inf", inf}, {"-Inf", -inf}}) {
    std::string bad;
    std::size_t most = 0, most_iterated = 0;
    for (const std::string& id : ids<Integrator>()) {
      for (const std::string formulation : {"quadratic", "consistent", "exact"}) {
        if (linearly_implicit(id) && formulation == "consistent") continue;  // has no solver there
        const Made made(swinging, formulation);
        auto model = std::make_shared<Model>(made.model());
        model->add_load("sound", TestLoad([](double) { return 0.1; }));
        std::size_t calls = 0;  // of the load where it is broken
        model->add_load("broken", TestLoad([v = value, &calls](double t) { return t < 0.5 ? 0.0 : (++calls, v); }));
        std::unique_ptr<EquationsOfMotion> equations;
        try {
          equations = made.scene.formulation->compile(model);
          const Ended e = run(*model, *equations, *with_default_options(id), made.scene.initial);
          const RunSummary& s = e.summary;
          std::size_t& greatest = iterates(id) ? most_iterated : most;
          greatest = std::max(greatest, calls);
          if (s.status != RunStatus::diverged || !e.finite || std::abs(s.final.time - 0.5) > 2e-3 ||
              s.message.find("load 'broken' gives") == std::string::npos ||
              s.message.find("pivot.0") == std::string::npos || s.message.find("'sound'") != std::string::npos)
            bad += fmt::format("{}/{}: {} at {:.4g}: {}; ", id, formulation, name(s.status), s.final.time, s.message);
        } catch (const std::invalid_argument&) {
          continue;  // the integrator says that it cannot treat this formulation
        }
      }
    }
    campaign.row(
        fmt::format("a load gives {} from 0.5 s on, every integrator", what), "typed failure",
        "diverged at 0.5 s, load and coordinate named, last state kept; called ≤ 60 times past it, ≤ 160 where a step "
        "iterates",
        bad.empty() ? fmt::format("holds; at most {} calls, {} where a step iterates", most, most_iterated) : bad,
        bad.empty() && most <= 60 && most_iterated <= 160);
  }
}

void from_bodies(Campaign& campaign) {
  const auto said = [](auto&& make) -> std::string {
    try {
      make();
    } catch (const std::exception& e) {
      return e.what();
    }
    return "accepted";
  };
  const std::string mass = said([] {
    Model({test_node("boom", test_rigid(std::nan(""), Vector3::Zero(), Matrix3::Identity()))},
          {{.name = "h", .hinge = nullptr, .offset = {}, .child = 0}}, Vector3::Zero());
  });
  campaign.row("a body plugin with a mass of NaN", "validation of shapes", "refused, 'boom' named", mass,
               mass.find("'boom'") != std::string::npos);
  for (const char* value : {".nan", ".inf", "1e999", "-.inf"}) {
    const std::string text = said([&] { const Made made(swinging, "", {std::string("bodies.arm.length=") + value}); });
    campaign.row(fmt::format("{} in a scene", value), "the reader", "refused with its place", text.substr(0, 80),
                 text.find("/bodies/arm/length") != std::string::npos);
  }
  const std::string table = said([] {
    const Made made(swinging +
                    "loads: {m: {type: hinge-effort, hinge: pivot, law: table, table: [[0, 1], [1, .nan]]}}\n");
  });
  campaign.row(".nan in a table", "the reader", "refused with its place", table.substr(0, 80),
               table.find("/loads/m/table") != std::string::npos);
  // Numbers that are finite and overflow when they are multiplied.
  std::string bad;
  for (const std::string& formulation : formulations) {
    const Made made(swinging, formulation, {"initial.hinges.pivot.rate=[1e200]"});
    const Ended e = run(made.model(), *made.equations, *made.scene.integrator, made.scene.initial);
    if (e.summary.status == RunStatus::completed || e.summary.status == RunStatus::interrupted || !e.finite)
      bad += fmt::format("{}: {}; ", formulation, name(e.summary.status));
  }
  campaign.holds("a hinge at 1e200 rad/s, whose square overflows", "typed failure", "ends typed, all finite", bad);
}

void collapse(Campaign& campaign) {
  const FunctionEquations pole(1, 1, [](double t, std::span<const double>, std::span<double> f) {
    f[0] = 0;
    f[1] = 1 / (t - 1);
    f[2] = 0;
    return Evaluation{};
  });
  for (const std::string& id : ids<Integrator>()) {
    if (id == "rk4" || id == "gauss" || id == "generalized-alpha") continue;  // equal steps
    std::string text;
    bool met = false;
    try {
      const auto stepper = with_default_options(id)->start(pole, State{0, {0, 0, 0}});
      const StepResult r = drive(*stepper, 2);
      met = r.outcome == StepResult::Outcome::step_underflow && std::abs(stepper->state().time - 1) < 1e-3;
      text = fmt::format("{} at t = 1 − {:.1g}",
                         r.outcome == StepResult::Outcome::step_underflow ? "step-underflow" : "other",
                         1 - stepper->state().time);
    } catch (const std::exception& e) {
      text = e.what();
      continue;  // not for these equations, and says so
    }
    campaign.row(id + ", ẏ = 1/(t − 1)", "log |t − 1| has no end", "step-underflow before t = 1", text, met);
  }
  const Made made(swinging);
  RunOptions options;
  options.end = 1e6;
  options.most_steps = 1000;
  const RunSummary steps =
      simulate(made.model(), *made.equations, *made.scene.integrator, made.scene.initial, options, {});
  options.most_steps = 100'000'000;
  options.most_seconds = 0.2;
  const RunSummary wall =
      simulate(made.model(), *made.equations, *made.scene.integrator, made.scene.initial, options, {});
  campaign.row(
      "limits of steps and of wall time", "–", "interrupted, the limit named", steps.message + " " + wall.message,
      steps.status == RunStatus::interrupted && wall.status == RunStatus::interrupted && steps.steps.accepted == 1000);
}

void undeclared(Campaign& campaign) {
  const auto jump = [](double t) { return t < 0.4321 ? 5.0 : -5.0; };
  for (const char* id : {"dopri5", "dop853", "rk4-adaptive"}) {
    std::vector<double> found[2];
    for (const bool declared : {false, true}) {
      const Made made(swinging);
      auto model = std::make_shared<Model>(made.model());
      model->add_load("switch", TestLoad(jump, declared ? std::vector<double>{0.4321} : std::vector<double>{}));
      const auto equations = made.scene.formulation->compile(model);
      found[declared ? 1 : 0] =
          run(*model, *equations, *integrator(fmt::format("{{name: {}, rtol: 1e-9, atol: 1e-11}}", id)),
              made.scene.initial)
              .summary.suspected_jumps;
    }
    campaign.row(fmt::format("{}, a torque that jumps at 0.4321 s", id), "the jump",
                 "reported within 1e-2 s, and only where not declared",
                 fmt::format("{} reported undeclared{}, {} declared", found[0].size(),
                             found[0].empty() ? "" : fmt::format(" ({:.5f} s)", found[0].front()), found[1].size()),
                 found[0].size() == 1 && std::abs(found[0].front() - 0.4321) < 1e-2 && found[1].empty());
  }
}

}  // namespace

void failures(Campaign& campaign) {
  from_loads(campaign);
  from_bodies(campaign);
  collapse(campaign);
  undeclared(campaign);
}

}  // namespace withy::extremes
