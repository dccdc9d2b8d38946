/// \file
/// What the scene's sensors measure, as arrows of an animation.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "withy/core/plugin/equations.hpp"
#include "withy/results/recorder.hpp"
#include "withy/scene/scene.hpp"

namespace withy {

/// Forces and moments of reactions and sections, accelerations of accelerometers and of frames that are told in world
/// or own axes: each an arrow at its place, in world axes.
class Arrows {
 public:
  /// \param columns of the table that rows are of
  Arrows(const Scene& scene, const Terms& terms, const std::vector<Column>& columns);
  /// Of a moment: place [m] and vector of each arrow, world axes, are appended to it; zero where a number is missing.
  void append(std::span<const double> y, std::span<const double> row);
  /// One of them over the moments.
  struct Arrow {
    std::string name, unit;
    std::size_t column = 0;                ///< of its first component
    FrameIndex at, axes;                   ///< axes.body −1: the world
    Matrix3 offset = Matrix3::Identity();  ///< of the components' axes in those
    std::vector<float> numbers = {};
    std::vector<float> remainders = {};  ///< what 32 bits leave of its places [m]
    double greatest = 0;
  };
  [[nodiscard]] const std::vector<Arrow>& all() const { return arrows_; }

 private:
  void add(const std::string& output, const Value& value, const Model& model, std::vector<BodyNode>& bodies);
  void add_vector(const std::string& output, const char* what, const char* first, FrameIndex at, FrameIndex axes,
                  const Matrix3& offset = Matrix3::Identity());

  const std::vector<Column>& columns_;
  std::vector<Arrow> arrows_;
  std::shared_ptr<const Model> model_;  ///< with a frame at each section
  std::unique_ptr<Observation> seen_;
};

}  // namespace withy
