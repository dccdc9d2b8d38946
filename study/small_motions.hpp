/// \file
/// Small motions about a configuration as a linear system that can be displaced, pushed and looked at.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "withy/core/analysis/adaptive_difference.hpp"
#include "withy/core/simulation/sensor_reader.hpp"
#include "withy/study/configuration.hpp"

namespace withy::study {

/// ż = A z + B τ about a configuration: z are displacements δ of the free speeds, their rates, then the continuous
/// states of loads; τ are efforts on all speeds beside those of the scene's loads. The model has, beside the scene's
/// loads, one that pushes any speed, and motions in the place of what is held, so that accelerations and reactions are
/// those of what is free.
class SmallMotions {
 public:
  /// \param command load (index in Model::loads()) whose command can be displaced; none: of no load
  /// \throws InputError where one rate of several of a hinge is held and `sensors` are to be read; std::domain_error
  /// where the mass matrix of what is free is singular.
  SmallMotions(const Configuration& configuration, std::vector<SensorNode> sensors,
               std::optional<std::size_t> command = {});

  [[nodiscard]] const Model& model() const { return *model_; }
  [[nodiscard]] const EquationsOfMotion& equations() const { return *equations_; }
  /// That of the configuration, with what sampled loads tell as of a sample at it.
  [[nodiscard]] const State& state() const { return state_; }
  [[nodiscard]] Eigen::Index size() const { return A_.rows(); }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] const Eigen::MatrixXd& A() const { return A_; }
  [[nodiscard]] const Eigen::MatrixXd& by_effort() const { return by_effort_; }          ///< size × speeds
  [[nodiscard]] const Eigen::VectorXd& accelerations() const { return accelerations_; }  ///< of all speeds
  /// Speeds that are not held.
  [[nodiscard]] const std::vector<Eigen::Index>& free() const { return free_; }
  /// Speeds that are held while others of their hinge are not: in states that are looked at they accelerate freely.
  [[nodiscard]] const std::vector<Eigen::Index>& held_alone() const { return held_alone_; }
  /// How A was found.
  [[nodiscard]] const std::string& derivatives() const { return derivatives_; }

  /// The state with z_i = h.
  [[nodiscard]] State displaced(Eigen::Index i, double h) const;
  /// A step of z_i over which anything changes little: 0.01 rad, a hundredth or (modes) a thousandth of the longest
  /// body; of a load's state a hundredth of it, or of one.
  [[nodiscard]] double step(Eigen::Index i) const;
  /// The greatest number of the state that z_i is added to.
  [[nodiscard]] double place(Eigen::Index i) const;
  /// A step of what makes these efforts over which anything changes little.
  [[nodiscard]] double step(const Eigen::VectorXd& efforts) const;
  /// The state with efforts [N m, N] on all speeds.
  [[nodiscard]] State pushed(const Eigen::VectorXd& efforts) const;
  /// The state in which loads that measure the command measure so much more.
  [[nodiscard]] State commanded(double more) const;
  /// ż but for the displacements, whose rates are the speeds: of a state with held rates that are none of held_alone.
  /// \throws std::domain_error where it is not finite
  [[nodiscard]] Eigen::VectorXd moved(const State& state) const;
  /// Efforts [N m, N] of a load (index in Model::loads()) on all speeds.
  [[nodiscard]] Eigen::VectorXd efforts(const State& state, std::size_t load) const;
  /// Those of all loads together.
  [[nodiscard]] Eigen::VectorXd efforts(const State& state) const;
  /// Rates of the continuous states of loads, accelerations being those of the configuration.
  [[nodiscard]] Eigen::VectorXd rates(const State& state) const;
  /// What the sensors show. \throws std::domain_error where accelerations are not finite
  [[nodiscard]] Eigen::VectorXd sensed(const State& state);
  [[nodiscard]] const std::vector<Column>& columns() const { return reader_->columns(); }

 private:
  void hold(const Configuration& c, Model& model, bool needed);
  void find_steps(const Configuration& c);

  std::shared_ptr<const Model> model_;
  std::shared_ptr<const EquationsOfMotion> equations_;
  std::unique_ptr<SensorReader> reader_;
  const TangentDynamics& dynamics_;
  mutable Work work_;
  State state_;
  std::size_t push_ = 0;  ///< first of the discrete states that push; the last of them displaces the command
  std::vector<Eigen::Index> free_, held_alone_;
  std::vector<std::string> names_;
  std::vector<double> steps_;
  Eigen::MatrixXd A_, by_effort_;
  Eigen::VectorXd accelerations_;
  std::string derivatives_;
};

}  // namespace withy::study
