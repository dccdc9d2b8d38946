// Whether a hinge moves as it says: its kernel, H, bias and their derivatives against differences of its poses.
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <vector>

#include "withy/core/model/validate.hpp"
#include "withy/core/plugin/false_slope.hpp"

namespace withy {
namespace {

using Numbers = std::vector<double>;

constexpr double hinge_step = 1e-2;       ///< the longest of those of differences, in the unit of coordinates
constexpr double motion_rounding = 1e-8;  // [1/rad, m/rad, 1/m, 1], of differences of numbers of size one
/// From the reference along rates of about one, to either side: at the first two it is looked at; where the hinge
/// cannot be there, nearer. Round numbers are where tables have their rows.
constexpr std::array<double, 6> looked_at = {0.0137, 0.0931, 1.37e-3, 1.37e-4, 1.37e-5, 1.37e-6};

using Twists = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// Rates that no two of are alike.
Numbers test_rates(std::size_t count) {
  constexpr std::array<double, 6> all = {1, -0.7, 0.5, -0.4, 0.8, -0.6};
  return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count)};
}

/// Coordinates that a displacement along rates leads to.
Numbers displaced(const Hinge& hinge, Numbers x, const Numbers& rates, double distance) {
  Numbers direction(x.size());
  hinge.derivatives(x, rates, direction);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += distance * direction[i];
  hinge.normalize(x);
  return x;
}

HingeMotion motion_at(const Hinge& hinge, const Numbers& x, const Numbers& rates) {
  HingeMotion m;
  m.H.resize(6, static_cast<Eigen::Index>(rates.size()));
  hinge.motion(x, rates, m);
  return m;
}

/// What of a motion is not finite; null: all is.
const char* unbounded_part(const HingeMotion& m) {
  if (!m.pose.R.allFinite() || !m.pose.p.allFinite()) return "pose";
  if (!m.H.allFinite()) return "H";
  return m.bias.allFinite() ? nullptr : "bias";
}

/// Of H, which a hinge finds with one column a rate and has to leave so.
std::string width_fault(const std::string& what, const HingeMotion& m, std::size_t speeds) {
  if (m.H.cols() == static_cast<Eigen::Index>(speeds)) return {};
  std::ostringstream text;
  text << what << " has " << m.H.cols() << " columns; need one a rate, " << speeds;
  return text.str();
}

/// Of a finite pose. What is computed takes the transpose of R for its inverse.
std::string rotation_fault(const Pose& pose) {
  std::ostringstream text;
  if (const double off = (pose.R.transpose() * pose.R - Matrix3::Identity()).norm(); !(off <= motion_rounding))
    text << "R of its pose is no rotation: R^T R is off the identity by " << off;
  else if (pose.R.determinant() < 0)
    text << "R of its pose is a reflection, of determinant -1";
  return text.str();
}

/// The angular and linear parts of twists, which have other units.
Eigen::MatrixXd parts_of(const Twists& twists) {
  return Eigen::Map<const Eigen::MatrixXd>(twists.data(), 3, 2 * twists.cols());
}

/// What changes by the twist of a pose, in the axes that it has here.
Vector6 place_from(const Pose& here, const Pose& pose) {
  const Matrix3 turn = here.R.transpose() * pose.R;
  Vector6 place;
  place << (turn(2, 1) - turn(1, 2)) / 2, (turn(0, 2) - turn(2, 0)) / 2, (turn(1, 0) - turn(0, 1)) / 2,
      here.R.transpose() * pose.p;
  return place;
}

std::string difference(const std::string& what, const Vector6& said, const Vector6& found) {
  std::ostringstream text;
  const Eigen::IOFormat row(4, Eigen::DontAlignCols, " ", " ");
  text << what << " is (" << said.transpose().format(row) << ") in the axes of M, angular first; differences of "
       << "what it moves by give (" << found.transpose().format(row) << ")";
  return text.str();
}

/// Compares what is said to be the derivatives of twists, by names, with respect to a displacement along rates from x.
template <class Name, class TwistsAt>
std::string twist_fault(const Hinge& hinge, const Numbers& x, const Numbers& along, const Twists& said, Name&& name,
                        TwistsAt&& twists_at) {
  double place = 0;
  for (const double number : x) place = std::max(place, std::abs(number));
  const Eigen::MatrixXd parts = parts_of(said);
  const auto wrong = false_slope(
      {parts, parts.colwise().norm(), Eigen::RowVectorXd::Constant(parts.cols(), motion_rounding)},
      [&](double s) { return parts_of(twists_at(displaced(hinge, x, along, s))); }, hinge_step, place);
  if (!wrong) return {};
  const Eigen::Index column = wrong->column / 2;
  Vector6 found;
  found << wrong->found.col(2 * column), wrong->found.col(2 * column + 1);
  return difference(name(column), said.col(column), found);
}

