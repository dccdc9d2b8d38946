/// \file
/// What a report keeps of runs that are longer than a page: peaks of what is computed of rows, and whole turns.
#include "withy/results/report/report_table.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "withy/plugins/host/static_plugins.hpp"
#include "withy/results/result_columns.hpp"

namespace withy {
namespace {

constexpr double in_degrees = 180 / std::numbers::pi;
constexpr std::size_t long_table = 10'000;  ///< rows

const std::vector<Column> of_attitude = {
    {"t", "s"}, {"eye.qw", "1"}, {"eye.qx", "1"}, {"eye.qy", "1"}, {"eye.qz", "1"}};

/// A turn about z at 24 rad/s, whose quaternion has now one sign and now the other, and a length of its own.
std::vector<double> turned_row(double t, double sign) {
  const double half = 12 * t;
  return {t, 1.5 * sign * std::cos(half), 0, 0, 1.5 * sign * std::sin(half)};
}

TEST(DerivedColumns, AttitudesAreFollowedFromRowToRowOverWholeTurns) {
  const Model nothing({}, {}, Vector3::Zero());
  DerivedColumns derived(of_attitude, nothing, nullptr);
  ASSERT_EQ(derived.columns().size(), 3U);
  EXPECT_EQ(derived.columns()[2].name, "eye.z");
  EXPECT_EQ(derived.columns()[2].unit, "deg");
  EXPECT_EQ(derived.shown(), 3U);
  for (std::size_t i = 0; i < long_table; ++i) {
    const double t = 0.01 * static_cast<double>(i);
    std::vector<double> row = turned_row(t, i % 7 < 3 ? -1 : 1), angles;
    const bool lost = i == 4000;  // a row without numbers is told as that, and those behind it go on
    if (lost) row[1] = std::numeric_limits<double>::quiet_NaN();
    derived.append(row, angles);
    ASSERT_EQ(angles.size(), 3U);
    if (lost) {
      EXPECT_TRUE(std::isnan(angles[2]));
      continue;
    }
    // The rounding of the sine of up to 1200 rad.
    EXPECT_NEAR(angles[2], 24 * t * in_degrees, 1e-9) << t;
    EXPECT_EQ(angles[1], 0);
  }
}

// R = Rx(0.4) Ry(-0.7) Rz(1.1).
TEST(DerivedColumns, AttitudesAreTurnsAboutXThenYThenZ) {
  const Eigen::Quaterniond q(Eigen::AngleAxisd(0.4, Vector3::UnitX()) * Eigen::AngleAxisd(-0.7, Vector3::UnitY()) *
                             Eigen::AngleAxisd(1.1, Vector3::UnitZ()));
  const Model nothing({}, {}, Vector3::Zero());
  DerivedColumns derived(of_attitude, nothing, nullptr);
  std::vector<double> angles;
  derived.append(std::vector{0.0, q.w(), q.x(), q.y(), q.z()}, angles);
  ASSERT_EQ(angles.size(), 3U);
  EXPECT_NEAR(angles[0], 0.4 * in_degrees, 1e-12);
  EXPECT_NEAR(angles[1], -0.7 * in_degrees, 1e-12);
  EXPECT_NEAR(angles[2], 1.1 * in_degrees, 1e-12);
}

// Energy is lost that neither moves nor is stored nor was put in.
TEST(DerivedColumns, DriftIsTheEnergySinceTheStartLessTheWork) {
  const Model nothing({}, {}, Vector3::Zero());
  DerivedColumns derived({{"t", "s"}, {"kinetic_energy", "J"}, {"potential_energy", "J"}, {"work", "J"}}, nothing,
                         nullptr);
  std::vector<double> drift;
  derived.append(std::vector{0.0, 1.0, 2.0, 0.5}, drift);
  derived.append(std::vector{1.0, 4.0, 8.0, 5.5}, drift);
  EXPECT_EQ(drift, (std::vector{0.0, 4.0}));
}

/// A beam on a hinge in a formulation whose limits are of rates and deflections.
study::Prepared swinging_beam(Registry& registry) {
  enroll_static_plugins(registry);
  return study::prepare(
      SceneValues::parse("format: withy/1\nformulation: ruthless\ntime: {end: 1}\nbodies:\n"
                         "  beam: {type: beam, length: 2, mass_per_length: 1, "
                         "bending_y: {stiffness: 9, modes: 1, family: clamped-free}}\n"
                         "hinges:\n  pin: {type: revolute, axis: [0, 0, 1], parent: world, child: beam}\n",
                         "beam.yaml"),
      registry);
}

/// Peaks of one row each, far from the rows that are kept whole.
TEST(ReportTable, RatesDeflectionsAndDriftLoseNoPeakHoweverLongTheRun) {
  Registry registry;
  const study::Prepared prepared = swinging_beam(registry);
  ResultColumns columns(prepared.model(), *prepared.equations);
  ReportTable table(prepared, 200, 50, 0);
  table.begin(columns.columns());
  table.begin(columns.columns());  // as of a run that goes on
  const Layout& layout = prepared.model().layout();
  const std::size_t pin = layout.hinge("pin")->position, rate = layout.positions + layout.hinge("pin")->speed;
  const std::size_t mode = layout.bodies[0].position;
  double deflection = 0, drift = 0, first = 0;
  for (std::size_t i = 0; i < long_table; ++i) {
    State state = prepared.scene.initial;
    state.time = 0.01 * static_cast<double>(i);
    state.y[pin] = 0.1;
    if (i == 777) state.y[rate] = -3;
    if (i == 4321) state.y[mode] = 0.2;
    const std::vector<double>& row = columns.row(state);
    const auto at = [&](const std::string& name) {
      const auto& all = columns.columns();
      const auto found = std::find_if(all.begin(), all.end(), [&](const Column& c) { return c.name == name; });
      return row[static_cast<std::size_t>(found - all.begin())];
    };
    deflection = std::max(
        deflection, std::hypot(at("beam.tip.deflection_x"), at("beam.tip.deflection_y"), at("beam.tip.deflection_z")));
    const double energy = at("kinetic_energy") + at("potential_energy") - at("work");
    if (i == 0) first = energy;
    drift = std::max(drift, energy - first);
    table.row(row);
  }
  EXPECT_GT(table.kept().stride(), 40U);
  const auto greatest = [&](std::size_t derived) {
    const std::vector<double> kept = table.kept().column(table.recorded().size() + derived);
    return *std::max_element(kept.begin(), kept.end());
  };
  const DerivedColumns& derived = table.derived();
  ASSERT_EQ(derived.shown(), 1U);
  EXPECT_GT(drift, 0);
  EXPECT_EQ(greatest(0), drift);
  ASSERT_EQ(derived.rates().size(), 1U);
  EXPECT_EQ(derived.rates()[0].body, "beam");
  EXPECT_NEAR(greatest(derived.rates()[0].column), 3, 1e-14);
  ASSERT_EQ(derived.deflections().size(), 1U);
  EXPECT_GT(deflection, 0.1);
  EXPECT_NEAR(greatest(derived.deflections()[0].column), deflection / 2, 1e-15);
  EXPECT_EQ(table.kept().columns().size(), table.recorded().size() + derived.columns().size());
  // A picture of what was recorded has the same rows.
  const DecimatedTable recorded(table.kept(), table.recorded().size());
  EXPECT_EQ(recorded.columns().size(), table.recorded().size());
  EXPECT_EQ(recorded.column(1), table.kept().column(1));
}

/// A pass over the tree for every row is made where a limit asks for it alone.
TEST(ReportTable, RatesAreMeasuredWhereTheFormulationHasALimitOfThem) {
  Registry registry;
  enroll_static_plugins(registry);
  for (const auto& [formulation, rates] : {std::pair("ruthless", 1U), std::pair("linear", 1U),
                                           std::pair("quadratic", 0U), std::pair("exact", 0U), std::pair("auto", 1U)}) {
    const study::Prepared prepared = study::prepare(
        SceneValues::parse(std::string("format: withy/1\nformulation: ") + formulation +
                               "\ntime: {end: 1}\nbodies:\n  beam: {type: beam, length: 2, mass_per_length: 1, "
                               "bending_y: {stiffness: 9, modes: 1}}\n"
                               "hinges:\n  pin: {type: revolute, axis: [0, 0, 1], parent: world, child: beam}\n",
                           "beam.yaml"),
        registry);
    ReportTable table(prepared, 200, 50, 0);
    table.begin({{"t", "s"}});
    EXPECT_EQ(table.derived().rates().size(), rates) << formulation;
  }
}

}  // namespace
}  // namespace withy
