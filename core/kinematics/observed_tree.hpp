/// \file
/// The constants of observations: nodes, and where the frames of the model's bodies are on them.
#pragma once

#include <memory>
#include <vector>

#include "withy/core/kinematics/observation.hpp"
#include "withy/core/kinematics/observed_node.hpp"
#include "withy/core/tree/placed_tree.hpp"
#include "withy/core/tree/twins.hpp"

namespace withy::observed {

/// A frame of a body of the model.
struct FramePlace {
  int node = -1;      ///< −1: the world
  int station = -1;   ///< −1: the node's frame
  Pose pose;          ///< there
  double height = 0;  ///< of its origin above the plane [m]; in a plane alone
};

/// The frame of a body of the model.
struct BodyAxes {
  Matrix3 R;  ///< R_NB of it on its node
  bool flexible = false;
  int node = -1;          ///< −1: the world
  int station = -1;       ///< −1: the node's frame
  bool expanded = false;  ///< Observation::expands
};

/// A tree in a plane or in space.
template <class Space>
class Tree final : public ObservedModel, public std::enable_shared_from_this<Tree<Space>> {
 public:
  /// \param tree with the stations of all frames; `carrying`: for each node how many of them bodies hang on
  Tree(const Model& model, Terms terms, const PlacedTree& tree, const std::vector<std::size_t>& carrying,
       const std::vector<FramePlace>& frames);
  [[nodiscard]] std::unique_ptr<Observation> make_observation() const override;

  [[nodiscard]] const FramePlace& frame(int body, int index) const {
    return frames_[first_frame_[static_cast<std::size_t>(body)] + static_cast<std::size_t>(index)];
  }

  std::vector<Node<Space>> nodes;
  std::vector<BodyAxes> bodies;
  Pose plane;                               ///< its axes in the world; the world's own where the tree is not planar
  Vector3 gravity;                          ///< in these axes
  double height_moment = 0;                 ///< Σ m z [kg m]; in a plane alone
  double fixed_potential = 0;               ///< of the weight of bodies fixed to the world [J]
  std::size_t size = 0;                     ///< of State::y
  std::size_t positions = 0;                ///< of these
  std::size_t stations = 0, rod_packs = 0;  ///< of all nodes

 private:
  void add_node(const NodeSpec& spec, StrainOrder order, std::size_t carrying, Twins& twins);

  std::vector<std::size_t> first_frame_;  ///< of each body among all frames
  std::vector<FramePlace> frames_;
  std::vector<double> heights_;  ///< of the nodes' frames
};

}  // namespace withy::observed
