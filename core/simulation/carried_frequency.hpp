/// \file
/// How slowly a flexible structure vibrates as it is carried: with what hangs on it, at the present configuration, its
/// hinges held.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/memory.hpp"

namespace withy {

/// The lowest frequency of every group of flexible bodies that move each other while all hinges are held: those on one
/// way from the root. By inverse iteration x ← K⁻¹ M x, continued from the last state: a product with M each. Allocates
/// nothing after construction.
class CarriedFrequency {
 public:
  CarriedFrequency(const Model& model, const EquationsOfMotion& equations);
  /// Goes to a state, y as in State; the strict formulations stay at the first. \param work of the equations
  void update(std::span<const double> y, Work& work);
  void remember(Memory& memory) {
    memory(shape_);
    memory(begun_);
    for (Group& group : groups_) memory(group.frequency);
  }
  /// Of the group of a body [rad/s], as at the last update; that of its own modes, its frame held, where a body of the
  /// group has motions without stiffness; 0 where it has no frequency.
  [[nodiscard]] double of(std::size_t body) const {
    return groups_[static_cast<std::size_t>(group_of_[body])].frequency;
  }

 private:
  struct Stiffness {
    Eigen::MatrixXd stiffness, flexibility;
    Eigen::VectorXd first_mode;
    double frequency = 0;  ///< of that [rad/s]; 0: it has none
    bool stiff = false;    ///< there is an inverse
  };
  struct Part {
    std::size_t speed;                       ///< first of the body's modes among the speeds
    std::shared_ptr<const Stiffness> modal;  ///< equal bodies share it
  };
  struct Group {
    std::vector<Part> parts;
    double frequency = 0;
    bool stiff = true;  ///< every part has an inverse
  };
  static Stiffness stiffness_of(const ModalShape& shape);
  void iterate(std::span<const double> y, Work& work);

  const EquationsOfMotion& equations_;
  std::vector<int> group_of_;  ///< of each body; −1 where it is rigid
  std::vector<Group> groups_;
  std::vector<double> shape_, product_;  ///< over all speeds; zero on those of hinges
  Eigen::VectorXd q_;
  bool begun_ = false;
};

}  // namespace withy
