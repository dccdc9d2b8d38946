#include "withy/scene/units.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace withy {
namespace {

constexpr double pi = std::numbers::pi;

struct Good {
  const char* text;
  const char* si_unit;
  double value;
};

// Definitions: SI brochure (9th edition); inch 25.4 mm, pound 0.45359237 kg, standard gravity 9.80665 m/s².
const Good quantities[] = {
    {"25 mm", "m", 0.025},
    {"25mm", "m", 0.025},
    {"0.1 cm", "m", 0.001},
    {"1 in", "m", 0.0254},
    {"1 ft", "m", 0.3048},
    {"3 km", "m", 3000},
    {"90 deg", "rad", pi / 2},
    {"60 °", "rad", pi / 3},
    {"-0.5 rad", "rad", -0.5},
    {"+1e-3 rad", "rad", 1e-3},
    {"1 rev", "rad", 2 * pi},
    {"5 g", "kg", 0.005},
    {"5 kg", "kg", 5},
    {"5\u00a0kg", "kg", 5},
    {"5\u202fkg", "kg", 5},
    {"2 t", "kg", 2000},
    {"1 lb", "kg", 0.45359237},
    {"2 kg/m", "kg/m", 2},
    {"2 g/mm", "kg/m", 2},
    {"3 N m^2", "N m^2", 3},
    {"3 N*m^2", "N m^2", 3},
    {"3 N·m²", "N m^2", 3},
    {"3 Nm m", "N m^2", 3},
    {"3 kN mm", "N m", 3},
    {"1 lbf", "N", 0.45359237 * 9.80665},
    {"1 kg m/s^2", "N", 1},
    {"1.5 GPa", "Pa", 1.5e9},
    {"2 N/mm^2", "Pa", 2e6},
    {"1 kg/(m s^2)", "Pa", 1},
    {"1 kg/m/s^2", "Pa", 1},
    {"7 rpm", "rad/s", 7 * pi / 30},
    {"360 deg/s", "rad/s", 2 * pi},
    {"2 kHz", "Hz", 2000},
    {"2 1/s", "Hz", 2},
    {"2 s^-1", "Hz", 2},
    {"2 min", "s", 120},
    {"1 h", "s", 3600},
    {"5 ms", "s", 0.005},
    {"4 µm", "m", 4e-6},
    {"1 percent", "1", 0.01},
    {"1 %", "1", 0.01},
    {"4 g cm^2", "kg m^2", 4e-7},
    {"2 J", "N m", 2},
};

TEST(Quantities, BecomeSiNumbers) {
  for (const Good& q : quantities) {
    const QuantityReading reading = read_quantity(q.text, q.si_unit);
    ASSERT_TRUE(reading.value) << q.text << ": " << reading.problem;
    // A few roundings: one for each factor of the unit.
    EXPECT_NEAR(*reading.value, q.value, 4e-16 * std::abs(q.value)) << q.text;
  }
}

TEST(Quantities, OfDecimalPrefixesAreTheNumbersOneWouldWrite) {
  EXPECT_EQ(*read_quantity("25 mm", "m").value, 0.025);
  EXPECT_EQ(*read_quantity("914.4 mm", "m").value, 0.9144);
  EXPECT_EQ(*read_quantity("3 g", "kg").value, 0.003);
}

/// As a signal has that an expression gives in degrees.
TEST(Quantities, AreNumbersInTheUnitThatIsAskedFor) {
  EXPECT_EQ(*read_quantity("30 deg", "deg").value, 30);
  EXPECT_NEAR(*read_quantity("1 rad", "deg").value, 180 / pi, 1e-13);
  EXPECT_NEAR(*read_quantity("10 rpm", "rpm").value, 10, 1e-14);
  EXPECT_NEAR(*read_quantity("3 N m/deg", "N m/(deg)").value, 3, 1e-14);
  EXPECT_EQ(*read_quantity("2 cm", "mm").value, 20);
}

TEST(Quantities, SayWhatIsWrongWithThem) {
  using testing::HasSubstr;
  const auto problem = [](const char* text, const char* unit) {
    const QuantityReading reading = read_quantity(text, unit);
    EXPECT_FALSE(reading.value) << text;
    return reading.problem;
  };
  EXPECT_THAT(problem("3 mn", "m"), HasSubstr("unknown unit 'mn'; did you mean"));
  EXPECT_THAT(problem("3 Gpa", "Pa"), HasSubstr("did you mean 'GPa'?"));
  EXPECT_THAT(problem("3 degrees", "rad"), HasSubstr("unknown unit 'degrees'"));
  EXPECT_THAT(problem("3 kg", "m"), HasSubstr("wrong unit"));
  EXPECT_THAT(problem("3 Hz", "rad/s"), HasSubstr("wrong unit"));  // a factor 2π apart
  EXPECT_THAT(problem("3 deg", "1"), HasSubstr("wrong unit"));
  EXPECT_THAT(problem("3 N m", "N m^2"), HasSubstr("wrong unit"));
  EXPECT_THAT(problem("3 kg/m s", "kg/m/s"), HasSubstr("two ways"));
  EXPECT_THAT(problem("3 m^", "m"), HasSubstr("powers"));
  EXPECT_THAT(problem("3 m^0", "1"), HasSubstr("powers"));
  EXPECT_THAT(problem("3 m^99", "m"), HasSubstr("powers"));
  EXPECT_THAT(problem("3 m/", "m"), HasSubstr("unit is missing"));
  EXPECT_THAT(problem("3 (m", "m"), HasSubstr("')' is missing"));
  EXPECT_THAT(problem("3 m)", "m"), HasSubstr("out of place"));
  EXPECT_THAT(problem("3 ((((((((m))))))))", "m"), HasSubstr("too many parentheses"));
  EXPECT_THAT(problem("3", "m"), HasSubstr("quotes"));
  EXPECT_THAT(problem("03 m", "m"), HasSubstr("leading zeros"));
  EXPECT_THAT(problem("1e999 m", "m"), HasSubstr("range of doubles"));
  EXPECT_THAT(problem("3 m", "furlong"), HasSubstr("write a number in furlong"));
}

TEST(PlainNumbers, AreDecimalAlone) {
  EXPECT_EQ(plain_number("1e3"), 1000);
  EXPECT_EQ(plain_number(".5"), 0.5);
  EXPECT_EQ(plain_number("5."), 5);
  EXPECT_EQ(plain_number("+1"), 1);
  EXPECT_EQ(plain_number("-0.25E-2"), -0.0025);
  EXPECT_EQ(plain_number("0"), 0);
  EXPECT_EQ(plain_number("4.9406564584124654e-324"), 4.9406564584124654e-324);
  EXPECT_TRUE(std::signbit(*plain_number("-0")));
  for (const char* text : {"",    "010", "-010", "1:30", "0x1f", "0o17",  "1_000", "1e", "e3",  "--1",
                           "+-1", ".",   "+",    "inf",  "nan",  "1e400", "1 ",    " 1", "1,5", "1d3"}) {
    EXPECT_FALSE(plain_number(text)) << text;
  }
}

}  // namespace
}  // namespace withy
