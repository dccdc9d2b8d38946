// Files of studies have in each column, and under each name, what their heads say.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <complex>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "withy/plugins/host/static_plugins.hpp"
#include "withy/results/certificate_text.hpp"
#include "withy/results/effective_mass_files.hpp"
#include "withy/results/modes_files.hpp"
#include "withy/results/response_files.hpp"
#include "withy/results/trade_files.hpp"
#include "withy/scene/scene_values.hpp"
#include "withy/study/configuration.hpp"
#include "withy/study/prepared.hpp"
#include "withy/tests/results/cells.hpp"
#include "withy/tests/results/scratch.hpp"

namespace withy {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

using test::cells;

/// The cells of the first row of a table, by the heads of their columns.
std::map<std::string, std::string> first_row(const std::string& table) {
  std::istringstream stream(table);
  std::string head, row;
  std::getline(stream, head);
  std::getline(stream, row);
  const std::vector<std::string> names = cells(head), values = cells(row);
  EXPECT_EQ(names.size(), values.size()) << table;
  std::map<std::string, std::string> all;
  for (std::size_t i = 0; i < std::min(names.size(), values.size()); ++i) all[names[i]] = values[i];
  return all;
}

TEST(StudyFiles, AResponseHasGainPhaseAndPartsOfEachValue) {
  study::Response r;
  r.values = {{3 * pi, Complex(-3, 4)}};
  const auto row = first_row(response_csv(r));
  EXPECT_NEAR(std::stod(row.at("frequency[Hz]")), 1.5, 1e-14);
  EXPECT_NEAR(std::stod(row.at("gain[1]")), 5, 1e-14);
  EXPECT_NEAR(std::stod(row.at("phase[deg]")), std::atan2(4, -3) * 180 / pi, 1e-12);
  EXPECT_EQ(row.at("real[1]"), "-3");
  EXPECT_EQ(row.at("imaginary[1]"), "4");
}

// Whichever way it goes round, the phase takes the shorter one from value to value.
TEST(StudyFiles, PhasesGoOnOverHalfATurn) {
  const std::vector<double> given = {170, 200, 350, 370, 200, 50, -100, -190, -400};
  std::vector<ResponseAt> values;
  for (const double degrees : given) values.push_back({1, std::polar(2.0, degrees * pi / 180)});
  const std::vector<double> found = unwrapped_degrees(values);
  ASSERT_EQ(found.size(), given.size());
  for (std::size_t i = 1; i + 1 < given.size(); ++i) EXPECT_NEAR(found[i], given[i], 1e-9);
  EXPECT_NEAR(found.back(), -40, 1e-9) << "-400 is 210 from the value before, and -40 is 150";
}

// m = 2, c = 0.8, k = 50: ω = 5, ζ = 0.04.
TEST(StudyFiles, APoleHasTheFrequencyAndDampingOfItsModulus) {
  Registry registry;
  enroll_static_plugins(registry);
  const study::Prepared prepared = study::prepare(SceneValues::parse(R"(format: withy/1
bodies: {block: {type: rigid, mass: 2}}
hinges: {slide: {type: prismatic, axis: [1, 0, 0], parent: world, child: block}}
loads: {spring: {type: hinge-spring, hinge: slide, stiffness: 50, damping: 0.8}}
)",
                                                                     "block.yaml"),
                                                  registry);
  const study::Configuration configuration(prepared, prepared.scene.initial, {});
  const auto j = response_json(configuration, study::response(configuration, {"slide", "slide", {}, {}, 20, {}}));
  ASSERT_EQ(j.at("poles").size(), 2U);
  for (const auto& pole : j.at("poles")) {
    EXPECT_NEAR(pole.at("hertz").get<double>(), 5 / (2 * pi), 1e-12);
    EXPECT_NEAR(pole.at("damping_ratio").get<double>(), 0.04, 1e-12);
    EXPECT_NEAR(pole.at("value").at(0).get<double>(), -0.2, 1e-12);
  }
}

TEST(StudyFiles, AModeHasItsEigenvalueAndWhatFollowsFromIt) {
  Mode mode;
  mode.eigenvalue = {-3, 4};
  mode.partner = {-3, -4};
  mode.shape = Eigen::VectorXcd::Ones(1);
  study::ModesAt at;
  at.value = 7;
  at.modes = {mode};
  at.branches = {1};
  at.names = {"slide"};
  study::ModesOf run;
  run.formulation = "quadratic";
  run.points = {at};
  const auto row = first_row(modes_csv({run}, "spin[rad/s]"));
  EXPECT_EQ(row.at("spin[rad/s]"), "7");
  EXPECT_EQ(row.at("branch"), "2");
  EXPECT_EQ(row.at("dominated_by"), "slide");
  EXPECT_EQ(row.at("frequency[rad/s]"), "5");
  EXPECT_NEAR(std::stod(row.at("frequency[Hz]")), 5 / (2 * pi), 1e-15);
  EXPECT_EQ(row.at("squared_frequency[1/s^2]"), "25");
  EXPECT_EQ(row.at("damping_ratio"), "0.6");
  EXPECT_EQ(row.at("real[1/s]"), "-3");
  EXPECT_EQ(row.at("imaginary[rad/s]"), "4");
}

