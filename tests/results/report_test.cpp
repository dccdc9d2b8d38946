/// \file
/// What pages and pictures of runs are made of: tables of bounded size that lose no peak, and text that survives a
/// page.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <sstream>

#include "scratch.hpp"
#include "withy/results/certificate_text.hpp"
#include "withy/results/csv_recorder.hpp"
#include "withy/results/report/base64.hpp"
#include "withy/results/report/decimated_table.hpp"
#include "withy/results/report/looks.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/report/solids.hpp"
#include "withy/results/results_error.hpp"
#include "withy/results/run_text.hpp"
#include "withy/results/svg_plot.hpp"
#include "withy/results/table_picture.hpp"
#include "withy/results/terminal_plot.hpp"

namespace withy {
namespace {

using test::Scratch;
using testing::HasSubstr;

TEST(RunText, AnAngleThatIsZeroHasNoSign) {
  EXPECT_EQ(readable(-1e-16, "rad"), "0.0000 deg");
  EXPECT_EQ(readable(-0.0, "rad"), "0.0000 deg");
}

TEST(RunText, SmallAnglesHaveFourDigits) {
  EXPECT_EQ(readable(-0.001, "rad"), "-0.0573 deg");
  EXPECT_EQ(readable(9.8676e-7, "rad"), "5.654e-05 deg");
  EXPECT_EQ(readable(-1e-9, "rad"), "-5.73e-08 deg");
  EXPECT_EQ(readable(1, "rad"), "57.2958 deg");
  EXPECT_EQ(degrees_text(0.1 * std::numbers::pi / 180), "0.1000");
  EXPECT_EQ(to_four_places(-0.25), "-0.2500");
  EXPECT_EQ(to_four_places(0), "0.0000");
  EXPECT_EQ(to_four_places(2e-6), "2e-06");
}

/// Two digits of 0.1254 are beyond three of a limit of 0.129.
TEST(CertificateText, AValueIsSeenOnItsSideOfItsLimit) {
  const auto told = [](double value, double limit) { return limits_text({{"rate", value, limit, "it is wrong"}}); };
  EXPECT_EQ(told(0.1254, 0.129), "all are kept; nearest is rate: 0.125, limit 0.129");
  EXPECT_EQ(told(0.12896, 0.129), "all are kept; nearest is rate: 0.129, limit 0.129");
  EXPECT_EQ(told(0.0812, 0.1), "all are kept; nearest is rate: 0.081, limit 0.1");
  EXPECT_EQ(told(0.1, 0.1), "all are kept; nearest is rate: 0.1, limit 0.1");
  EXPECT_EQ(told(0.1002, 0.1), "one is exceeded, rate: 0.1002, limit 0.1; beyond it it is wrong");
  EXPECT_EQ(told(0.81, 0.129), "one is exceeded, rate: 0.81, limit 0.129; beyond it it is wrong");
}

std::string certificate_of(const study::Certificate& c) {
  return certificate_text(Model({}, {}, Vector3::Zero()), RunSummary(), c);
}

TEST(CertificateText, WhatRoundingLeavesInAModeIsNoShareOfItsEnergy) {
  study::Certificate c;
  c.bodies.resize(1);
  c.bodies[0].highest = {{"bending_y", 1, 1.6e-31, 2}};
  EXPECT_THAT(certificate_of(c), HasSubstr("highest of 2 bending_y modes has next to none of their energy"));
  c.bodies[0].highest[0].share = 3e-9;
  EXPECT_THAT(certificate_of(c), HasSubstr("highest of 2 bending_y modes has 3e-07 % of their energy"));
}

TEST(CertificateText, ADriftThatIsNotToldApartIsNobodys) {
  study::Certificate c;
  c.energy_drift = c.untruncated_drift = 2e-3;
  const std::string unknown = "off by 0.2 % of the greatest, by the model or by integration: not told apart\n";
  c.shares = study::DriftShares{};
  EXPECT_THAT(certificate_of(c), HasSubstr(unknown));
  c.shares->energy = study::DriftShare{1e-3, 1e-3};
  EXPECT_THAT(certificate_of(c), HasSubstr(unknown));
  c.shares->energy = study::DriftShare{1.9e-3, 1e-4};
  EXPECT_THAT(certificate_of(c), HasSubstr(", 0.19 % by what the model leaves out and at most 0.01 % by integration"));
  c.shares->energy = study::DriftShare{0, 2e-3};
  EXPECT_THAT(certificate_of(c), HasSubstr(", all of it by integration"));
}

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
    EXPECT_EQ(*samples.back(), (std::vector<double>{rows - 1.0, walk.back()}));
    for (const auto& row : samples) EXPECT_EQ((*row)[1], walk[static_cast<std::size_t>((*row)[0])]);
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
  const auto on = [&](double z) { return (pose * Pose{Matrix3::Identity(), {0, 0, z}}).p; };
  const std::vector<Vector3> line = {on(0), on(1), on(3)};
  const std::vector<Vector3> y = {pose.R.col(0)};
  const double octagon = 8 * 0.5 * std::sin(std::numbers::pi / 4);
  EXPECT_NEAR(volume([&](Surface& s) { add_tube({line, {{false, 0.1, 0.2}}, y}, 8, s); }), 3 * octagon * 0.02, 1e-13);
  EXPECT_NEAR(volume([&](Surface& s) { add_tube({line, {{true, 0.1, 0.2}}, y}, 8, s); }), 3 * 0.2 * 0.4, 1e-13);
  std::vector<Vector3> grid;  // 2 by 3, turned and moved
  for (const double x : {0.0, 0.5, 1.5, 2.0})
    for (const double y : {1.5, 0.5, -1.5}) grid.push_back((pose * Pose{Matrix3::Identity(), {x, y, 0}}).p);
  EXPECT_NEAR(volume([&](Surface& s) { add_sheet(grid, 3, 0.01, s); }), 2 * 3 * 0.01, 1e-13);
  // A pyramid's frustum, whose sections are turned by a quarter without a change of its volume.
  const Outline wide{true, 0.2, 0.2}, narrow{true, 0.1, 0.1};
  EXPECT_NEAR(volume([&](Surface& s) {
                add_tube({{on(0), on(3)}, {wide, narrow}, y}, 8, s);
              }),
              3.0 / 3 * (0.16 + 0.04 + 0.08), 1e-13);
  const double ball = 4 * std::numbers::pi / 3 * 0.125;
  EXPECT_NEAR(volume([&](Surface& s) { add_ball(0.5, s); }), ball, 0.02 * ball);
}

TEST(Looks, SectionsOfBeamsAreThoseThatTheirInertiaTells) {
  const double E = 70e9, rho = 2700, r = 0.03, area = std::numbers::pi * r * r, I = area * r * r / 4;
  const auto beam = [&](std::vector<Value::Member> more) {
    more.emplace_back("length", Value(2.0));
    more.emplace_back("mass_per_length", Value(rho * area));
    return Value::map(std::move(more));
  };
  const auto bending = [&](double EI, std::vector<Value::Member> more = {}) {
    more.emplace_back("stiffness", Value(EI));
    return Value::map(std::move(more));
  };
  const Value torsion = Value::map({{"stiffness", Value(1.0)}, {"inertia", Value(2 * rho * I)}});
  const auto expect = [](const Outline& o, double y, double z, double tolerance) {
    EXPECT_NEAR(o.y, y, tolerance * y);
    EXPECT_NEAR(o.z, z, tolerance * z);
  };
  // A round bar, however the scene tells it; by its stiffness alone for the E/rho of metals, 0.3 % off.
  expect(equivalent_section(beam({{"bending_y", bending(E * I)}}), 1), r, r, 0.01);
  expect(equivalent_section(beam({{"bending_y", bending(1.0, {{"rotary_inertia", Value(rho * I)}})}}), 1), r, r, 1e-12);
  expect(equivalent_section(beam({{"bending_z", bending(E * I)}, {"extension", bending(E * area)}}), 1), r, r, 1e-12);
  expect(equivalent_section(beam({{"torsion", torsion}}), 1), r, r, 1e-12);
  expect(equivalent_section(beam({{"bending_y", bending(5)}, {"bending_z", bending(5)}, {"torsion", torsion}}), 1), r,
         r, 1e-12);
  // Four times as stiff along y as along z: twice as wide, with the same polar inertia.
  const Outline flat =
      equivalent_section(beam({{"bending_y", bending(4)}, {"bending_z", bending(1)}, {"torsion", torsion}}), 1);
  EXPECT_NEAR(flat.y / flat.z, 2, 1e-12);
  EXPECT_NEAR(flat.y * flat.y + flat.z * flat.z, 2 * r * r, 1e-12);
  // Tapered as its table is: the radius goes with the root of EI/mu.
  const auto row = [](double x, double v) { return Value::list({Value(x), Value(v)}); };
  const Value table = Value::list({row(0, E * I), row(2, E * I / 4)});
  const Value tapered = beam({{"bending_y", Value::map({{"stiffness", table}})}});
  EXPECT_NEAR(equivalent_section(tapered, 2).y, equivalent_section(tapered, 0).y / 2, 1e-12);
  EXPECT_NEAR(equivalent_section(tapered, 1).y, equivalent_section(tapered, 0).y * std::sqrt(0.625), 1e-12);
  // The root of the blade of the NREL 5 MW turbine, 3.542 m across, of composite.
  const Value blade = Value::map({{"length", Value(61.5)},
                                  {"mass_per_length", Value(709.731)},
                                  {"bending_y", bending(1.81136e10)},
                                  {"bending_z", bending(1.811e10)}});
  expect(equivalent_section(blade, 0), 1.771, 1.771, 0.15);
}

TEST(Looks, ThicknessesOfPlatesAreThoseThatTheirStiffnessTells) {
  const double E = 70e9, rho = 2700, h = 0.003, nu = 0.33;
  const auto plate = [&](double width) {
    return Value::map({{"length", Value(2.0)},
                       {"width", Value(width)},
                       {"mass_per_area", Value(rho * h)},
                       {"stiffness", Value(E * h * h * h / 12 / (1 - nu * nu))},
                       {"poisson_ratio", Value(nu)}});
  };
  EXPECT_NEAR(equivalent_thickness(plate(1)), h, 0.01 * h) << "0.3 % off for the E/rho of metals";
  EXPECT_NEAR(equivalent_thickness(plate(0.02)), 0.002, 1e-15) << "a tenth of the shorter edge at most";
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
  folder.write("excel.csv", "\xEF\xBB\xBFt[s],x[m]\r\n0,1\r\n0.1,2\r\n");  // as a spreadsheet keeps it
  MemoryRecorder kept;
  read_csv(folder / "excel.csv", kept);
  EXPECT_EQ(kept.columns()[0].name, "t");
  EXPECT_EQ(kept.column("x"), (std::vector<double>{1, 2}));
  folder.write("open.csv", "t[s],x[m]\n0,1\n0.1,2");  // cut, or of a program that leaves the last end out
  for (const auto& [last, rows] : {std::pair(OpenLine::left_out, 1U), std::pair(OpenLine::taken, 2U)}) {
    MemoryRecorder open;
    read_csv(folder / "open.csv", open, last);
    EXPECT_EQ(open.column("x").size(), rows);
  }
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
  EXPECT_THAT(labels({"link.tip.x", "link.tip", "link.tip.x"}),
              testing::ElementsAre("link.tip.x [m]", "link.tip.deflection_y [m]"));
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

TEST(TablePicture, TimeIsThatOfTheRunAlsoWhereAColumnHasGaps) {
  DecimatedTable table(100, 0);
  table.begin({{"t", "s"}, {"x", "m"}, {"gap", "N"}});
  for (int i = 0; i < 50; ++i) table.row(std::vector<double>{1000.0 + i, 7e6 + 0.01 * i, i < 9 ? std::nan("") : i});
  const std::vector<Panel> panels = table_panels({{"run", &table}}, {"x", "gap"});
  ASSERT_EQ(panels.size(), 2U);
  for (const Panel& panel : panels) EXPECT_EQ(panel.x_range, std::pair(1000.0, 1049.0));
  const std::string text = terminal_plot({"run"}, panels);
  EXPECT_THAT(text, HasSubstr("7000000.49 |")) << text;
  EXPECT_THAT(text, HasSubstr("1049 s")) << text;
}

/// Where a column has no number nothing was measured: a line across would show what was not.
TEST(TablePicture, LinesDoNotCrossGaps) {
  DecimatedTable table(100, 0);
  table.begin({{"t", "s"}, {"x", "m"}});
  for (int i = 0; i < 50; ++i) table.row(std::vector<double>{0.1 * i, i >= 10 && i < 40 ? std::nan("") : 1.0 + i % 2});
  const std::vector<Panel> panels = table_panels({{"run", &table}}, {"x"});
  ASSERT_EQ(panels.size(), 1U);
  EXPECT_EQ(panels[0].curves[0].x.size(), 20U);
  EXPECT_EQ(panels[0].curves[0].behind_gaps, std::vector<std::size_t>{10});
  const std::string picture = svg_plot("run", {"run"}, panels);
  std::size_t lines = 0;
  for (std::size_t at = 0; (at = picture.find("<polyline", at)) != std::string::npos; ++at) ++lines;
  EXPECT_EQ(lines, 2U);
  // Between 0.9 s and 4 s the terminal shows nothing either: of 4.9 s the middle three fifths.
  std::istringstream rows(terminal_plot({"run"}, panels));
  for (std::string row; std::getline(rows, row);) {
    const std::size_t axis = row.find(" |");
    if (axis == std::string::npos) continue;
    EXPECT_THAT(row.substr(axis + 2), testing::ContainsRegex(" {38,}")) << row;
  }
}

TEST(Report, HoldsEveryRunWholeWhateverItsTexts) {
  ASSERT_EQ(has_report_page(), WITHY_HAS_REPORT != 0);
  if (!WITHY_HAS_REPORT) GTEST_SKIP() << "built without npm";
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
