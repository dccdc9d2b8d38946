// Ranges and lists of values as command lines give them.
#include "withy/study/variation_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

/// As `--set` takes a number and its unit.
TEST(VariationText, EndsOfARangeHaveTheirUnitsWithABlankOrWithout) {
  for (const char* text : {"bodies.rod.mass=1kg:2kg:3", "bodies.rod.mass=1 kg:2 kg:3", "bodies.rod.mass=1kg:2:3"}) {
    const Sweep sweep = parse_sweep(text, "sweep");
    EXPECT_EQ(sweep.path, "bodies.rod.mass") << text;
    EXPECT_EQ(sweep.values, (std::vector<double>{1, 1.5, 2})) << text;
    EXPECT_EQ(sweep.unit, "kg") << text;
  }
  const Sweep powers = parse_sweep("loads.a.amplitude=-1e-3 N m:1e-3N m:2", "sweep");
  EXPECT_EQ(powers.values, (std::vector<double>{-1e-3, 1e-3}));
  EXPECT_EQ(powers.unit, "N m");
  EXPECT_EQ(parse_sweep("spin.axle=0:12:4", "sweep").values, (std::vector<double>{0, 4, 8, 12}));
}

TEST(VariationText, StepsOfARangeLeaveNoRoundingInItsValues) {
  const Sweep sweep = parse_sweep("spin.shaft=0:300 rpm:16", "sweep");
  for (std::size_t k = 0; k < 16; ++k) EXPECT_EQ(sweep.values[k], 20.0 * static_cast<double>(k));
  EXPECT_EQ(sweep.shown_unit(), "rpm");
  EXPECT_EQ(parse_sweep("spin.shaft=0:3:2", "sweep").shown_unit(), "rad/s");
  EXPECT_EQ(parse_sweep("bodies.rod.mass=0.1:0.3:3", "sweep").shown_unit(), "");
}

TEST(VariationText, RangesThatAreNoneAreBadInput) {
  for (const char* text : {"a=1kg:2g:3", "a=kg:2kg:3", "a=010:2:3", "a=1.2.3:2:3", "a=1:2", "a=1:2:1", "=1:2:3", "a"})
    EXPECT_THROW(static_cast<void>(parse_sweep(text, "sweep")), InputError) << text;
}

}  // namespace
}  // namespace withy::study
