// What `withy plot` draws of several runs: whose curve is whose, in which unit, and what is left out.
#include <gmock/gmock.h>

#include <filesystem>
#include <limits>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "withy/results/output_file.hpp"
#include "withy/results/plotted_runs.hpp"
#include "withy/results/results_error.hpp"
#include "withy/results/svg_parts.hpp"
#include "withy/results/svg_plot.hpp"
#include "withy/results/table_picture.hpp"
#include "withy/results/terminal_plot.hpp"
#include "withy/study/input_error.hpp"
#include "withy/tests/results/scratch.hpp"

namespace withy {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// One hinge slides in one run and turns in the other: 1.7 m are no 97 degrees, and 2.7 rad no metres.
TEST(PlottedRuns, ColumnsOfOneNameInTwoUnitsHaveAPanelEach) {
  DecimatedTable slides(100, 0), turns(100, 0);
  slides.begin({{"t", "s"}, {"s", "m"}, {"share", "1"}});
  turns.begin({{"t", "s"}, {"s", "rad"}, {"share", ""}});
  for (int i = 0; i <= 10; ++i) {
    slides.row(std::vector<double>{0.2 * i, 0.1 + 0.16 * i, 0.1 * i});
    turns.row(std::vector<double>{0.2 * i, 0.1 + 0.26 * i, 0.05 * i});
  }
  for (const bool turned : {false, true}) {
    const NamedTable a{"a", turned ? &turns : &slides}, b{"b", turned ? &slides : &turns};
    const std::vector<Panel> panels = table_panels({a, b}, {"s"});
    ASSERT_EQ(panels.size(), 2U);
    const std::size_t metres = turned ? 1 : 0, degrees = 1 - metres;
    EXPECT_EQ(panels[metres].y_label, "s [m]");
    EXPECT_EQ(panels[degrees].y_label, "s [deg]");
    for (const std::size_t panel : {metres, degrees}) {
      const std::size_t own = panel == metres ? metres : degrees;
      EXPECT_THAT(panels[panel].curves[1 - own].x, IsEmpty()) << "the other run has no such number";
      EXPECT_NEAR(panels[panel].curves[own].y.back(), panel == metres ? 1.7 : 154.69860468535, 1e-9);
      EXPECT_NEAR(panels[panel].y_range.second, panel == metres ? 1.7 : 154.69860468535, 1e-9);
    }
    EXPECT_EQ(table_panels({a, b}, {"share"}).size(), 1U) << "a ratio without a unit is one of unit 1";
    EXPECT_THROW(envelope_panel({a, b}, {"s"}, {0}), ResultsError);
  }
}

TEST(PlottedRuns, AComponentThatIsRoundingIsDrawnAsNothingBesideTheOthers) {
  DecimatedTable table(100, 0);
  table.begin({{"t", "s"}, {"tip.x", "m"}, {"tip.y", "m"}, {"root.y", "m"}});
  for (int i = 0; i <= 10; ++i) table.row(std::vector<double>{0.2 * i, 0.3 * i, 1e-17 * i, 2e-17 * i});
  const std::vector<Panel> panels = table_panels({{"a", &table}}, {"tip.x", "tip.y", "root.y"});
  ASSERT_EQ(panels.size(), 3U);
  EXPECT_EQ(panels[0].y_range, (std::pair<double, double>(0, 3)));
  EXPECT_EQ(panels[1].y_range, (std::pair<double, double>(-3, 3)));
  EXPECT_NEAR(panels[2].y_range.second, 2e-16, 1e-30) << "of another vector";
}

TEST(PlottedRuns, AreNamedByTheShortestPathsThatDiffer) {
  EXPECT_THAT(run_names({"cmp/time_scale=1.0/quadratic/results.csv", "cmp/time_scale=1.2/quadratic/results.csv",
                         "cmp/time_scale=1.2/exact/results.csv"}),
              ElementsAre("time_scale=1.0/quadratic", "time_scale=1.2/quadratic", "exact"));
  EXPECT_THAT(run_names({"one/with/quadratic/results.csv", "two/with/quadratic/results.csv"}),
              ElementsAre("one/with/quadratic", "two/with/quadratic"));
  EXPECT_THAT(run_names({"a/./quadratic/results.csv"}), ElementsAre("quadratic"));
  EXPECT_THAT(run_names({"a/results.csv", "a/results.h5", "a/old.csv"}),
              ElementsAre("results.csv", "results.h5", "old.csv"));
  EXPECT_THAT(run_names({"a/results.csv", "a/results.csv"}), ElementsAre("a", "a")) << "nothing tells them apart";
}

TEST(PlottedRuns, ARunWithoutTheColumnsIsNotInTheLegendAndSaidToBeLeftOut) {
  const test::Scratch folder;
  folder.write("slides/results.csv", "t[s],s[m]\n0,1\n1,2\n");
  folder.write("turns/results.csv", "t[s],r[rad]\n0,1\n1,2\n");
  const std::string slides = (folder / "slides").string(), turns = (folder / "turns").string();
  const DrawnRuns drawn = PlottedRuns({turns, slides, "s"}).drawn({});
  EXPECT_THAT(drawn.picture.legend, ElementsAre("slides"));
  EXPECT_THAT(drawn.left_out, ElementsAre("turns"));
  ASSERT_EQ(drawn.picture.panels.size(), 1U);
  EXPECT_THAT(drawn.picture.panels[0].curves, testing::SizeIs(1));
  EXPECT_EQ(drawn.count(), "1 column");
  EXPECT_EQ(drawn.remarks(), "turns has no number in these columns and is not drawn\n");
  const DrawnRuns both = PlottedRuns({turns, slides, "s", "r"}).drawn({});
  EXPECT_THAT(both.picture.legend, ElementsAre("turns", "slides"));
  EXPECT_THAT(both.left_out, IsEmpty());
  const DrawnRuns over = PlottedRuns({turns, slides, "s"}).drawn({0.5});
  EXPECT_THAT(over.picture.legend, ElementsAre("slides"));
  EXPECT_THAT(over.picture.panels.at(0).curves, testing::SizeIs(2)) << "least and greatest of one run";
}

TEST(PlottedRuns, WithoutNamesSayHowManyOfTheColumnsAreDrawn) {
  const test::Scratch folder;
  std::string head = "t[s]", first = "0", second = "1";
  for (int i = 0; i < 12; ++i) {
    head += ",h" + std::to_string(i) + "[rad]";
    first += ",0";
    second += ",1";
  }
  folder.write("chain/results.csv", head + ",still[rad]\n" + first + ",1\n" + second + ",1\n");
  const PlottedRuns runs({(folder / "chain").string()});
  const DrawnRuns drawn = runs.drawn({});
  EXPECT_EQ(drawn.picture.panels.size(), 8U);
  EXPECT_EQ(drawn.columns, 8U);
  EXPECT_EQ(drawn.telling, 12U) << "what stays as it is counts for none";
  EXPECT_EQ(drawn.count(), "8 of 12 columns");
  EXPECT_EQ(drawn.remarks(), "4 more change: name those to draw\n");
  const DrawnRuns named = PlottedRuns({(folder / "chain").string(), "h0", "h1"}).drawn({});
  EXPECT_EQ(named.count(), "2 columns");
  EXPECT_EQ(named.remarks(), "");
}

TEST(PlottedRuns, ReplaceAPictureOfTheirOwnAndNoOtherThatNobodyNamed) {
  const test::Scratch folder;
  folder.write("run/results.csv", "t[s],s[m]\n0,1\n1,2\n");
  const PlottedRuns runs({(folder / "run").string()});
  const std::filesystem::path own = folder / "run/plot.svg";
  EXPECT_EQ(runs.picture("", false), own);
  draw_plot(runs.drawn({}).picture, own);
  EXPECT_THAT(folder.read("run/plot.svg"), HasSubstr("s [m]"));
  EXPECT_EQ(runs.picture("", false), own);
  write_file(own, "mine");
  EXPECT_THROW(runs.picture("", false), study::InputError);
  EXPECT_EQ(runs.picture("", true), own);
  EXPECT_EQ(runs.picture(own.string(), false), own) << "it was named";
  EXPECT_THROW(runs.picture((folder / "run/results.csv").string(), true), study::InputError);
}

TEST(PlottedRuns, OverPlacesNeedAFiniteOneForEachColumn) {
  const test::Scratch folder;
  folder.write("run/results.csv", "t[s],a[m],b[m]\n0,1,2\n1,2,3\n");
  const PlottedRuns runs({(folder / "run").string(), "a", "b"});
  EXPECT_EQ(runs.drawn({0, 1}).picture.panels.size(), 1U);
  EXPECT_THROW(static_cast<void>(runs.drawn({0})), study::InputError);
  for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(static_cast<void>(runs.drawn({0, wrong})), study::InputError);
}

/// Two curves a run, one letter a run; the axis is one of places.
TEST(TerminalPlot, CurvesOfOnePenHaveTheLetterOfTheLegend) {
  Panel panel{"x [m]", "mz [N m]", {0, 3}, {}};
  panel.free_x = true;
  for (std::size_t i = 0; i < 4; ++i) {
    panel.curves.push_back({{0, 7}, {double(i), double(i)}});
    panel.curves.back().pen = i / 2;
  }
  const std::string text = terminal_plot({"one", "two"}, {panel});
  EXPECT_THAT(text, HasSubstr("a one\nb two\n"));
  EXPECT_THAT(text, HasSubstr("|aaaa"));
  EXPECT_THAT(text, HasSubstr("|bbbb"));
  EXPECT_THAT(text, testing::Not(HasSubstr("cccc")));
  EXPECT_THAT(text, HasSubstr("7 m\n"));
}

TEST(SvgPlot, NoTwoPensAreAlikeAndTheLegendShowsTheirDashesWhole) {
  constexpr std::size_t many = 100;
  std::set<std::pair<std::string, std::string>> seen;
  for (std::size_t i = 0; i < many; ++i) seen.emplace(pen(i).colour, pen(i).dashes);
  EXPECT_EQ(seen.size(), many);
  const SvgLegend legend = svg_legend(std::vector<std::string>(many, "run"), 0, 860, 0);
  std::istringstream lines(legend.text);
  std::size_t samples = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("<path")) continue;
    std::istringstream dashes(pen(samples++).dashes);
    double period = 0;
    for (double length = 0; dashes >> length;) period += length;
    EXPECT_GE(std::stod(line.substr(line.find(" h") + 2)), period) << line;
  }
  EXPECT_EQ(samples, many);
}

