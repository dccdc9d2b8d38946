#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <memory>
#include <sstream>

#include "withy/program/allocations.hpp"
#include "withy/program/colour.hpp"
#include "withy/results/svg_plot.hpp"
#include "withy/results/text_table.hpp"

namespace withy::program {
namespace {

TEST(Allocations, OfOperatorNewMallocAndEigenAreCounted) {
  const std::size_t before = allocations();
  const auto one = std::make_unique<double>(1.0);
  EXPECT_EQ(allocations(), before + 1);
  Eigen::VectorXd two;
  two.resize(7);
  EXPECT_EQ(allocations(), before + 2);
  struct alignas(64) Wide {
    double x[8];
  };
  const auto three = std::make_unique<Wide>();
  EXPECT_EQ(allocations(), before + 3);
  two.setConstant(*one);
  EXPECT_EQ(allocations(), before + 3) << "arithmetic allocates nothing";
}

TEST(Colour, OutcomesAndPlacesAreMarkedAndNothingElseChanges) {
  EXPECT_EQ(with_outcomes_coloured("outcome   completed\nuncompleted, completed.\nquadratic diverged at"),
            "outcome   \033[32mcompleted\033[0m\nuncompleted, completed.\nquadratic \033[31mdiverged\033[0m at");
  EXPECT_EQ(with_places_bold("arm.yaml:3:7: /bodies: got 1: no\nt = 3: word 4:5: x\ntable.csv:12: bad\n"),
            "\033[1marm.yaml:3:7:\033[0m /bodies: got 1: no\nt = 3: word 4:5: x\n\033[1mtable.csv:12:\033[0m bad\n");
  const std::string text = "t[s],x\n\n 1:2:\n";
  EXPECT_EQ(with_outcomes_coloured(text), text);
  EXPECT_EQ(with_places_bold(text), text);
}

TEST(SvgPlot, AxisMarksAreRoundAndInside) {
  EXPECT_THAT(axis_marks(0, 4), testing::ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(axis_marks(-0.021, 0.021), testing::ElementsAre(-0.02, -0.01, 0, 0.01, 0.02));
  for (const double scale : {1e-9, 0.37, 1.0, 6.02e23}) {
    const auto marks = axis_marks(-scale, 1.7 * scale);
    EXPECT_GE(marks.size(), 3U);
    EXPECT_LE(marks.size(), 8U);
    for (const double m : marks) {
      EXPECT_GE(m, -scale);
      EXPECT_LE(m, 1.7 * scale);
    }
  }
}

TEST(SvgPlot, MarksInDecadesArePowersOfTenAndPartsWhereTheseAreFew) {
  EXPECT_THAT(decade_marks(0.03, 4e3), testing::ElementsAre(0.1, 1, 10, 100, 1000));
  EXPECT_THAT(decade_marks(0.9, 30), testing::ElementsAre(1, 2, 5, 10, 20));
}

TEST(SvgPlot, DecadesAreEquallyLong) {
  Panel panel{"x", "y", {1, 100}, {Curve{{1, 10, 100}, {1, 10, 100}, false, false, {}}}};
  panel.log_x = panel.log_y = true;
  const std::string svg = svg_plot("t", {"c"}, {panel});
  const std::size_t at = svg.find("points=\"") + 8;
  std::istringstream points(svg.substr(at, svg.find('"', at) - at));
  double x[3] = {}, y[3] = {};
  char comma = 0;
  for (int i = 0; i < 3; ++i) points >> x[i] >> comma >> y[i];
  EXPECT_GT(x[1] - x[0], 100);
  EXPECT_NEAR(x[1] - x[0], x[2] - x[1], 0.02);
  EXPECT_NEAR(y[1] - y[0], y[2] - y[1], 0.02);
}

TEST(SvgPlot, TextIsEscaped) {
  const std::string svg = svg_plot("a < b & c", {"x>y"}, {});
  EXPECT_THAT(svg, testing::HasSubstr("a &lt; b &amp; c"));
  EXPECT_THAT(svg, testing::HasSubstr("x&gt;y"));
}

TEST(TextTable, ColumnsAreAsWideAsTheirWidestCellInCharacters) {
  TextTable table({"<name", "x"});
  table.add({"é", "1"});
  table.add({"long name", "-22"});
  EXPECT_EQ(table.str(),
            "name         x\n"
            "--------------\n"
            "é            1\n"
            "long name  -22\n");
}

TEST(TextTable, AHeadOfTwoLinesStandsOnTwoLines) {
  TextTable table({"<name", "length\n[m]"});
  table.add({"a", "1"});
  EXPECT_EQ(table.str(),
            "      length\n"
            "name     [m]\n"
            "------------\n"
            "a          1\n");
}

}  // namespace
}  // namespace withy::program
