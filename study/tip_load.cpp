#include "withy/study/tip_load.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "withy/core/tree/rigid_inertia.hpp"
#include "withy/scene/units.hpp"

namespace withy::study {
namespace {

/// Of the body's length: a section that is nearer to the tip is the tip.
constexpr double at_the_tip = 1e-9;
/// Of the greatest inertia of a load: what is less is what rounding leaves of a direction that a hinge frees.
constexpr double least_part = 1e-12;

Matrix6 matrix(const RigidInertia& I) {
  Matrix6 m;
  m.topLeftCorner<3, 3>() = I.inertia;
  m.topRightCorner<3, 3>() = skew(I.moment);
  m.bottomLeftCorner<3, 3>() = -skew(I.moment);
  m.bottomRightCorner<3, 3>() = I.mass * Matrix3::Identity();
  return m;
}

/// An inertia that is given in B, in the axes of A and about its origin.
Matrix6 seen_from(const Pose& AB, const Matrix6& I) {
  Matrix6 twist;  // of B, from that of A
  twist << AB.R.transpose(), Matrix3::Zero(), -AB.R.transpose() * skew(AB.p), AB.R.transpose();
  return twist.transpose() * I * twist;
}

/// What is left of an inertia where a hinge gives way, whose drive has an inertia of its own in each rate.
Matrix6 through(const Matrix6& I, const Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6>& H, double reflected) {
  const Eigen::MatrixXd IH = I * H;
  Eigen::MatrixXd resisting = H.transpose() * IH;
  resisting.diagonal().array() += reflected;
  // Not inverted: what is free may have no inertia.
  const Eigen::MatrixXd solved = resisting.completeOrthogonalDecomposition().solve(IH.transpose());
  return I - IH * solved;
}

/// To six digits: functions need no more, and people read them.
double rounded(double x) { return to_digits(x, 6); }

/// A load in one direction of bending: of a rigid body the mass, mass times offset, and inertia about the tip.
struct RigidLoad {
  double mass = 0, moment = 0, inertia = 0;
};

std::optional<RigidLoad> in_direction(const Matrix6& I, const std::string& strain) {
  if (strain == "bending_y") return RigidLoad{I(4, 4), I(2, 4), I(2, 2)};
  if (strain == "bending_z") return RigidLoad{I(5, 5), -I(1, 5), I(1, 1)};
  if (strain == "torsion") return RigidLoad{0, 0, I(0, 0)};
  if (strain == "extension") return RigidLoad{I(3, 3), 0, 0};
  if (strain == "shear_y") return RigidLoad{I(4, 4), 0, 0};
  if (strain == "shear_z") return RigidLoad{I(5, 5), 0, 0};
  return {};
}

}  // namespace

BodyMasses masses_of(const Model& model) {
  BodyMasses m{std::vector<double>(model.bodies().size()), std::vector<double>(model.bodies().size())};
  for (std::size_t b = model.bodies().size(); b-- > 0;) {
    m.own[b] = rigid_inertia(model.bodies()[b].body->shape()).mass;
    const int parent = model.hinges()[b].parent;
    if (parent >= 0) m.carried[static_cast<std::size_t>(parent)] += m.carried[b] + m.own[b];
  }
  return m;
}

std::vector<Matrix6> tip_loads(const Model& model, const State& state) {
  const auto& bodies = model.bodies();
  const auto& hinges = model.hinges();
  std::vector<Matrix6> loads(bodies.size(), Matrix6::Zero()), articulated(bodies.size(), Matrix6::Zero());
  for (std::size_t b = bodies.size(); b-- > 0;) {
    articulated[b] += matrix(rigid_inertia(bodies[b].body->shape()));
    const HingeNode& hinge = hinges[b];
    if (hinge.parent < 0) continue;
    const Slot& slot = model.layout().hinges[b];
    const std::span<const double> y = state.y;
    HingeMotion motion;
    motion.H.resize(6, static_cast<Eigen::Index>(slot.speeds));
    const std::vector<double> still(slot.speeds, 0.0);
    hinge.hinge->motion(y.subspan(slot.position, slot.positions), still, motion);
    const Frame& own = bodies[b].frames[static_cast<std::size_t>(hinge.child_frame)];
    const Pose M = Pose{Matrix3::Identity(), own.section.X} * own.pose;
    Matrix6 seen = seen_from(M.inverse(), articulated[b]);
    if (slot.speeds > 0 && !model.driven(b)) seen = through(seen, motion.H, hinge.reflected_inertia);
    const auto parent = static_cast<std::size_t>(hinge.parent);
    const Frame& carrying = bodies[parent].frames[static_cast<std::size_t>(hinge.parent_frame)];
    seen = seen_from(carrying.pose * hinge.offset * motion.pose, seen);
    const auto tip = bodies[parent].body->station("tip");
    if (tip && (tip->X - carrying.section.X).norm() <= at_the_tip * tip->X.norm()) loads[parent] += seen;
    articulated[parent] += seen_from({Matrix3::Identity(), carrying.section.X}, seen);
  }
  return loads;
}

std::optional<Value> loaded_family(const Matrix6& I, const std::string& strain, const std::string& family,
                                   bool varies) {
  std::optional<RigidLoad> load = in_direction(I, strain);
  if (!load) return {};
  const double least_mass = least_part * I.bottomRightCorner<3, 3>().diagonal().maxCoeff(),
               least_inertia = least_part * I.topLeftCorner<3, 3>().diagonal().maxCoeff();
  const bool mass = load->mass > least_mass;
  // A centre of mass at the tip is off it by rounding.
  const bool beyond = mass && std::abs(load->moment) > std::sqrt(least_mass * least_inertia);
  const double offset = beyond ? load->moment / load->mass : 0, central = load->inertia - load->moment * offset;
  const bool inertia = central > least_inertia;
  if (!mass && !inertia) return Value(varies && family == vibration_modes ? family : std::string("clamped-free"));
  std::vector<Value::Member> members{{"name", Value(family)},
                                     {"tip_mass", Value(mass ? rounded(load->mass) : 0.0)},
                                     {"tip_inertia", Value(inertia ? rounded(central) : 0.0)},
                                     {"tip_offset", Value(rounded(offset) + 0.0)}};  // no -0
  if (family == vibration_modes) members.emplace_back("static", Value(1.0));
  return Value::map(std::move(members));
}

}  // namespace withy::study
