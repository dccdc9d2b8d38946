#include "beam_fields.hpp"

#include <algorithm>
#include <cstring>
#include <mutex>
#include <span>
#include <utility>

namespace withy {
namespace {

/// Fields of the beams that were made last, of any thread, by all that they depend on: a beam that varies in stiffness
/// or mass alone, from case to case of a sweep, is not integrated again.
class LastFields {
 public:
  template <class Make>
  NodeFields of(std::vector<double> key, std::size_t pairs, Make&& make) {
    constexpr std::size_t kept = 8, most_numbers = 1 << 15;
    if (key.size() + pairs > most_numbers) return make();
    const std::lock_guard lock(mutex_);
    const auto same = [&](const std::vector<double>& other) {
      return other.size() == key.size() && std::memcmp(other.data(), key.data(), key.size() * sizeof(double)) == 0;
    };
    auto found = std::find_if(last_.begin(), last_.end(), [&](const auto& entry) { return same(entry.first); });
    if (found == last_.end()) {
      if (last_.size() == kept) last_.pop_back();
      last_.emplace_back(std::move(key), make());
      found = last_.end() - 1;
      constexpr std::size_t most_of_points = 1 << 12;  // at most some MB wait for their next use
      if (pairs <= most_of_points) found->second.points = std::make_shared<SparePoints>();
    }
    std::rotate(last_.begin(), found, found + 1);
    return last_.front().second;
  }

 private:
  std::mutex mutex_;
  std::vector<std::pair<std::vector<double>, NodeFields>> last_;  ///< the youngest first
};

Eigen::Index modes_of(const std::vector<BeamStrain>& strains) {
  std::size_t count = 0;
  for (const BeamStrain& s : strains) count += s.functions->count();
  return static_cast<Eigen::Index>(count);
}

/// All that the fields at the nodes depend on: the panels, where their nodes are; of each strain its kind and axis, and
/// its functions.
std::vector<double> key_of_fields(const std::vector<BeamStrain>& strains, double length,
                                  const BeamQuadrature& quadrature) {
  std::vector<double> key = quadrature.nodes();
  key.push_back(length);
  key.push_back(static_cast<double>(quadrature.panels()));
  for (const BeamStrain& s : strains) {
    const std::size_t count = s.functions->count(), first = key.size() + 5;
    key.insert(key.end(), {static_cast<double>(s.kind), s.direction.x(), s.direction.y(), s.direction.z(),
                           static_cast<double>(count)});
    key.resize(first + 3 * count * quadrature.nodes().size());
    std::span<double> rest = std::span(key).subspan(first);
    for (const double x : quadrature.nodes()) {
      s.functions->evaluate(x, rest.first(count), rest.subspan(count, count), rest.subspan(2 * count, count));
      rest = rest.subspan(3 * count);
    }
  }
  return key;
}

/// Θ and Γ at the nodes by running integrals; a row holds the upper triangles of the three components.
SecondFields integrated(const BeamQuadrature& quadrature, const StrainKinematics& kinematics,
                        const std::vector<LinearFields>& linear) {
  SecondFields at;
  const Eigen::Index n = linear.front().phi.cols();
  const Eigen::Index pairs = n * (n + 1) / 2;
  const auto nodes = static_cast<Eigen::Index>(quadrature.nodes().size());
  at.theta_slope.resize(nodes, 3 * pairs);
  at.gamma_slope.resize(nodes, 3 * pairs);
  const auto each_pair = [&](auto&& action) {
    Eigen::Index column = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = i; j < n; ++j, column += 3) action(i, j, column);
    }
  };
  for (Eigen::Index k = 0; k < nodes; ++k) {
    const LinearFields& f = linear[static_cast<std::size_t>(k)];
    each_pair([&](Eigen::Index i, Eigen::Index j, Eigen::Index column) {
      at.theta_slope.block<1, 3>(k, column) = kinematics.rotation_slope(f.field(i), f.field(j)).transpose();
    });
  }
  at.theta = quadrature.running_integral(at.theta_slope);
  for (Eigen::Index k = 0; k < nodes; ++k) {
    const LinearFields& f = linear[static_cast<std::size_t>(k)];
    each_pair([&](Eigen::Index i, Eigen::Index j, Eigen::Index column) {
      const Vector3 theta = at.theta.block<1, 3>(k, column).transpose();
      at.gamma_slope.block<1, 3>(k, column) = kinematics.displacement_slope(f.field(i), f.field(j), theta).transpose();
    });
  }
  at.gamma = quadrature.running_integral(at.gamma_slope);
  return at;
}

}  // namespace

