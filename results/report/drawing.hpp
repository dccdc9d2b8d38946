/// \file
/// What there is to draw of a model, and where it is at a state: for animations.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/results/report/bent_body.hpp"
#include "withy/results/report/looks.hpp"
#include "withy/results/report/mode_shapes.hpp"

namespace withy {

/// A model's bodies as boxes, lines, sheets, meshes and points, each body in its own strain kinematics. A moment is one
/// pass over the tree: time and memory in proportion to bodies and points.
class Drawing {
 public:
  /// \param terms of the formulation, for bodies that have none of their own
  /// \param equations of that model in that formulation, whose observations serve the drawing too; null: it makes its
  ///   own
  Drawing(const std::shared_ptr<const Model>& model, const Terms& terms, Looks looks = {},
          const EquationsOfMotion* equations = nullptr);

  /// What stays: of each body its name, its parent, kind, points at rest [m, body axes]; of a rigid one the box that
  /// has its mass and inertia; where its children hang on it.
  [[nodiscard]] nlohmann::ordered_json part(std::size_t body) const;
  [[nodiscard]] std::size_t parts() const { return parts_.size(); }
  /// The surface that a body is given; null where there is none. The sections of a beam at its points; none of others.
  [[nodiscard]] const Surface* surface(std::size_t body) const;
  [[nodiscard]] const std::vector<Outline>& sections(std::size_t body) const { return parts_[body].sections; }
  /// Of a sheet or a mesh the shapes that its displacements are sums of; of others none.
  [[nodiscard]] const ModeShapes& shapes(std::size_t body) const { return parts_[body].shapes; }
  /// Of a mesh, triangles of its points, counter-clockwise seen from outside; of others none.
  [[nodiscard]] const std::vector<std::array<std::uint32_t, 3>>& triangles(std::size_t body) const {
    return parts_[body].triangles;
  }
  /// Whether `append` tells how the sections are turned: where they are not round and the body twists.
  [[nodiscard]] bool turns(std::size_t body) const { return parts_[body].turns; }
  /// Of a state, y as in State, appended: of each body position [m] and quaternion w x y z in the world; of a flexible
  /// one the weights of its shapes, or displacement of each point [m], if it turns the y axis of each section, and the
  /// poses on which its children hang, body axes.
  /// \param remainders what 32 bits leave of each body's position [m], three numbers a body
  void append(std::span<const double> y, std::vector<float>& numbers, std::vector<float>& remainders);
  /// How large all that is drawn is at a state [m]: the diagonal of the box about it, of flexible bodies at rest.
  [[nodiscard]] double extent(std::span<const double> y);
  /// Of a state, each body as a line in the world [m]: along a flexible body, or from a rigid body's root to what hangs
  /// on it.
  [[nodiscard]] std::vector<std::vector<Vector3>> lines(std::span<const double> y);
  /// How many numbers `append` adds.
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  enum class Kind { box, line, strip, mesh, points };
  struct Part {
    Kind kind = Kind::box;
    bool flexible = false;
    int frame = 0;                             ///< that has the pose of the body's
    std::vector<Vector3> at_rest;              ///< of the points, or of the vertices that shapes displace
    std::shared_ptr<BentBody> bent = nullptr;  ///< of a flexible body its points; null where shapes displace them
    std::vector<int> children;                 ///< bodies that hang on a flexible body
    std::vector<int> hung;                     ///< frames of these, one a child
    std::vector<Pose> offsets;                 ///< of the hinges in them
    std::size_t columns = 1;                   ///< points across a strip
    double thickness = 0;                      ///< of a strip [m]
    ModeShapes shapes = {};                    ///< of a strip and a mesh, which have no frames as points
    std::vector<std::array<std::uint32_t, 3>> triangles = {};
    std::vector<Outline> sections = {};  ///< of a beam, at its points
    bool turns = false;                  ///< of a line, whether its sections' turns are told
  };
  [[nodiscard]] std::span<const double> without_discrete(std::span<const double> y) const;
  void hang(const std::vector<HingeNode>& hinges);
  void see(const Terms& terms, const EquationsOfMotion* equations);
  void add_points(const BodyNode& node, const std::shared_ptr<const Hinge>& hinge, const Terms& terms,
                  Part& part) const;
  bool add_strip(const BodyNode& node, Part& part, bool second_order) const;
  bool add_mesh(const BodyNode& node, Part& part, bool second_order) const;
  [[nodiscard]] Vector3 place(std::size_t body, std::size_t point, const Eigen::VectorXf& weights) const;
  [[nodiscard]] Eigen::VectorXf weights(std::size_t body, std::span<const double> y) const;
  [[nodiscard]] bool bend(std::size_t body, std::span<const double> y);
  void add_sections(const BodyNode& node, Part& part) const;
  [[nodiscard]] std::vector<PointExpansion> along(const BodyNode& node) const;

  Looks looks_;
  std::shared_ptr<const Model> model_;  ///< every body has a frame with the pose of its own
  std::vector<Part> parts_;
  std::unique_ptr<Observation> seen_;
  std::size_t size_ = 0;
};

/// The two axes, in the order x, y, z, along which a box between two corners is longest: the plane to draw what is in
/// it.
std::pair<Eigen::Index, Eigen::Index> widest_plane(const Vector3& low, const Vector3& high);

}  // namespace withy
