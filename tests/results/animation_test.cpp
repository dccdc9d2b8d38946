/// \file
/// The motion that a report holds, as files for other programs have it.
#include "withy/results/report/animation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "scratch.hpp"
#include "withy/results/report/base64.hpp"
#include "withy/results/report/paraview.hpp"
#include "withy/results/results_error.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

/// A part of a page: a straight line of two points, 1 m long.
Json line_part(const std::string& name, int parent) {
  return {{"name", name},
          {"kind", "line"},
          {"parent", parent},
          {"moves", false},
          {"flexible", true},
          {"points", {0, 0, 0, 1, 0, 0}},
          {"children", Json::array()},
          {"hung", Json::array()}};
}

/// One moment of a beam in two segments, each straight, of which the second has turned by an angle about z at the
/// joint; `turned` of the whole about z, at (1, 2, 3).
std::string two_segments(double angle, double turned, const std::string& second_name) {
  Json first = line_part("boom", -1), second = line_part(second_name, 0);
  first["children"] = {1};
  first["hung"] = Json::array({{1, 0, 0, 1, 0, 0, 0}});
  std::vector<float> numbers;
  const auto pose = [&](double x, double y, double z, double about_z) {
    for (const double n : {x, y, z, std::cos(about_z / 2), 0.0, 0.0, std::sin(about_z / 2)})
      numbers.push_back(static_cast<float>(n));
  };
  const auto straight = [&] { numbers.insert(numbers.end(), 6, 0.0F); };
  pose(1, 2, 3, turned);
  straight();
  pose(1, 0, 0, 0);  // where the second hangs on the first
  pose(1 + std::cos(turned), 2 + std::sin(turned), 3, turned + angle);
  straight();
  const Json run{{"title", "boom"},
                 {"arrays", {base64_of(std::vector<double>{0.0}), base64_of(numbers)}},
                 {"animation",
                  {{"gravity", {0, 0, 0}},
                   {"parts", Json::array({first, second})},
                   {"size", numbers.size()},
                   {"times", 0},
                   {"numbers", 1}}}};
  return run.dump();
}

TEST(Animation, ASegmentIsUndeformedWhereItsWholeBeamIs) {
  const double turned = 0.4, angle = 0.3;
  constexpr double rounding = 1e-6;  // of a page's numbers, of 32 bits
  const Vector3 end(1, 0, 0), along(std::cos(turned), std::sin(turned), 0), root(1, 2, 3);
  const Animation beam(two_segments(angle, turned, "boom"));
  const auto place = [&](const Animation& run, std::size_t body) {
    const Pose X = run.undeformed(body, 0);
    return Vector3(X.p + X.R * end);
  };
  EXPECT_LT((place(beam, 0) - (root + along)).norm(), rounding);
  EXPECT_LT((place(beam, 1) - (root + 2 * along)).norm(), rounding);
  // A body of its own, which hangs there as well, is where it is.
  const Animation two(two_segments(angle, turned, "hand"));
  const Vector3 bent(std::cos(turned + angle), std::sin(turned + angle), 0);
  EXPECT_LT((place(two, 1) - (root + along + bent)).norm(), rounding);
}

TEST(Animation, WhatThirtyTwoBitsLeaveOfPlacesIsAddedToThem) {
  Json run = Json::parse(two_segments(0.3, 0.4, "boom"));
  EXPECT_FALSE(Animation(run.dump()).far());
  const std::vector<float> remainders{0.1F, 0, -0.2F, 0, 0.3F, 0};
  run["animation"]["remainders"] = run["arrays"].size();
  run["arrays"].push_back(base64_of(remainders));
  const Animation plain(two_segments(0.3, 0.4, "boom")), far(run.dump());
  EXPECT_TRUE(far.far());
  for (std::size_t b = 0; b < 2; ++b) {
    const Vector3 left(remainders[3 * b], remainders[3 * b + 1], remainders[3 * b + 2]);
    EXPECT_LT((far.pose(b, 0).p - plain.pose(b, 0).p - left).norm(), 1e-15);
  }
  run["arrays"].back() = base64_of(std::vector<float>{0.1F});
  EXPECT_THROW(Animation(run.dump()), ResultsError);
}

/// Of all points the mean, which in the rings of a tube is that of its line.
Vector3 mean_displacement(const std::string& run_text) {
  const test::Scratch folder;
  std::vector<Animation> runs;
  runs.emplace_back(run_text);
  write_paraview(folder / "boom.pvd", runs);
  const std::string grid = folder.read("boom/1_0000.vtu"), before = "Name=\"displacement\"";
  const std::size_t begin = grid.find('>', grid.find(before)) + 1;
  const std::vector<std::byte> bytes = bytes_of_base64(grid.substr(begin, grid.find('<', begin) - begin));
  std::vector<float> numbers((bytes.size() - 8) / sizeof(float));  // behind their count
  std::memcpy(numbers.data(), bytes.data() + 8, numbers.size() * sizeof(float));
  Vector3 sum = Vector3::Zero();
  for (std::size_t i = 0; i + 2 < numbers.size(); i += 3) sum += Vector3(numbers[i], numbers[i + 1], numbers[i + 2]);
  return sum * 3 / static_cast<double>(numbers.size());
}

TEST(Paraview, DisplacementsOfSegmentsAreThoseOfTheWholeBeam) {
  const double angle = 0.3;
  // Of four ends of equal tubes one has moved, from (2, 0, 0) to (1 + cos, sin, 0) in the beam's own axes.
  const Vector3 mean = mean_displacement(two_segments(angle, 0, "boom"));
  EXPECT_NEAR(mean.x(), (std::cos(angle) - 1) / 4, 1e-6);
  EXPECT_NEAR(mean.y(), std::sin(angle) / 4, 1e-6);
  EXPECT_NEAR(mean.z(), 0, 1e-6);
  EXPECT_LT(mean_displacement(two_segments(angle, 0, "hand")).norm(), 1e-6);
}

}  // namespace
}  // namespace withy
