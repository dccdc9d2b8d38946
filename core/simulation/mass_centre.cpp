#include "withy/core/simulation/mass_centre.hpp"

#include <algorithm>

#include "withy/core/model/hinge_rates.hpp"

namespace withy {

MassCentre::MassCentre(const Model& model, const EquationsOfMotion& equations, std::span<const double> y)
    : seen_(equations.make_observation()),
      positions_(model.layout().positions),
      speeds_(model.layout().speeds),
      y_(equations.size()) {
  stop(y);
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const HingeNode& hinge = model.hinges()[h];
    if (hinge.parent >= 0) continue;
    Root root{hinge.child, hinge.child_frame, {}, 0};
    std::size_t speed = positions_ + model.layout().hinges[h].speed, found = 0;
    for (const HingeRate& rate : hinge_rates(*hinge.hinge)) {
      if (rate.angular) {
        root.angular.at(found++) = speed;
      } else {
        root.mass = 2 * with_speed(speed).kinetic;
      }
      ++speed;
    }
    mass_ += root.mass;
    roots_.push_back(root);
  }
}

void MassCentre::stop(std::span<const double> y) {
  std::copy(y.begin(), y.end(), y_.begin());
  std::fill_n(y_.begin() + static_cast<std::ptrdiff_t>(positions_), speeds_, 0.0);
}

Energies MassCentre::with_speed(std::size_t at) {
  y_[at] = 1;
  seen_->observe(y_);
  y_[at] = 0;
  return seen_->energies();
}

// A tree that turns by ω about the origin of its root's moving side, and does nothing else, has P = ω × m d and
// T = ½ ωᵀ I ω. Over three orthogonal unit vectors Σ ω × (ω × d) = −2 d and Σ ωᵀ I ω = 2 Σ m |r|².
MassCentre::Place MassCentre::at(std::span<const double> y) {
  stop(y);
  Place place;
  std::vector<Vector3> centres;
  double about_roots = 0;
  for (const Root& root : roots_) {
    Vector3 moment = Vector3::Zero(), origin = Vector3::Zero();
    double inertia = 0;
    for (const std::size_t speed : root.angular) {
      const Energies e = with_speed(speed);
      const Vector3 omega = vector(seen_->frame_velocity(root.body, root.frame).angular);
      moment -= 0.5 * omega.cross(vector(e.linear_momentum));
      inertia += e.kinetic;
      origin = vector(seen_->frame_pose(root.body, root.frame).position);
    }
    const Vector3 away = root.mass > 0 ? Vector3(moment / root.mass) : Vector3(Vector3::Zero());
    about_roots += inertia - root.mass * away.squaredNorm();
    centres.emplace_back(origin + away);
  }
  if (!(mass_ > 0)) return place;
  for (std::size_t k = 0; k < roots_.size(); ++k) place.position += roots_[k].mass / mass_ * centres[k];
  place.inertia = about_roots;
  for (std::size_t k = 0; k < roots_.size(); ++k)
    place.inertia += roots_[k].mass * (centres[k] - place.position).squaredNorm();
  return place;
}

}  // namespace withy