/// Whether all numbers are, where there are none too.
bool are_same(const Twists& a, const Twists& b) {
  return (a.array() == b.array() || (a.array().isNaN() && b.array().isNaN())).all();
}

/// Of the derivatives that a hinge gives along one rate, at a place where its motion is finite. Those of Hinge itself
/// are not compared: what is not smooth over their steps is no fault of the hinge.
std::string derivative_fault_along(const Hinge& hinge, const Numbers& x, const Numbers& rates, std::size_t along) {
  const auto speeds = static_cast<Eigen::Index>(rates.size());
  HingeMotion said, by_default;
  said.H.resize(6, speeds), by_default.H.resize(6, speeds);
  hinge.motion_derivative(x, rates, along, said);
  const std::string name = "the derivative of H along rate " + std::to_string(along + 1);
  if (std::string fault = width_fault(name, said, rates.size()); !fault.empty()) return fault;
  hinge.Hinge::motion_derivative(x, rates, along, by_default);
  if (are_same(said.H, by_default.H) && are_same(said.bias, by_default.bias)) return {};
  Numbers unit(rates.size(), 0.0);
  unit[along] = 1;
  const auto twists = [](const HingeMotion& m) {
    Twists all(6, m.H.cols() + 1);
    all << m.H, m.bias;
    return all;
  };
  const auto named = [&](Eigen::Index i) {
    if (i < speeds) return name + ", column " + std::to_string(i + 1) + ",";
    return "the derivative of the bias along rate " + std::to_string(along + 1);
  };
  return twist_fault(hinge, x, unit, twists(said), named,
                     [&](const Numbers& at) { return twists(motion_at(hinge, at, rates)); });
}

std::string derivative_fault(const Hinge& hinge, const Numbers& x, const Numbers& rates) {
  for (std::size_t along = 0; along < rates.size(); ++along)
    if (std::string fault = derivative_fault_along(hinge, x, rates, along); !fault.empty()) return fault;
  return {};
}

/// Of a place where the motion is finite.
std::string rates_fault(const Hinge& hinge, const Numbers& x, const Numbers& rates) {
  const HingeMotion here = motion_at(hinge, x, rates);
  for (std::size_t i = 0; i < rates.size(); ++i) {
    Numbers unit(rates.size(), 0.0);
    unit[i] = 1;
    const std::string fault = twist_fault(
        hinge, x, unit, here.H.col(static_cast<Eigen::Index>(i)),
        [&](Eigen::Index) { return "column " + std::to_string(i + 1) + " of H"; },
        [&](const Numbers& at) -> Twists { return place_from(here.pose, motion_at(hinge, at, rates).pose); });
    if (!fault.empty()) return fault;
  }
  const Eigen::Map<const Eigen::VectorXd> u(rates.data(), static_cast<Eigen::Index>(rates.size()));
  return twist_fault(
      hinge, x, rates, here.bias, [](Eigen::Index) { return std::string("the bias"); },
      [&](const Numbers& at) -> Twists { return motion_at(hinge, at, rates).H * u; });
}

struct KernelSizes {
  std::size_t coordinates, speeds;
};

KernelSizes sizes_of(HingeKernel::Kind kind) {
  switch (kind) {
    case HingeKernel::Kind::weld:
      return {0, 0};
    case HingeKernel::Kind::spherical:
      return {4, 3};
    case HingeKernel::Kind::free:
      return {7, 6};
    default:
      return {1, 1};
  }
}

Pose kernel_pose(const HingeKernel& kernel, const Numbers& x) {
  Pose pose;
  switch (kernel.kind) {
    case HingeKernel::Kind::weld:
      break;
    case HingeKernel::Kind::revolute:
      pose.R = Eigen::AngleAxisd(x[0], kernel.axis).toRotationMatrix();
      break;
    case HingeKernel::Kind::prismatic:
      pose.p = kernel.axis * x[0];
      break;
    case HingeKernel::Kind::free:
      pose.p = Vector3(x[4], x[5], x[6]);
      [[fallthrough]];
    case HingeKernel::Kind::spherical:
      pose.R = rotation_from_quaternion(x[0], x[1], x[2], x[3]);
  }
  return pose;
}

std::string kernel_size_fault(const Hinge& hinge, const HingeKernel& kernel) {
  const KernelSizes sizes = sizes_of(kernel.kind);
  if (sizes.coordinates == hinge.coordinates() && sizes.speeds == hinge.speeds()) return {};
  std::ostringstream text;
  text << "it has " << hinge.coordinates() << " coordinates and " << hinge.speeds()
       << " rates, the kernel that it says it is has " << sizes.coordinates << " and " << sizes.speeds;
  return text.str();
}

