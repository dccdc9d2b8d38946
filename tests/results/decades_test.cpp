/// \file
/// Curves over axes in decades, where nought has no place.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "withy/results/report/figures_page.hpp"
#include "withy/results/svg_plot.hpp"
#include "withy/results/threshold_files.hpp"

namespace withy {
namespace {

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at) ++count;
  return count;
}

TEST(Decades, WhatIsZeroButForRoundingLeavesAGap) {
  Curve curve;
  const std::vector<double> values = {0, 1e-17, 1e-3, 2e-3, 0, -1, 4e-3, std::nan(""), 0};
  for (std::size_t i = 0; i < values.size(); ++i) append_in_decades(curve, double(i), values[i], 1e-13);
  EXPECT_EQ(curve.x, (std::vector<double>{2, 3, 6}));
  EXPECT_EQ(curve.y, (std::vector<double>{1e-3, 2e-3, 4e-3}));
  ASSERT_FALSE(curve.behind_gaps.empty());
  EXPECT_EQ(curve.behind_gaps.front(), 2U) << "none before the first point";
  // On a page a null parts them, as a line of its own does in a picture.
  const nlohmann::ordered_json page = figures_json("", {{"", {}, {{"x", "y", {1e-3, 1}, {curve}, 200, false, true}}}});
  const auto& drawn = page.at("pictures").at(0).at("panels").at(0).at("curves").at(0);
  EXPECT_EQ(drawn.at("y"), (nlohmann::ordered_json{1e-3, 2e-3, nullptr, 4e-3}));
  EXPECT_EQ(drawn.at("x").size(), 4U);
}

/// The error of a model that is right where nothing turns begins at the first value at which it has one.
TEST(Decades, ErrorsOfThresholdsAreDrawnFromTheFirstThatIsOne) {
  study::Sweep range;
  range.path = "spin.axle";
  range.values = {0, 0.5, 1, 1.5};
  study::Threshold row;
  row.point.formulation = "linear";
  row.point.modes = 3;
  row.errors = {2.220446049250313e-16, 3e-4, 1.2e-3, 2.7e-3};
  const std::string picture = threshold_picture("blade", {row}, range, 0.01);
  // A line for the limit, from 0, and one for the errors, of three points.
  std::vector<std::size_t> points;
  const std::string begin = " points=\"";
  for (std::size_t at = 0; (at = picture.find(begin, at)) != std::string::npos;) {
    at += begin.size();
    points.push_back(count_of(picture.substr(at, picture.find('"', at) - at), ","));
  }
  EXPECT_EQ(points, (std::vector<std::size_t>{3, 2}));
  EXPECT_EQ(count_of(picture, "stroke-width=\"2.6\""), 0U) << "no cross: it does not end early";
}

}  // namespace
}  // namespace withy
