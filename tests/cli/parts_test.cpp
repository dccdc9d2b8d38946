#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <sstream>

#include "withy/program/allocations.hpp"
#include "withy/program/colour.hpp"
#include "withy/program/fold.hpp"
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

TEST(Fold, LinesOfWordsGoOnBelowWhereTheirWordsBeginAndNothingElseChanges) {
  EXPECT_EQ(folded("error         about one per cent of it\n", 30),
            "error         about one per\n              cent of it\n");
  EXPECT_EQ(folded("Reference: exact, three modes, of them one\nmore", 24),
            "Reference: exact, three\n  modes, of them one\nmore");
  EXPECT_EQ(folded("  a.yaml:3:7: /bodies: got µµµµµµ; need one", 26),
            "  a.yaml:3:7: /bodies: got\n    µµµµµµ; need one");
  EXPECT_EQ(folded("no", 40), "no");
  EXPECT_EQ(folded("", 40), "");
  // Tables, commands and words without a space.
  for (const std::string whole :
       {"name              error of everything\n----------------------\na   b c d e f g h i j k\n",
        "  withy run scenes/pendulum.yaml --set time.end=4\n", "results/two-link-slew-quadratic/report.html\n\n\n"})
    EXPECT_EQ(folded(whole, 16), whole);
  // Whatever the width, the words are the same.
  const std::string text =
      "why   one: two three four, five\n      six: seven eight\n\nnine ten eleven twelve thirteen\n";
  for (std::size_t width = 12; width < 60; ++width) {
    std::istringstream before(text), after(folded(text, width));
    for (std::string a, b; before >> a;) EXPECT_TRUE(after >> b && a == b) << width;
  }
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

/// Values between marks are read by them: one mark alone says nothing.
TEST(SvgPlot, AnAxisInDecadesHasThreeMarksHoweverShortItIs) {
  for (double low = 1e-6; low < 1e6; low *= 1.37) {
    for (const double ratio : {1.001, 1.1, 1.5, 2.0, 2.3, 4.9, 9.7, 20.0, 999.0, 1e6}) {
      const auto marks = decade_marks(low, ratio * low);
      EXPECT_GE(marks.size(), 3U) << low << " to " << ratio * low;
      for (const double m : marks) EXPECT_TRUE(m >= low && m <= ratio * low) << m;
    }
  }
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

TEST(SvgPlot, TextsOfMarksTellThemApart) {
  using testing::ElementsAre;
  EXPECT_THAT(mark_texts({0, 0.5, 1}), ElementsAre("0", "0.5", "1"));
  EXPECT_THAT(mark_texts({1e6, 1.1e6, 1.2e6}), ElementsAre("1e+06", "1.1e+06", "1.2e+06"));
  EXPECT_THAT(mark_texts({7e6, 7e6 + 0.25, 7e6 + 0.5}), ElementsAre("7000000", "7000000.25", "7000000.5"));
  EXPECT_THAT(mark_texts(decade_marks(1e-9, 1e9)), testing::Contains("1e-09"));
  EXPECT_THAT(mark_texts({0, 28.07123}, 4), ElementsAre("0", "28.07"));
  const Panel panel{"x", "y", {7e6, 7e6 + 1}, {Curve{{0, 1}, {7e6, 7e6 + 1}}}};
  EXPECT_THAT(svg_plot("t", {"c"}, {panel}), testing::HasSubstr(">7000000.5<"));
}

/// As that of a momentum that is conserved: to draw it once took for ever.
TEST(SvgPlot, ARangeOfRoundingHasAnAxis) {
  const double after = std::nextafter(1.0, 2.0);
  EXPECT_LE(axis_marks(1, after).size(), 8U);
  const Panel panel{"x", "y", {1, after}, {Curve{{0, 1}, {1, after}}}};
  EXPECT_THAT(svg_plot("t", {"c"}, {panel}), testing::HasSubstr(">1.05<"));
}

/// Panels below each other have one axis of time, wherever their curves begin.
TEST(SvgPlot, AnAxisOfXBeginsWhereItsRangeDoes) {
  Panel panel{"x", "y", {0, 1}, {Curve{{1001, 1010}, {0, 1}}}};
  panel.x_range = {1000, 1010};
  const std::string svg = svg_plot("t", {"c"}, {panel});
  EXPECT_THAT(svg, testing::HasSubstr(">1000<"));
  EXPECT_THAT(svg, testing::Not(testing::HasSubstr(">500<")));
}

TEST(SvgPlot, APanelWithoutCurvesSaysSo) {
  Panel panel{"x", "y", {1e-306, 1e-300}, {}};
  panel.log_y = true;
  const std::string svg = svg_plot("t", {}, {panel});
  EXPECT_THAT(svg, testing::HasSubstr(">zero throughout, but for rounding<"));
  EXPECT_THAT(svg, testing::Not(testing::HasSubstr("e-30")));
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

/// Every line of a text, for the length of each.
std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(TextTable, WhatDoesNotFitStandsBelowBehindWhatNamesTheRows) {
  std::vector<std::string> head = {"<name"}, first = {"a"}, second = {"b"};
  for (int c = 0; c < 12; ++c) {
    head.push_back("column " + std::to_string(c));
    first.push_back(std::to_string(c));
    second.push_back(std::to_string(100 * c));
  }
  TextTable table(head);
  table.add(first);
  table.add(second);
  const std::vector<std::string> lines = lines_of(table.str());
  ASSERT_EQ(lines.size(), 9U);
  for (const std::string& line : lines) EXPECT_LE(line.size(), 100U) << line;
  EXPECT_EQ(lines[4], "");
  EXPECT_TRUE(lines[5].starts_with("name  column 9") || lines[5].starts_with("name  column 8")) << lines[5];
  for (int c = 0; c < 12; ++c)
    EXPECT_EQ(1, std::count_if(lines.begin(), lines.end(), [&](const std::string& line) {
                return (line + " ").find("column " + std::to_string(c) + " ") != std::string::npos;
              }));
  EXPECT_TRUE(lines[7].starts_with("a ")) << lines[7];
  EXPECT_TRUE(lines[8].ends_with(" 1100")) << lines[8];
}

TEST(TextTable, WordsOfTheLastColumnGoOnBelowEachOther) {
  TextTable table({"<kind", "<id", "<what it is"});
  std::string words;
  for (int i = 0; i < 40; ++i) words += (i > 0 ? " " : "") + std::string("word");
  table.add({"body", "beam", words});
  table.add({"body", "rigid", "short"});
  const std::vector<std::string> lines = lines_of(table.str());
  std::string together;
  for (std::size_t i = 2; i + 1 < lines.size(); ++i) together += (i > 2 ? " " : "") + lines[i].substr(13);
  EXPECT_EQ(together, words);
  for (const std::string& line : lines) EXPECT_LE(line.size(), 100U) << line;
  EXPECT_EQ(lines.back(), "body  rigid  short");
}

}  // namespace
}  // namespace withy::program
