/// \file
/// Where the mass of a tree that floats freely is, and its momentum about that place.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"

namespace withy {

/// Finds it from what the observation of the equations says of trees that turn stiffly: any body tells so where its
/// mass is, however it bends. Of one thread.
class MassCentre {
 public:
  /// \param model whose hinges to the world are all free; the equations must outlive this
  /// \param y as State::y, anywhere
  MassCentre(const Model& model, const EquationsOfMotion& equations, std::span<const double> y);

  struct Place {
    Vector3 position = Vector3::Zero();  ///< c in the world [m]
    double inertia = 0;                  ///< Σ m |r − c|² [kg m²]
  };
  /// \param y as State::y
  Place at(std::span<const double> y);
  [[nodiscard]] double mass() const { return mass_; }  ///< [kg]

 private:
  /// A hinge to the world.
  struct Root {
    int body, frame;                     ///< of its side that moves
    std::array<std::size_t, 3> angular;  ///< places of its angular speeds in y
    double mass;                         ///< of all that it carries [kg]
  };
  void stop(std::span<const double> y);
  /// What is seen of the state of `stop` with one speed, of this place in y, equal to one.
  Energies with_speed(std::size_t at);

  std::unique_ptr<Observation> seen_;
  std::size_t positions_, speeds_;
  std::vector<Root> roots_;
  double mass_ = 0;
  std::vector<double> y_;  ///< nothing moves
};

inline Vector3 vector(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

/// Angular momentum about the mass centre at c, of motion relative to it: neither the origin of the world nor a
/// velocity that all have in common is in it [kg m²/s].
inline Vector3 spin(const Energies& e, const Vector3& c) {
  return vector(e.angular_momentum) - c.cross(vector(e.linear_momentum));
}

}  // namespace withy