TEST(StudyFiles, EffectiveMassesAreSquaresOfParticipationsAtFrequenciesInHertz) {
  study::EffectiveMasses masses;
  masses.frequencies = Eigen::VectorXd::Constant(1, 6 * pi);
  masses.participation = Eigen::Vector3d(1, -2, 0.5);
  masses.total = 9;
  const auto mode = effective_mass_json(masses).at("modes").at(0);
  EXPECT_NEAR(mode.at("hertz").get<double>(), 3, 1e-14);
  EXPECT_EQ(mode.at("mass"), (std::vector<double>{1, 4, 0.25}));
  EXPECT_EQ(mode.at("participation"), (std::vector<double>{1, -2, 0.5}));
}

/// All numbers differ.
study::PointStore::Kept some_point() {
  study::PointStore::Kept kept;
  kept.result.point = {.formulation = "quadratic",
                       .family = "clamped-free",
                       .modes = 2,
                       .integrator = "dopri5",
                       .tolerance = 1e-5,
                       .over = {"a.b=1"}};
  kept.result.status = "completed";
  kept.result.hinge_error = 0.5;
  kept.result.tip_error = 0.25;
  kept.result.relative_error = 0.125;
  kept.result.cpu_seconds = 3;
  kept.result.steps = 4;
  kept.result.evaluations = 5;
  kept.result.sensors = {{"tip.x", 6}};
  kept.reference.point = kept.result.point;
  kept.reference.point.formulation = "exact";
  kept.reference.point.modes = 8;
  kept.reference.hinge_way = 9;
  kept.reference.tip_way = 10;
  kept.reference.hinge_error = 11;
  kept.reference.tip_error = 12;
  kept.reference.relative_error = 13;
  kept.reference.sensor_ways = {{"tip.x", 14}};
  kept.reference.sensor_errors = {{"tip.x", 15}};
  return kept;
}

TEST(StudyFiles, APointOfATradeHasTheErrorsOfHingesAndOfTips) {
  Registry registry;
  enroll_static_plugins(registry);
  const study::Prepared prepared = study::prepare(
      SceneValues::parse("format: withy/1\nbodies: {boom: {type: beam, length: 1, mass_per_length: 1, bending_y: "
                         "{stiffness: 1, modes: 1}}}\nhinges: {root: {type: revolute, axis: [0, 0, 1], parent: world, "
                         "child: boom}}\n",
                         "boom.yaml"),
      registry);
  const auto row = first_row(trade_csv({some_point().result}, {true}, study::Outputs(prepared.model())));
  EXPECT_EQ(row.at("formulation"), "quadratic");
  EXPECT_EQ(row.at("modes"), "2");
  EXPECT_EQ(row.at("family"), "clamped-free");
  EXPECT_EQ(row.at("integrator"), "dopri5");
  EXPECT_EQ(row.at("tolerance"), "1e-05");
  EXPECT_EQ(row.at("over"), "\"b=1\"");
  EXPECT_EQ(row.at("hinge_error"), "0.5");
  EXPECT_EQ(row.at("tip_error[m]"), "0.25");
  EXPECT_EQ(row.at("relative_error"), "0.125");
  EXPECT_EQ(row.at("steps"), "4");
  EXPECT_EQ(row.at("evaluations"), "5");
  EXPECT_EQ(row.at("cpu[s]"), "3");
  EXPECT_EQ(row.at("pareto"), "1");
}

TEST(StudyFiles, APointOfATradeThatWasKeptIsFoundAgainWhole) {
  const test::Scratch folder;
  TradeFolder store(folder / "trade", "fingerprint");
  const study::PointStore::Kept kept = some_point();
  store.keep(kept);
  const auto found = store.find(kept.result.point);
  ASSERT_TRUE(found);
  EXPECT_EQ(trade_result_json(found->result), trade_result_json(kept.result));
  EXPECT_EQ(trade_reference_json(found->reference), trade_reference_json(kept.reference));
  EXPECT_EQ(found->result.reference_error, 13);
}

// Logarithms have no place for zero: it stands a decade below all others, and the axis says so.
TEST(TradePicture, ErrorsOfZeroHaveAPlaceOfTheirOwn) {
  const auto drawn = [](const std::vector<double>& errors) {
    std::vector<study::TradeResult> results;
    for (const double error : errors) {
      study::TradeResult& r = results.emplace_back();
      r.status = "completed";
      r.relative_error = error;
      r.cpu_seconds = 1e-3 * static_cast<double>(results.size());
    }
    return trade_picture("trade", results, std::vector<bool>(errors.size(), true));
  };
  EXPECT_THAT(drawn({1e-2, 4e-5}), testing::Not(testing::HasSubstr("error [%], 0 at")));
  EXPECT_THAT(drawn({1e-2, 4e-5, 0}), testing::HasSubstr("error [%], 0 at 0.0004"));
  EXPECT_THAT(drawn({0, 0}), testing::HasSubstr("error [%], 0 at 1e-12"));
}

TEST(StudyFiles, StepsThatAnIntegratorChoosesAreNotSaidToBeGiven) {
  study::StepLimit steps;
  steps.mean = 0.01;
  steps.product = 0.16;
  steps.controlled = false;
  EXPECT_EQ(step_limit_text(steps), "as the scene gives them: mean step times fastest mode 0.16");
  steps.chosen = true;
  EXPECT_EQ(step_limit_text(steps), "chosen by the integrator: mean step times fastest mode 0.16");
}

}  // namespace
}  // namespace withy
