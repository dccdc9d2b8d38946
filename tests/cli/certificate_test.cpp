#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "withy/tests/cli/process.hpp"

namespace withy::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

json run_json(const std::vector<std::string>& more) {
  const Folder folder;
  std::vector<std::string> arguments = {"run"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  arguments.emplace_back("--json");
  const Finished f = withy(folder, arguments);
  EXPECT_EQ(f.err, "");
  return json::parse(f.out);
}

/// Distances of a formulation from `quadratic`, both run with the scene's tolerances, at outputs that miss no peak.
json true_distances(const std::vector<std::string>& scene, const std::string& formulation) {
  const Folder folder;
  std::vector<std::string> arguments = {"compare"};
  arguments.insert(arguments.end(), scene.begin(), scene.end());
  for (const std::string a : {"--formulations", formulation.c_str(), "--set", "time.output=0.01", "--json"})
    arguments.push_back(a);
  return json::parse(withy(folder, arguments).out).at("runs").at(0).at("distance");
}

/// What an estimate may cost: a tenth of the run; anything; anything, as there is none for a tenth.
enum class Price { tenth, any, any_alone };
struct Claim {
  std::vector<std::string> scene;
  std::string formulation;
  Price price = Price::tenth;
};
void PrintTo(const Claim& claim, std::ostream* out) { *out << claim.scene.at(0) << ' ' << claim.formulation; }

class ErrorClaimed : public testing::TestWithParam<Claim> {};

// Coarse steps at a tenth of the run's cost resolve what they are after to some per cent, a pair at any cost to one: a
// factor of 1.2 leaves room for outputs that fall between. Stiff loops say that they have an estimate at any cost
// alone; strict formulations at a tenth have their own factor (EstimatedStrictScenes).
TEST_P(ErrorClaimed, IsTheTrueOneForHingesAndTips) {
  const Claim& claim = GetParam();
  std::vector<std::string> arguments = claim.scene;
  arguments.insert(arguments.end(), {"--formulation", claim.formulation});
  if (claim.price == Price::any_alone) {
    const json certificate = run_json(arguments).at("certificate");
    EXPECT_TRUE(certificate.at("estimated_error").is_null());
    EXPECT_THAT(certificate.at("without_estimate").get<std::string>(), HasSubstr("`--estimate always`"));
  }
  if (claim.price != Price::tenth) arguments.insert(arguments.end(), {"--estimate", "always"});
  const json certificate = run_json(arguments).at("certificate");
  const json& estimate = certificate.at("estimated_error");
  EXPECT_EQ(estimate.at("against"), "quadratic");
  EXPECT_GT(estimate.at("evaluations"), 0);
  const json truth = true_distances(claim.scene, claim.formulation);
  for (const char* kind : {"hinges", "tips"}) {
    for (const auto& [name, value] : truth.at(kind).items()) {
      const double real = value, claimed = estimate.at(kind).at(name);
      if (real < 1e-6) continue;  // of the order of the tolerances
      EXPECT_LT(claimed, 1.2 * real) << name;
      EXPECT_GT(claimed, real / 1.2) << name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, ErrorClaimed,
    testing::Values(Claim{{"scenes/driven-arm.yaml"}, "linear"}, Claim{{"scenes/driven-arm.yaml"}, "ruthless"},
                    Claim{{"scenes/two-link-slew.yaml"}, "ruthless"},
                    Claim{{"scenes/two-link-slew.yaml"}, "consistent", Price::any},
                    Claim{{"scenes/commanded-arm.yaml"}, "ruthless", Price::any_alone},
                    Claim{{"scenes/beam-on-base.yaml"}, "consistent"},
                    Claim{{"scenes/two-link-slew.yaml", "--set", "loads.slew.time_scale=1.2"}, "ruthless"},
                    Claim{{"scenes/screw.yaml"}, "ruthless"}, Claim{{"scenes/beam-on-base.yaml"}, "ruthless"}));

TEST(Certificate, OfTheLinearDrivenArmNamesThreeCentimetres) {
  const Folder folder;
  const Finished f = withy(folder, {"run", "scenes/driven-arm.yaml", "--formulation", "linear"});
  const json c = json::parse(folder.read("results/driven-arm-linear/run.json")).at("certificate");
  EXPECT_NEAR(c.at("estimated_error").at("tips").at("payload.tip").get<double>(), 0.036, 0.003);
  EXPECT_GT(c.at("neglected_acceleration").at("rms").get<double>(), 0.1);
  EXPECT_EQ(c.at("steps").at("limited_by"), "accuracy");
  EXPECT_THAT(f.out, HasSubstr("payload.tip 36 mm"));
}

TEST(Certificate, OfAQuadraticRunIsAgainstExactAndEstimatesOnDemand) {
  const std::vector<std::string> scene = {"scenes/two-link-slew.yaml", "--set", "time.end=1"};
  json c = run_json(scene).at("certificate");
  EXPECT_EQ(c.at("neglected_acceleration").at("against"), "exact");
  EXPECT_TRUE(c.at("estimated_error").is_null());
  std::vector<std::string> always = scene;
  always.insert(always.end(), {"--estimate", "always"});
  c = run_json(always).at("certificate");
  EXPECT_EQ(c.at("estimated_error").at("against"), "exact");
  EXPECT_EQ(c.at("estimated_error").at("until"), 1.0);
  c = run_json(
          {"scenes/two-link-slew.yaml", "--set", "time.end=0.1", "--estimate", "never", "--formulation", "ruthless"})
          .at("certificate");
  EXPECT_TRUE(c.at("estimated_error").is_null());
}

// A stiff boom with a loose tolerance: the step is what the highest mode allows.
TEST(Certificate, SaysThatNothingMovesAndNotWhatLimitsTheStep) {
  const std::vector<std::string> still = {"scenes/spinning-boom.yaml",
                                          "--set",
                                          "initial={}",
                                          "--set",
                                          "gravity=[0, 0, 0]",
                                          "--set",
                                          "loads={}",
                                          "--set",
                                          "motions={}",
                                          "--set",
                                          "time.end=5"};
  EXPECT_EQ(run_json(still).at("certificate").at("steps").at("limited_by"), "unknown");
  std::vector<std::string> call = {"run"};
  call.insert(call.end(), still.begin(), still.end());
  const Folder folder;
  EXPECT_THAT(withy(folder, call).out, testing::HasSubstr("nothing moves: there is no energy in the tree"));
}

TEST(Certificate, SaysThatStabilityLimitsTheStep) {
  const std::vector<std::string> stiff = {"scenes/two-link-slew.yaml",
                                          "--set",
                                          "bodies.link1.bending_y.stiffness=1e7",
                                          "--set",
                                          "bodies.link2.bending_y.stiffness=1e7",
                                          "--set",
                                          "time.end=0.5"};
  std::vector<std::string> loose = stiff;
  loose.insert(loose.end(), {"--set", "integrator={name: dopri5, rtol: 1e-3, atol: 1e-3}"});
  const json steps = run_json(loose).at("certificate").at("steps");
  EXPECT_EQ(steps.at("limited_by"), "stability");
  // What is proposed holds: that mode left out, the fastest is the one foretold, and as many fewer steps are taken.
  const std::string mode = steps.at("fewer_modes").at("without");
  ASSERT_THAT(mode, testing::MatchesRegex("link[12]\\.bending_y\\[2\\]"));
  const double foretold = steps.at("fewer_modes").at("fastest_mode");
  EXPECT_LT(foretold, steps.at("fastest_mode").get<double>());
  EXPECT_EQ(steps.at("unlimited_integrators"), (json{"imex", "radau"}));
  std::vector<std::string> fewer = loose;
  fewer.insert(fewer.end(), {"--set", "bodies." + mode.substr(0, 5) + ".bending_y.modes=1"});
  const json slower = run_json(fewer).at("certificate").at("steps");
  EXPECT_NEAR(slower.at("fastest_mode").get<double>() / foretold, 1, 0.02) << "at another state";
  EXPECT_NEAR(slower.at("mean").get<double>() / steps.at("mean").get<double>(),
              steps.at("fastest_mode").get<double>() / foretold,
              0.3 * steps.at("fastest_mode").get<double>() / foretold);
  // The strict formulations have no symmetric matrix for imex.
  loose.insert(loose.end(), {"--formulation", "consistent"});
  const json strict = run_json(loose).at("certificate").at("steps");
  EXPECT_EQ(strict.at("limited_by"), "stability");
  EXPECT_EQ(strict.at("unlimited_integrators"), json{"radau"});
}

TEST(Certificate, OfABodyFormulationLooksAtWhatTheBodyLeavesOut) {
  const json c =
      run_json({"scenes/two-link-slew.yaml", "--set", "bodies.link2.formulation=ruthless"}).at("certificate");
  EXPECT_EQ(c.at("neglected_acceleration").at("against"), "quadratic");
  EXPECT_GT(c.at("estimated_error").at("tips").at("payload.tip").get<double>(), 1e-3);
  EXPECT_EQ(c.at("formulation").at("bodies").at("link2").at("name"), "ruthless");
  EXPECT_FALSE(c.at("formulation").at("bodies").contains("link1"));
}

TEST(Certificate, SaysOfAMixWhichBodiesTheFormulationDoesNotHoldFor) {
  const Folder folder;
  const std::string out = withy(folder, {"run", "scenes/two-link-slew.yaml", "--set", "time.end=0.1", "--set",
                                         "bodies.link1.formulation=ruthless"})
                              .out;
  EXPECT_THAT(out, HasSubstr("but 'link1' in ruthless: "));
  EXPECT_THAT(out, HasSubstr("a mix conserves no more"));
}

}  // namespace
}  // namespace withy::test
