#include "withy/core/simulation/felt_motion.hpp"

#include "withy/core/deformation/mass_points.hpp"

namespace withy {

std::vector<BodyMotion> felt_motions(const Model& model, const EquationsOfMotion& equations, const State& state,
                                     const std::vector<BodyMotion>& motions) {
  std::vector<BodyMotion> felt = motions;
  const auto seen = equations.make_observation();
  seen->observe(state.y);
  std::vector<double> outboard(felt.size(), 0.0);
  std::vector<Vector3> forces(felt.size(), Vector3::Zero());  // that fields exert on all that hangs on a hinge
  for (std::size_t b = felt.size(); b-- > 0;) {
    BodyMotion& B = felt[b];
    const WorldVelocity V = seen->frame_velocity(static_cast<int>(b), 0);
    const Vector3 field =
        field_acceleration(model, state.time, {B.R, B.p, B.rate, Vector3(V.linear[0], V.linear[1], V.linear[2])});
    B.acceleration -= field;
    forces[b] += (B.mass - outboard[b]) * field;
    B.force -= forces[b];
    if (const int parent = model.hinges()[b].parent; parent >= 0) {
      outboard[static_cast<std::size_t>(parent)] += B.mass;
      forces[static_cast<std::size_t>(parent)] += forces[b];
    }
  }
  return felt;
}

}  // namespace withy