std::string kernel_fault(const Hinge& hinge, const HingeKernel& kernel, const Numbers& x, const Numbers& rates) {
  const Pose own = motion_at(hinge, x, rates).pose, said = kernel_pose(kernel, x);
  const double apart = (own.R - said.R).norm() + (own.p - said.p).norm();
  return apart <= motion_rounding ? std::string() : "it does not move as the kernel that it says it is";
}

/// Where there are as many, rates are the derivatives of coordinates, one by one: what the engine copies, and a load or
/// a limit on one of them takes for its rate.
std::string derivatives_fault(const Hinge& hinge, const Numbers& x, const Numbers& rates) {
  if (x.size() != rates.size()) return {};
  Numbers derivatives(x.size());
  hinge.derivatives(x, rates, derivatives);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::abs(derivatives[i] - rates[i]) <= motion_rounding) continue;
    std::ostringstream text;
    text << "it has as many rates as coordinates, and the derivative of coordinate " << i + 1 << " is "
         << derivatives[i] << " where rate " << i + 1 << " is " << rates[i]
         << "; need rates that are the derivatives, or more coordinates, as a quaternion has";
    return text.str();
  }
  return {};
}

std::string reference_fault(const Numbers& reference) {
  for (std::size_t i = 0; i < reference.size(); ++i) {
    if (std::isfinite(reference[i])) continue;
    std::ostringstream text;
    text << "coordinate " << i + 1 << " of its reference is " << reference[i];
    return text.str();
  }
  return {};
}

/// At a place where the motion is finite.
std::string place_fault(const Hinge& hinge, const std::optional<HingeKernel>& kernel, const Numbers& x,
                        const Numbers& rates) {
  if (std::string fault = rotation_fault(motion_at(hinge, x, rates).pose); !fault.empty()) return fault;
  if (kernel)
    if (std::string fault = kernel_fault(hinge, *kernel, x, rates); !fault.empty()) return fault;
  if (std::string fault = rates_fault(hinge, x, rates); !fault.empty()) return fault;
  return derivative_fault(hinge, x, rates);
}

/// At one place or, where it cannot be there, at the one opposite. \param unbounded null where it can be at one
std::string fault_beside(const Hinge& hinge, const std::optional<HingeKernel>& kernel, const Numbers& reference,
                         double distance, const char*& unbounded) {
  const Numbers rates = test_rates(hinge.speeds());
  for (const double side : {distance, -distance}) {
    const Numbers x = displaced(hinge, reference, rates, side);
    if (std::string fault = derivatives_fault(hinge, x, rates); !fault.empty()) return fault;
    const HingeMotion here = motion_at(hinge, x, rates);
    if (std::string fault = width_fault("H", here, rates.size()); !fault.empty()) return fault;
    unbounded = unbounded_part(here);
    if (unbounded == nullptr) return place_fault(hinge, kernel, x, rates);
  }
  return {};
}

/// Beside the reference, where columns may vanish that do not elsewhere.
std::string motion_fault(const Hinge& hinge, const std::optional<HingeKernel>& kernel, const Numbers& reference) {
  const char* first_unbounded = nullptr;
  bool met = false;
  for (std::size_t k = 0; k < looked_at.size() && !(met && k >= 2); ++k) {
    const char* unbounded = nullptr;
    if (std::string fault = fault_beside(hinge, kernel, reference, looked_at[k], unbounded); !fault.empty())
      return fault;
    met = met || unbounded == nullptr;
    if (first_unbounded == nullptr) first_unbounded = unbounded;
  }
  return met ? std::string() : std::string("its ") + first_unbounded + " is not finite near its reference";
}

}  // namespace

std::string find_fault(const Hinge& hinge) {
  constexpr std::size_t most_speeds = 6;
  const std::size_t coordinates = hinge.coordinates(), speeds = hinge.speeds();
  if (speeds > most_speeds || coordinates < speeds) {
    std::ostringstream text;
    text << "it has " << coordinates << " coordinates and " << speeds
         << " rates; need at most 6 rates, and as many coordinates or more";
    return text.str();
  }
  const std::optional<HingeKernel> kernel = hinge.kernel();
  if (kernel)
    if (std::string fault = kernel_size_fault(hinge, *kernel); !fault.empty()) return fault;
  Numbers reference(coordinates);
  hinge.reference(reference);
  if (std::string fault = reference_fault(reference); !fault.empty()) return fault;
  return motion_fault(hinge, kernel, reference);
}

}  // namespace withy
