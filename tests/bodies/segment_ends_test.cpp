/// \file
/// Beams cut into segments where something is at the end of one: a jump of the section, a frame, a load.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numeric>

#include "withy/core/plugin/segments.hpp"
#include "withy/core/simulation/sensor_reader.hpp"
#include "withy/plugins/host/static_plugins.hpp"
#include "withy/scene/scene.hpp"

namespace withy::test {
namespace {

using testing::Each;

class SegmentEnds : public testing::Test {
 protected:
  SegmentEnds() { enroll_static_plugins(registry_); }
  Scene scene(const std::string& text) { return parse_scene(text, "s.yaml", registry_, {}); }
  Registry registry_;
};

/// A cantilever of 1 m in two segments: mass and stiffness as these tables say.
std::string stepped(const std::string& mass, const std::string& stiffness) {
  return "format: withy/1\ntime: {end: 1}\nbodies: {boom: {type: beam, length: 1, segments: 2, mass_per_length: " +
         mass + ", bending_y: {stiffness: " + stiffness +
         ", modes: 2, family: orthogonal-polynomials}}}\nhinges: {root: {type: weld, parent: world, child: boom}}\n";
}

/// What a unit force along y at the tip of the last segment deflects it by, the others being rigid [m/N].
double compliance(const Body& segment) {
  const Eigen::RowVectorXd along_y = segment.station(std::string("tip"))->phi.row(1);
  return along_y.dot(segment.shape().stiffness.ldlt().solve(along_y.transpose()));
}

/// Two rows close together, about a billionth of a segment from the cut, on its outer side, its inner one or both:
/// of either segment mass ρL/2 and compliance (L/2)³/(3 EI) are those of its own side of the jump. Rows that are kept
/// have 3·1e-9 of the compliance between them, where the stiffness is 5.5 times the softer in the mean: 1.4e-8.
TEST_F(SegmentEnds, a_jump_at_the_end_of_a_segment_is_the_jump_of_both) {
  for (const auto& [before, after] :
       {std::pair("0.5", "0.5000000001"), std::pair("0.4999999999", "0.5"), std::pair("0.4999999999", "0.5000000001"),
        std::pair("0.5", "0.5000000005"), std::pair("0.4999999995", "0.5")}) {
    const auto table = [&, from = before, to = after](const std::string& first, const std::string& second) {
      return "[[0, " + first + "], [" + from + ", " + first + "], [" + to + ", " + second + "], [1, " + second + "]]";
    };
    const Scene made = scene(stepped(table("2", "0.5"), table("100", "10")));
    const double mass[] = {1, 0.25}, stiffness[] = {100, 10};
    for (std::size_t k = 0; k < 2; ++k) {
      const Body& segment = *made.model->bodies()[k].body;
      const std::vector<Particle>& particles = segment.shape().particles;
      const double all = std::accumulate(particles.begin(), particles.end(), 0.0,
                                         [](double sum, const Particle& p) { return sum + p.mass; });
      EXPECT_NEAR(all, mass[k], 1e-9) << before << ", " << after;
      const double expected = 0.125 / (3 * stiffness[k]);
      EXPECT_NEAR(compliance(segment), expected, 2e-8 * expected) << before << ", " << after;
    }
  }
}

/// A rigid beam of 2 kg and 2 m with 5 kg welded to it at a multiple of 0.2 m.
std::string loaded(int segments, int place, bool held_there) {
  const std::string at = std::to_string(place / 5) + "." + std::to_string(2 * (place % 5));
  return "format: withy/1\ntime: {end: 1}\ngravity: [0, -10, 0]\nbodies:\n  boom: {type: beam, length: 2, "
         "mass_per_length: 1, segments: " +
         std::to_string(segments) + ", frames: {here: {at: " + at +
         "}}}\n  load: {type: rigid, mass: 5}\nhinges:\n  root: {type: weld, parent: world, child: " +
         (held_there ? "boom.here" : "boom") + "}\n  on: {type: weld, parent: boom.here, child: load}\n" +
         "outputs: {cut: {type: section, of: boom, at: " + at + "}}\n";
}

double inner_force(const Scene& made) {
  const auto equations = made.formulation->compile(made.model);
  SensorReader reader(made.outputs, *equations);
  std::vector<double> seen(reader.columns().size());
  EXPECT_TRUE(reader.read(made.initial, seen));
  return seen.at(1);  // f: x, y, z
}

/// What is attached at the section is beyond it, the weight of 1 kg/m too: 10 N (5 + 2 − x). Where the beam is held
/// there its hinge is beyond as well, which carries all: 10 N (5 + 2 − x − 7). In any number of segments.
TEST_F(SegmentEnds, a_section_at_the_end_of_a_segment_carries_what_is_attached_there) {
  for (const int segments : {1, 2, 5, 10, 20}) {
    for (int place = 1; place <= 9; ++place) {
      const double x = 0.2 * place;
      EXPECT_NEAR(inner_force(scene(loaded(segments, place, false))), 10 * (7 - x), 1e-9) << segments << ", " << x;
      EXPECT_NEAR(inner_force(scene(loaded(segments, place, true))), -10 * x, 1e-9) << segments << ", " << x;
    }
  }
}

/// However the lengths of segments are rounded, the tip's own coordinate is the tip, and the ends of segments belong to
/// the outer ones.
TEST_F(SegmentEnds, every_place_from_root_to_tip_is_one_in_any_number_of_segments) {
  for (const double length : {2.0, 3.0, 0.9144, 10.0}) {
    for (std::size_t n = 2; n <= 60; ++n) {
      const auto end = [&](std::size_t k) { return length * static_cast<double>(k) / static_cast<double>(n); };
      std::vector<double> lengths;
      for (std::size_t k = 0; k < n; ++k) lengths.push_back(end(k + 1) - end(k));
      for (std::size_t k = 0; k <= n; ++k) {
        const auto at = place_in_segments(lengths, end(k));
        ASSERT_TRUE(at) << length << " m in " << n << ", end " << k;
        EXPECT_EQ(at->segment, std::min(k, n - 1)) << length << " m in " << n;
        EXPECT_LE(at->x, lengths[at->segment]);
        EXPECT_NEAR(at->x, k == n ? lengths.back() : 0.0, 1e-9 * lengths.back());
      }
      EXPECT_FALSE(place_in_segments(lengths, -1e-6));
      EXPECT_FALSE(place_in_segments(lengths, length + 1e-6));
    }
  }
}

TEST_F(SegmentEnds, a_frame_at_the_tips_own_coordinate_is_taken) {
  std::vector<double> off;
  for (const int segments : {6, 14, 24, 28, 29, 38}) {
    const Scene made =
        scene("format: withy/1\ntime: {end: 1}\nbodies: {boom: {type: beam, length: 2, mass_per_length: 1, segments: " +
              std::to_string(segments) +
              ", frames: {end: {at: 2}}}}\nhinges: {root: {type: weld, parent: world, child: boom}}\n");
    const auto equations = made.formulation->compile(made.model);
    const auto at = made.model->find_frame("boom.end");
    off.push_back(std::abs(equations->frame_pose(made.initial.y, at->body, at->frame).position[0] - 2));
  }
  EXPECT_THAT(off, Each(testing::Lt(1e-14)));
}

}  // namespace
}  // namespace withy::test
