/// \file
/// The motion that a report holds, for programs that draw motions: bodies as surfaces, moment by moment.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "withy/results/report/solids.hpp"

namespace withy {

/// One run in motion, as RunReport has put it on a page.
class Animation {
 public:
  /// \param run one of those of read_report. \throws ResultsError where it holds no motion
  explicit Animation(std::string_view run);

  [[nodiscard]] const std::string& title() const { return title_; }
  /// Times of the moments [s], each later than the one before: of an instant at which states jump, the state after it.
  [[nodiscard]] const std::vector<double>& times() const { return times_; }
  /// Which way is up, world axes: against gravity; z where there is none.
  [[nodiscard]] const Vector3& up() const { return up_; }

  [[nodiscard]] std::size_t bodies() const { return bodies_.size(); }
  [[nodiscard]] const std::string& name(std::size_t body) const { return bodies_[body].name; }
  [[nodiscard]] bool flexible(std::size_t body) const { return bodies_[body].flexible; }
  /// Whether the motion is so far from the world's origin, for its size, that 32 bits do not tell its places.
  [[nodiscard]] bool far() const { return !remainders_.empty(); }
  /// Of a body at a moment, in the world.
  [[nodiscard]] Pose pose(std::size_t body, std::size_t moment) const;
  /// Where it would be at a moment, were all that it is a part of undeformed: of a segment of a beam as far from the
  /// whole beam's root as at rest; of any other body its pose.
  [[nodiscard]] Pose undeformed(std::size_t body, std::size_t moment) const;
  /// Its surface at rest: a tube along a beam, the sheet of a plate with its thickness, the outer faces of a mesh,
  /// beads at the points of a body whose faces are not known, the surface that a rigid body is given, or else the box
  /// of its mass and inertia with rods to what hangs on it. Without triangles where there is nothing to draw.
  [[nodiscard]] Surface surface(std::size_t body) const;
  /// Its vertices, deformed as at a moment, body axes; those of `surface`, in their order.
  [[nodiscard]] std::vector<Vector3> vertices(std::size_t body, std::size_t moment) const;

 private:
  struct Body {
    std::string name, kind;
    bool flexible = false;
    std::vector<Vector3> points;  ///< at rest
    std::size_t columns = 1;      ///< points across a sheet
    double thickness = 0;         ///< of a sheet [m]
    std::vector<float> shapes;    ///< of its points, as ModeShapes has them, one behind the other
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< of a mesh
    bool has_box = false;
    Vector3 edges = Vector3::Zero();
    Pose box;
    std::size_t hung = 0;           ///< poses on which children hang
    std::vector<Vector3> ends;      ///< of rods from a rigid body's box
    std::vector<std::size_t> line;  ///< points that a tube goes along
    std::vector<Outline> outlines;  ///< of the tube at its points; empty: as thick as is well seen
    bool turns = false;             ///< whether its numbers have the y axes of sections
    std::optional<Surface> given;   ///< that it is drawn with
    std::size_t at = 0;             ///< of its numbers in those of a moment
    std::size_t root = 0;           ///< itself, or of a segment the first of its beam
    Pose from_root;                 ///< in the root's frame, where that beam is undeformed
    [[nodiscard]] std::size_t size() const;
    /// Shapes, each of three numbers a point.
    [[nodiscard]] std::size_t weights() const { return points.empty() ? 0 : shapes.size() / (3 * points.size()); }
  };
  /// Points of a body and, where its numbers have them, the y axes of its sections.
  struct Shape {
    std::vector<Vector3> points, y_axes;
  };
  /// Finds what segments are parts of.
  void join_segments(const nlohmann::ordered_json& parts);
  static Body body_of(const nlohmann::ordered_json& part, const nlohmann::ordered_json& run);
  [[nodiscard]] Shape shape_at(const Body& body, std::size_t moment) const;
  [[nodiscard]] Surface drawn(const Body& body, const Shape& shape) const;
  [[nodiscard]] Surface tube(const Body& body, const Shape& shape) const;
  [[nodiscard]] double extent() const;

  std::string title_;
  std::vector<double> times_;
  std::vector<std::size_t> moments_;  ///< of each time, its place in numbers_
  std::vector<float> numbers_;
  std::vector<float> remainders_;  ///< what numbers_ leave of positions, three a body and moment; empty: nothing
  std::size_t size_ = 0;           ///< numbers of a moment
  Vector3 up_ = Vector3::UnitZ();
  std::vector<Body> bodies_;
  double radius_ = 0;  ///< of rods and beads [m]
};

}  // namespace withy
