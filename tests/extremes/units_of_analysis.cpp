/// \file
/// Modes and steady states of every scene in other units, far apart: what is said of them is the same, and numbers are
/// to rounding. An absolute threshold anywhere in the linear analyses breaks that.
#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>

#include "folder.hpp"
#include "scaled_scene.hpp"
#include "withy/study/equilibrium.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/modes.hpp"
#include "withy/study/prepared.hpp"

namespace withy::extremes {
namespace {

/// What the analyses say of a scene in a state, in its own units of time.
struct Said {
  std::vector<std::complex<double>> eigenvalues;
  std::vector<bool> rigid;
  std::string facts;
};

Said said_of(const std::string& text, const std::string& formulation, const State& state, Registry& registry) {
  SceneValues values = SceneValues::parse(text, "text");
  values.set_text("formulation=" + formulation);
  const study::Prepared prepared = study::prepare(std::move(values), registry);
  const study::Configuration at(prepared, state, {});
  Said said;
  const study::ModesAt modes = study::modes_at(at, true);
  for (const Mode& m : modes.modes) {
    said.eigenvalues.push_back(m.eigenvalue);
    said.rigid.push_back(m.rigid);
  }
  const study::Equilibrium found = study::find_equilibrium(at, {}, registry);
  said.facts = fmt::format("modes {}, steady {}", modes.problem.empty() ? "found" : "none", found.problem.empty());
  if (found.problem.empty())
    said.facts += fmt::format(", stays {}, neutral {}", found.stays, found.steady.neutral.size() > 0);
  if (modes.turn)
    said.facts += fmt::format(", periodic {}, balanced {}", modes.turn->check.periodic(), modes.turn->check.steady);
  return said;
}

/// What differs; `time` is the factor of seconds.
std::string differences(const Said& here, const Said& there, double time) {
  std::string wrong;
  if (here.facts != there.facts) wrong += fmt::format("{}, there {}; ", here.facts, there.facts);
  if (here.eigenvalues.size() != there.eigenvalues.size())
    return wrong + fmt::format("{} modes, there {}; ", here.eigenvalues.size(), there.eigenvalues.size());
  for (std::size_t i = 0; i < here.eigenvalues.size(); ++i) {
    if (here.rigid[i] != there.rigid[i])
      wrong += fmt::format("mode {} is rigid in one ({:.3g}{:+.3g}i, there {:.3g}{:+.3g}i); ", i + 1,
                           here.eigenvalues[i].real(), here.eigenvalues[i].imag(), there.eigenvalues[i].real() * time,
                           there.eigenvalues[i].imag() * time);
    const std::complex<double> a = here.eigenvalues[i], b = there.eigenvalues[i] * time;
    const double size = std::max(std::abs(a), 1e-6 * std::abs(here.eigenvalues.back()));
    if (!here.rigid[i] && !(std::abs(a - b) <= 1e-6 * size))
      wrong += fmt::format("mode {} at {:.6g}{:+.6g}i, there {:.6g}{:+.6g}i; ", i + 1, a.real(), a.imag(), b.real(),
                           b.imag());
  }
  return wrong;
}

/// The scene's start. Hinges of several rates rest: where such a one turns about no principal axis, motions that
/// nothing holds make long chains of zeros, which are found to a root of rounding.
State start_of(const Made& made) {
  State state = made.scene.initial;
  for (const Slot& slot : made.layout().hinges)
    if (slot.speeds > 1)
      std::fill_n(state.y.begin() + static_cast<std::ptrdiff_t>(made.layout().positions + slot.speed), slot.speeds,
                  0.0);
  return state;
}

State in_units(State state, const Model& model, const Gauge& gauge) {
  state.time *= gauge.factor("s");
  const std::vector<double> factors = state_factors(model, gauge);
  for (std::size_t i = 0; i < state.y.size(); ++i) state.y[i] *= factors[i];
  return state;
}

/// The scene in units of a gauge, as far as analyses see it.
std::string text_in(const Made& made, Registry& registry, const Gauge& gauge, const std::filesystem::path& folder) {
  auto json = nlohmann::ordered_json::parse(scaled_text(made.scene, registry, gauge, folder));
  json.erase("outputs");
  return json.dump();
}

/// What is said otherwise in one of the units, formulation by formulation; `left_out` becomes why a scene has no part.
std::string differences(const std::filesystem::path& file, bool quick, std::string& left_out) {
  const std::vector<Gauge> all = {{0, 0, 15}, {-40, -15, 10}, {30, 0, 0}, {-30, 0, 0},
                                  {0, 15, 0}, {0, -15, 0},    {0, 0, -15}};
  const Folder folder;
  std::string wrong;
  for (const std::string formulation : {"quadratic", "exact"}) {
    if (quick && formulation == "exact") continue;
    try {
      Made made(text_of(file), formulation, {}, file);
      if (made.layout().continuous > 0) throw std::invalid_argument("gains have units that no specification tells");
      if (made.scene.source.has("constraints")) throw std::invalid_argument("analyses take no closed loops");
      const State start = start_of(made);
      const Said here =
          said_of(text_in(made, made.registry, {0, 0, 0}, folder.path), formulation, start, made.registry);
      for (const Gauge& gauge : std::span(all).first(quick ? 2 : all.size())) {
        const Said there = said_of(text_in(made, made.registry, gauge, folder.path), formulation,
                                   in_units(start, made.model(), gauge), made.registry);
        if (const std::string d = differences(here, there, gauge.factor("s")); !d.empty())
          wrong += fmt::format("{} kg·2^{} m·2^{} s·2^{}: {}", formulation, gauge.mass, gauge.length, gauge.time, d);
      }
    } catch (const SceneError& e) {
      if (formulation == "quadratic") left_out = e.what();
    } catch (const std::invalid_argument& e) {
      if (formulation == "quadratic") left_out = e.what();
    } catch (const study::InputError& e) {
      if (formulation == "quadratic") left_out = e.what();
    }
  }
  return wrong;
}

}  // namespace

void units_of_analysis(Campaign& campaign) {
  std::vector<std::filesystem::path> files;
  for (const char* where : {"", "/gallery"})
    for (const auto& entry : std::filesystem::directory_iterator(std::string(WITHY_SCENES) + where))
      if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const std::filesystem::path& file : files) {
    std::string left_out;
    const std::string wrong = differences(file, campaign.quick(), left_out);
    if (left_out.empty())
      campaign.holds(file.stem(), "the same scene in units up to 2⁴⁰ apart", "what is said, eigenvalues to 1e-6",
                     wrong);
  }
}

}  // namespace withy::extremes
