// Whether a hinge moves as it says: its kernel, H, bias and their derivatives against differences of its poses.
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <vector>

#include "withy/core/model/validate.hpp"

namespace withy {
namespace {

using Numbers = std::vector<double>;

/// Differences of steps this long; smooth motions agree with one of them, whatever their size.
constexpr std::array<double, 4> difference_steps = {1e-2, 1e-3, 1e-4, 1e-5};
/// Of what a rate gives: far above the error of the best of these differences, far below a factor that is forgotten.
constexpr double motion_tolerance = 1e-4;
constexpr double motion_rounding = 1e-8;  // [1/rad, m/rad, 1/m, 1], of differences of numbers of size one

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

/// Angular and linear parts have other units.
bool agree(const Vector6& a, const Vector6& b) {
  const auto part = [&](Eigen::Index first) {
    const Vector3 left = a.segment<3>(first), right = b.segment<3>(first);
    return (left - right).norm() <= motion_tolerance * std::max(left.norm(), right.norm()) + motion_rounding;
  };
  return part(0) && part(3);
}

/// The twist between the poses at both ends of a difference, in the axes between them.
Vector6 twist_of(const Pose& behind, const Pose& here, const Pose& ahead, double distance) {
  const Matrix3 turn = here.R.transpose() * (ahead.R - behind.R) / (2 * distance);
  Vector6 twist;
  twist << (turn(2, 1) - turn(1, 2)) / 2, (turn(0, 2) - turn(2, 0)) / 2, (turn(1, 0) - turn(0, 1)) / 2,
      here.R.transpose() * (ahead.p - behind.p) / (2 * distance);
  return twist;
}

std::string difference(const std::string& what, const Vector6& said, const Vector6& found) {
  std::ostringstream text;
  const Eigen::IOFormat row(4, Eigen::DontAlignCols, " ", " ");
  text << what << " is (" << said.transpose().format(row) << ") in the axes of M, angular first; differences of "
       << "what it moves by give (" << found.transpose().format(row) << ")";
  return text.str();
}

/// Whether `said` is what some step finds; the finest where none does. Steps that lead to what is not finite say
/// nothing.
template <class Find>
std::string compared(const std::string& what, const Vector6& said, Find&& find) {
  Vector6 found = said;
  for (const double step : difference_steps) {
    const Vector6 now = find(step);
    if (!now.allFinite()) continue;
    if (agree(said, now)) return {};
    found = now;
  }
  return found == said ? std::string() : difference(what, said, found);
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
  if (said.H == by_default.H && said.bias == by_default.bias) return {};
  Numbers unit(rates.size(), 0.0);
  unit[along] = 1;
  const auto differences = [&](double step) {
    HingeMotion ahead = motion_at(hinge, displaced(hinge, x, unit, step), rates);
    const HingeMotion behind = motion_at(hinge, displaced(hinge, x, unit, -step), rates);
    ahead.H = (ahead.H - behind.H) / (2 * step);
    ahead.bias = (ahead.bias - behind.bias) / (2 * step);
    return ahead;
  };
  for (Eigen::Index i = 0; i < speeds; ++i) {
    const std::string fault = compared(name + ", column " + std::to_string(i + 1) + ",", said.H.col(i),
                                       [&](double step) -> Vector6 { return differences(step).H.col(i); });
    if (!fault.empty()) return fault;
  }
  return compared("the derivative of the bias along rate " + std::to_string(along + 1), said.bias,
                  [&](double step) { return differences(step).bias; });
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
    const std::string fault = compared(
        "column " + std::to_string(i + 1) + " of H", here.H.col(static_cast<Eigen::Index>(i)), [&](double step) {
          return twist_of(motion_at(hinge, displaced(hinge, x, unit, -step), rates).pose, here.pose,
                          motion_at(hinge, displaced(hinge, x, unit, step), rates).pose, step);
        });
    if (!fault.empty()) return fault;
  }
  const Eigen::Map<const Eigen::VectorXd> u(rates.data(), static_cast<Eigen::Index>(rates.size()));
  return compared("the bias", here.bias, [&](double step) -> Vector6 {
    return (motion_at(hinge, displaced(hinge, x, rates, step), rates).H * u -
            motion_at(hinge, displaced(hinge, x, rates, -step), rates).H * u) /
           (2 * step);
  });
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
  const Numbers rates = test_rates(speeds);
  // Beside the reference, where columns may vanish that do not elsewhere.
  const char* unbounded = nullptr;
  bool met = false;
  for (const double distance : {0.01, 0.1}) {
    const Numbers x = displaced(hinge, reference, rates, distance);
    if (std::string fault = derivatives_fault(hinge, x, rates); !fault.empty()) return fault;
    const HingeMotion here = motion_at(hinge, x, rates);
    if (std::string fault = width_fault("H", here, speeds); !fault.empty()) return fault;
    if (const char* part = unbounded_part(here); part != nullptr) {
      unbounded = part;  // it may be that it cannot be there
      continue;
    }
    met = true;
    if (std::string fault = place_fault(hinge, kernel, x, rates); !fault.empty()) return fault;
  }
  return met ? std::string() : std::string("its ") + unbounded + " is not finite near its reference";
}

}  // namespace withy
