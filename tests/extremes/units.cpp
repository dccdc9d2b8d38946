/// \file
/// Every scene in other units, powers of two apart: the same bits but for exponents. An absolute threshold anywhere
/// between the scene's text and the last step of a run breaks that.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>

#include "folder.hpp"
#include "scaled_scene.hpp"

namespace withy::extremes {
namespace {

std::vector<double> times(const std::vector<double>& a, const std::vector<double>& factors) {
  std::vector<double> product;
  for (std::size_t i = 0; i < a.size(); ++i) product.push_back(a[i] * factors[i]);
  return product;
}

/// Equal bit by bit, NaN alike; −0 and 0 apart are equal.
bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

/// States of a scene: its start, and moderate motions of all coordinates.
std::vector<State> states_of(const Made& made) {
  std::vector<State> states{made.scene.initial};
  std::mt19937 random(5);
  std::uniform_real_distribution<double> one(-1, 1);
  for (int k = 0; k < 3; ++k) {
    State s = made.scene.initial;
    s.time = 0.6 + 0.8 * k;
    for (std::size_t i = 0; i < made.layout().speeds; ++i) s.y[made.layout().positions + i] += 0.5 * one(random);
    for (const Slot& slot : made.layout().hinges)
      for (std::size_t i = 0; i < slot.positions; ++i) s.y[slot.position + i] += one(random);
    for (const Slot& slot : made.layout().bodies)
      for (std::size_t i = 0; i < slot.positions; ++i) s.y[slot.position + i] += 0.02 * one(random);
    made.model().prescribe(s);
    made.equations->normalize(s.y);
    states.push_back(std::move(s));
  }
  return states;
}

/// What of a scene in one formulation is not the same in the gauge's units: empty where all of it is.
std::string differences(const Made& made, const Made& scaled, const Gauge& gauge, std::size_t steps) {
  const auto factors = state_factors(made.model(), gauge), rates = state_factors(made.model(), gauge, 1);
  const auto moved = [&](const State& s) { return State{s.time * gauge.factor("s"), times(s.y, factors)}; };
  std::string wrong;
  int state = 0;
  for (const State& s : states_of(made)) {
    const std::vector<double> here = made.rates(s), there = scaled.rates(moved(s));
    const std::vector<double> expected = times(here, rates);
    if (!same(there, expected))
      wrong += fmt::format("derivatives at state {} ({:.1g}); ", state, difference(there, expected));
    const Energies a = made.equations->energies(s.y), b = scaled.equations->energies(moved(s).y);
    const double joule = gauge.factor("J");
    if (b.kinetic != a.kinetic * joule || b.potential != a.potential * joule)
      wrong += fmt::format("energies at state {}; ", state);
    ++state;
  }
  const double h = 0.001;
  const auto stepper =
      integrator(fmt::format("{{name: rk4, step: {:.17g}}}", h))->start(*made.equations, made.scene.initial);
  const auto other = integrator(fmt::format("{{name: rk4, step: {:.17g}}}", h * gauge.factor("s")))
                         ->start(*scaled.equations, moved(made.scene.initial));
  // A run that diverges is compared until it is beyond all motion, 1e4 m or rad: a step or two later its stages
  // overflow, in the one units and not yet in the other.
  const auto diverged = [&] {
    const std::vector<double>& y = stepper->state().y;
    return std::any_of(y.begin(), y.end(), [](double v) { return !(std::abs(v) < 1e4); });
  };
  for (std::size_t i = 0; i < steps && !diverged(); ++i) {
    const double end = h * static_cast<double>(i + 1);
    if (stepper->step(end).outcome != other->step(end * gauge.factor("s")).outcome) {
      wrong += fmt::format("outcome of step {}; ", i);
      break;
    }
  }
  if (!same(other->state().y, times(stepper->state().y, factors)))
    wrong += fmt::format("{} steps of rk4 ({:.1g}); ", steps,
                         difference(other->state().y, times(stepper->state().y, factors)));
  return wrong;
}

}  // namespace

void units(Campaign& campaign) {
  const std::size_t steps = campaign.quick() ? 20 : 1000;
  const Folder folder;
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(WITHY_SCENES))
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem());
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) {
    std::string wrong, left_out;
    int compared = 0;
    bool controlled = false;
    for (const std::string& formulation : formulations) {
      try {
        const std::string file = std::string(WITHY_SCENES) + "/" + name + ".yaml";
        Made made(text_of(file), formulation, {}, file);
        // Gains of controllers have the units of what they measure and move, which no specification tells.
        controlled = made.layout().continuous > 0;
        if (controlled) break;
        const Gauge gauge;
        const Made scaled(scaled_text(made.scene, made.registry, gauge, folder.path), formulation);
        const std::string d = differences(made, scaled, gauge, steps);
        if (!d.empty()) wrong += formulation + ": " + d;
        ++compared;
      } catch (const std::invalid_argument& e) {
        if (std::string(e.what()).find("exact kinematics") == std::string::npos) left_out = e.what();
      }
    }
    if (controlled) continue;
    if (compared == 0) {
      campaign.row(name, "the same scene", "bitwise", "not compared: " + left_out, false);
    } else {
      campaign.holds(fmt::format("{}, {} formulations, {} steps", name, compared, steps),
                     "the same scene, kg·2¹⁰, m·2⁴, s·2²", "bitwise", wrong);
    }
  }
  // The campaign would see one: a scene whose hub takes lengths below 1e-3 for nothing, in units in which all are.
  Made made(scene_text("two-link-slew"));
  const Gauge small{0, -20, 0};
  const std::string text = scaled_text(made.scene, made.registry, small, folder.path);
  auto planted = nlohmann::ordered_json::parse(text);
  for (auto& x : planted["bodies"]["hub"]["frames"]["out"]["position"])
    if (std::abs(x.get<double>()) < 1e-3) x = 0.0;
  const std::string without = differences(made, Made(text, "quadratic"), small, 5);
  const std::string with = differences(made, Made(planted.dump(), "quadratic"), small, 5);
  campaign.row(
      "a planted threshold of 1e-3 m, metres times 2⁻²⁰", "–", "seen, and nothing without it",
      (without.empty() ? "nothing without it, " : without + ", ") + std::string(with.empty() ? "not seen" : "seen"),
      without.empty() && !with.empty());
}

}  // namespace withy::extremes
