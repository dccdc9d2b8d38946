#include "withy/core/sweep/rod/rotary_table.hpp"

#include <Eigen/Eigenvalues>

namespace withy::sweep {

template <class Space>
RotaryTable<Space>::RotaryTable(const NodeSpec& node) : frame(node) {
  constexpr std::size_t A = Space::angular;
  const auto n = static_cast<Eigen::Index>(node.modes);
  const auto angle = [](const Vector3& v, std::size_t c) { return v[A == 1 ? 2 : static_cast<Eigen::Index>(c)]; };
  std::vector<const Section*> turning;
  const std::vector<Section> all = frame.mass(node).sections();
  for (const Section& s : all) {
    if (A == 1 ? s.inertia(2, 2) != 0 : !s.inertia.isZero(0)) turning.push_back(&s);
  }
  sections = turning.size();
  packs = (sections + lanes - 1) / lanes;
  if (packs == 0) return;
  const auto modes = static_cast<std::size_t>(n);
  Eigen::MatrixXd second(turning.size(), A * (modes * (modes + 1) / 2));
  for (std::size_t s = 0; s < sections; ++s) {
    for (Eigen::Index i = 0, column = 0; i < n; ++i)
      for (Eigen::Index j = i; j < n; ++j)
        for (std::size_t c = 0; c < A; ++c)
          second(static_cast<Eigen::Index>(s), column++) = turning[s]->at.theta[A == 1 ? 2 : c](i, j);
  }
  runs = runs_of<static_cast<int>(A)>(second, static_cast<int>(n));
  stride = A * modes;
  for (const FieldRun& run : runs) stride += static_cast<std::size_t>(run.last - run.first);
  std::vector<Pack> angles(packs * stride, spread(0.0));
  // Principal axes, those with inertia first.
  std::vector<Eigen::SelfAdjointEigenSolver<Matrix3>> principal;
  for (const Section* s : turning) {
    principal.emplace_back(s->inertia);
    const auto with_inertia = static_cast<std::size_t>((principal.back().eigenvalues().array() != 0).count());
    axes_each = std::max(axes_each, A == 1 ? 1 : with_inertia);
  }
  std::vector<Axis> principal_axes(packs * axes_each, Axis{spread(0.0), {spread(0.0), spread(0.0), spread(0.0)}});
  for (std::size_t s = 0; s < sections; ++s) {
    const std::size_t pack = s / lanes, lane = s % lanes;
    Axis* axis = principal_axes.data() + pack * axes_each;
    if (A == 1) {
      set_lane(axis->J, lane, turning[s]->inertia(2, 2));
    } else {
      for (Eigen::Index k = 3; k-- > 0;) {
        const double J = principal[s].eigenvalues()[k];
        if (J == 0) continue;
        set_lane(axis->J, lane, J);
        for (std::size_t c = 0; c < 3; ++c)
          set_lane(axis->e[c], lane, principal[s].eigenvectors()(static_cast<Eigen::Index>(c), k));
        ++axis;
      }
    }
    Pack* field = angles.data() + pack * stride;
    const PointExpansion& at = turning[s]->at;
    for (Eigen::Index i = 0; i < n; ++i) {
      for (std::size_t c = 0; c < A; ++c) set_lane(*field++, lane, angle(at.psi.col(i), c));
    }
    for (const FieldRun& run : runs) {
      for (int j = run.first; j < run.last; ++j) {
        const auto column =
            static_cast<Eigen::Index>(static_cast<int>(A) * pair_at(run.row, j, static_cast<int>(n)) + run.component);
        set_lane(*field++, lane, second(static_cast<Eigen::Index>(s), column));
      }
    }
  }
  axes = std::move(principal_axes);
  fields = std::move(angles);
}

template struct RotaryTable<Spatial>;
template struct RotaryTable<Planar>;

}  // namespace withy::sweep
