/// \file
/// What pages and pictures of runs are made of: tables of bounded size that lose no peak, and text that survives a
/// page.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "scratch.hpp"
#include "withy/results/csv_recorder.hpp"
#include "withy/results/report/base64.hpp"
#include "withy/results/report/decimated_table.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/report/solids.hpp"
#include "withy/results/results_error.hpp"
#include "withy/results/table_picture.hpp"
#include "withy/results/terminal_plot.hpp"

namespace withy {
namespace {

using test::Scratch;
using testing::HasSubstr;

TEST(DecimatedTable, KeepsEveryExtremeAtItsPlaceAndOrderWhateverTheLength) {
  std::mt19937 random(5);
  std::normal_distribution<double> step;
  for (const int rows : {1, 7, 16, 17, 100, 4097}) {
    DecimatedTable table(16, 10);
    table.begin({{"t", "s"}, {"walk", "m"}});
    std::vector<double> walk;
    for (int i = 0; i < rows; ++i) {
      walk.push_back((walk.empty() ? 0 : walk.back()) + step(random));
      table.row(std::vector<double>{double(i), walk.back()});
    }
    const std::vector<double> times = table.column(0), kept = table.column(1);
    ASSERT_EQ(times.size(), kept.size());
    EXPECT_LE(kept.size(), 32U) << rows;
    EXPECT_EQ(times.front(), 0);
    EXPECT_EQ(times.back(), rows - 1) << "the last row is in the last stretch";
    EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
    if (table.stride() == 1) {
      EXPECT_EQ(kept, walk);
      continue;
    }
    // Of each stretch the least and the greatest, in their order.
    for (std::size_t s = 0; 2 * s < kept.size(); ++s) {
      const auto begin = walk.begin() + static_cast<std::ptrdiff_t>(s * table.stride());
      const auto end = walk.begin() + static_cast<std::ptrdiff_t>(std::min(walk.size(), (s + 1) * table.stride()));
      const auto [low, high] = std::minmax_element(begin, end);
      EXPECT_EQ(kept[2 * s], low < high ? *low : *high);
      EXPECT_EQ(kept[2 * s + 1], low < high ? *high : *low);
    }
    const auto samples = table.samples();
    EXPECT_LE(samples.size(), 11U);
    EXPECT_EQ(samples.back(), (std::vector<double>{rows - 1.0, walk.back()}));
    for (const auto& row : samples) EXPECT_EQ(row[1], walk[static_cast<std::size_t>(row[0])]);
  }
}

TEST(Base64, IsThatOfTheStandard) {
  // RFC 4648, section 10.
  const std::vector<std::pair<std::string, std::string>> vectors = {
      {"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : vectors) {
    EXPECT_EQ(base64(std::as_bytes(std::span(bytes))), text);
    EXPECT_EQ(numbers_of<char>(text), std::vector<char>(bytes.begin(), bytes.end()));
  }
  EXPECT_THROW(bytes_of_base64("Zm 9v"), ResultsError);
}

TEST(Solids, AreClosedAndTheirTrianglesLookOutwards) {
  // What a closed surface encloses, by the divergence theorem; triangles that look inwards count against it.
  const auto volume = [](const auto& add) {
    Surface surface;
    add(surface);
    double sum = 0;
    for (const auto& [a, b, c] : surface.triangles)
      sum += surface.vertices[a].dot(surface.vertices[b].cross(surface.vertices[c])) / 6;
    return sum;
  };
  const Pose pose{Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()).toRotationMatrix(), Vector3(4, -5, 6)};
  EXPECT_NEAR(volume([&](Surface& s) { add_box({1, 2, 3}, pose, s); }), 6, 1e-12);
  EXPECT_NEAR(volume([&](Surface& s) { add_bead(pose.p, 0.5, s); }), 4.0 / 3 * 0.125, 1e-13);
  const std::vector<Vector3> line = {pose.p, (pose * Pose{Matrix3::Identity(), {0, 0, 1}}).p,
                                     (pose * Pose{Matrix3::Identity(), {0, 0, 3}}).p};
  const double octagon = 8 * 0.5 * 0.01 * std::sin(std::numbers::pi / 4);
  EXPECT_NEAR(volume([&](Surface& s) { add_tube(line, 0.1, 8, Vector3::UnitZ(), s); }), 3 * octagon, 1e-13);
}

TEST(Csv, IsReadBackAsItWasWrittenButForALastLineThatWasCut) {
  const Scratch folder;
  const std::vector<Column> columns = {{"t", "s"}, {"float.wx", "rad/s"}, {"boom.bending_y[2]", ""}};
  CsvRecorder csv(folder / "t.csv");
  csv.begin(columns);
  csv.row(std::vector<double>{0, -1e-300, 0.1});
  csv.row(std::vector<double>{0.1, 1.0 / 3, std::nan("")});
  csv.end();
  folder.write("t.csv", folder.read("t.csv") + "0.2,4");
  MemoryRecorder back;
  read_csv(folder / "t.csv", back);
  ASSERT_EQ(back.rows().size(), 2U);
  EXPECT_EQ(back.rows()[0], (std::vector<double>{0, -1e-300, 0.1}));
  EXPECT_EQ(back.rows()[1][1], 1.0 / 3);
  EXPECT_TRUE(std::isnan(back.rows()[1][2]));
  EXPECT_EQ(back.columns()[1].name, "float.wx");
  EXPECT_EQ(back.columns()[1].unit, "rad/s");
  EXPECT_EQ(back.columns()[2].name, "boom.bending_y.2") << "brackets hold units alone";
  EXPECT_EQ(back.columns()[2].unit, "1");
  for (const auto& [text, why] : {std::pair("t[s],x\n", ":1: expected name[unit], got 'x'"),
                                  std::pair("t[s],x[m]\n0,1\n0,1,2\n", ":3: expected 2 numbers"),
                                  std::pair("t[s],x[m]\n0,one\n", ":2: expected numbers")}) {
    folder.write("bad.csv", text);
    try {
      read_csv(folder / "bad.csv", back);
      ADD_FAILURE() << text;
    } catch (const ResultsError& e) {
      EXPECT_THAT(e.what(), HasSubstr(why));
    }
  }
}

TEST(TablePicture, DrawsWhatIsAskedForAndNamesWhatIsNear) {
  DecimatedTable table(100, 0);
  table.begin({{"t", "s"}, {"shoulder", "rad"}, {"link.tip.x", "m"}, {"link.tip.deflection_y", "m"}, {"work", "J"}});
  for (int i = 0; i < 50; ++i) table.row(std::vector<double>{0.1 * i, 0.01 * i, 1, std::sin(0.1 * i), 0});
  const auto labels = [&](const std::vector<std::string>& names) {
    std::vector<std::string> all;
    for (const Panel& panel : table_panels({{"run", &table}}, names)) all.push_back(panel.y_label);
    return all;
  };
  EXPECT_THAT(labels({}), testing::ElementsAre("shoulder [deg]", "link.tip.deflection_y [m]"));
  EXPECT_THAT(labels({"link.tip"}), testing::ElementsAre("link.tip.x [m]", "link.tip.deflection_y [m]"));
  EXPECT_NEAR(table_panels({{"run", &table}}, {"shoulder"})[0].y_range.second, 0.49 * 180 / 3.14159265358979, 1e-9);
  try {
    labels({"sholder"});
    ADD_FAILURE();
  } catch (const ResultsError& e) {
    EXPECT_STREQ(e.what(), "there is no column \"sholder\"; did you mean \"shoulder\"?");
  }
  const Panel envelope = envelope_panel({{"run", &table}}, {"link.tip.x", "link.tip.deflection_y"}, {0.5, 2});
  ASSERT_EQ(envelope.curves.size(), 2U);
  EXPECT_EQ(envelope.curves[1].x, (std::vector<double>{0.5, 2}));
  EXPECT_EQ(envelope.curves[0].y, (std::vector<double>{1, std::sin(4.7)}));
  EXPECT_EQ(envelope.curves[1].y, (std::vector<double>{1, std::sin(1.6)}));
  EXPECT_THROW(envelope_panel({{"run", &table}}, {"shoulder", "work"}, {0, 1}), ResultsError);
  const std::string text = terminal_plot({"run"}, table_panels({{"run", &table}}, {"shoulder"}));
  EXPECT_THAT(text, HasSubstr("shoulder [deg]"));
  EXPECT_THAT(text, HasSubstr("28.07 |")) << "the greatest value";
  EXPECT_THAT(text, HasSubstr("4.9 s"));
}

TEST(Report, HoldsEveryRunWholeWhateverItsTexts) {
  if (!has_report_page()) GTEST_SKIP() << "built without npm";
  const Scratch folder;
  const std::string scene = R"({"scene":"</script><!-- \u00e4 ,\n]} -->"})";
  write_report(folder / "a.html", {"a </title> & b", {scene, R"({"title":"other"})"}, 1});
  const auto runs = read_report(folder / "a.html");
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_THAT(runs[0], testing::Not(HasSubstr("<"))) << "nothing can end the element that holds the data";
  write_report(folder / "b.html", {"again", runs, -1});
  EXPECT_EQ(read_report(folder / "b.html"), runs);
  EXPECT_LT(std::filesystem::file_size(folder / "a.html"), 1'500'000U);
  folder.write("c.html", "<html></html>");
  EXPECT_THROW(read_report(folder / "c.html"), ResultsError);
}

}  // namespace
}  // namespace withy