LinearFields linear_fields(const std::vector<BeamStrain>& strains, double x) {
  const Eigen::Index n = modes_of(strains);
  LinearFields f{Matrix3X::Zero(3, n), Matrix3X::Zero(3, n), Matrix3X::Zero(3, n), Matrix3X::Zero(3, n)};
  Eigen::Index at = 0;
  for (const BeamStrain& s : strains) {
    const std::size_t count = s.functions->count();
    std::vector<double> value(count), slope(count), curvature(count);
    s.functions->evaluate(x, value, slope, curvature);
    for (std::size_t i = 0; i < count; ++i, ++at) {
      switch (s.kind) {
        case BeamData::Strain::bending:
          f.phi.col(at) = s.direction.cross(Vector3::UnitX()) * value[i];
          f.psi.col(at) = s.direction * slope[i];
          f.psi_slope.col(at) = s.direction * curvature[i];
          break;
        case BeamData::Strain::torsion:
          f.psi.col(at) = s.direction * value[i];
          f.psi_slope.col(at) = s.direction * slope[i];
          break;
        case BeamData::Strain::elongation:
          f.phi.col(at) = s.direction * value[i];
          f.gamma.col(at) = s.direction * slope[i];
          break;
      }
    }
  }
  return f;
}

std::vector<Particle> SparePoints::take() {
  const std::lock_guard lock(mutex_);
  if (spare_.empty()) return {};
  std::vector<Particle> points = std::move(spare_.back());
  spare_.pop_back();
  return points;
}

void SparePoints::give_back(std::vector<Particle>&& points) noexcept {
  const std::lock_guard lock(mutex_);
  if (spare_.size() < most) spare_.push_back(std::move(points));
}

NodeFields fields_at_nodes(const std::vector<BeamStrain>& strains, double length, const BeamQuadrature& quadrature,
                           const StrainKinematics& kinematics) {
  const auto make = [&]() -> NodeFields {
    std::vector<LinearFields> linear;
    linear.reserve(quadrature.nodes().size());
    for (const double x : quadrature.nodes()) linear.push_back(linear_fields(strains, x));
    auto pairs = std::make_shared<const SecondFields>(integrated(quadrature, kinematics, linear));
    return {std::make_shared<const std::vector<LinearFields>>(std::move(linear)), std::move(pairs)};
  };
  if (!kinematics.complete()) return make();
  static LastFields last;
  const auto modes = static_cast<std::size_t>(modes_of(strains));
  return last.of(key_of_fields(strains, length, quadrature), quadrature.nodes().size() * 6 * modes * (modes + 1), make);
}

PointExpansion expansion(double x, const LinearFields& f, const PairFields& gamma, const PairFields& theta) {
  const Eigen::Index n = f.phi.cols();
  PointExpansion e = PointExpansion::rigid(Vector3(x, 0, 0), n);
  e.phi = f.phi;
  e.psi = f.psi;
  Eigen::Index column = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = i; j < n; ++j) {
      for (std::size_t c = 0; c < 3; ++c, ++column) {
        e.gamma[c](i, j) = e.gamma[c](j, i) = gamma[column];
        e.theta[c](i, j) = e.theta[c](j, i) = theta[column];
      }
    }
  }
  return e;
}

}  // namespace withy