/// Names of scenes have up to 64 characters; 36 of them are as long as a panel with what is below it is high.
TEST(SvgPlot, LabelsTooLongToStandBesideTheirPanelStandAboveIt) {
  const auto drawn = [](const std::string& label) {
    return svg_plot("t", {"c"}, {Panel{"x", label, {0, 1}, {Curve{{0, 1}, {0, 1}}}}});
  };
  EXPECT_THAT(drawn(std::string(36, 'n')), HasSubstr("rotate(-90)"));
  EXPECT_THAT(drawn(std::string(36, 'n')), HasSubstr("height=\"332\""));
  const std::string longer(70, 'n'), longest(140, 'n');
  EXPECT_THAT(drawn(longer), testing::Not(HasSubstr("rotate(-90)")));
  EXPECT_THAT(drawn(longer), HasSubstr("<text x=\"88\" y=\"85\" font-size=\"13\">" + longer + "<"));
  EXPECT_THAT(drawn(longer), HasSubstr("height=\"352\"")) << "20 more, so that it lies over no other panel";
  // 140 letters 7 wide are 980: of size 13 they would be cut at the panel's width of 748.
  EXPECT_THAT(drawn(longest), HasSubstr("font-size=\"9.92\">" + longest + "<"));
}

}  // namespace
}  // namespace withy
