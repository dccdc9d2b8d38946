#include "withy/core/tangents/load_wrenches.hpp"

#include "withy/core/plugin/central_difference.hpp"

namespace withy::analysis {

std::vector<AppliedWrench<double>> wrenches_of(const LoadNode& load, const Model& model, double t,
                                               std::span<const double> y, const std::vector<FrameState<double>>& frames,
                                               bool& /*depends*/) {
  std::vector<FrameMotion> motions;
  for (const FrameState<double>& f : frames) motions.push_back({f.R, f.p, f.w, f.v});
  std::vector<Wrench> values(frames.size());
  std::vector<double> scratch(model.load_scratch());
  load.wrenches(t, y, model.layout(), motions, values, scratch);
  std::vector<AppliedWrench<double>> result;
  for (std::size_t k = 0; k < frames.size(); ++k)
    result.push_back({load.load->frames()[k], values[k].moment, values[k].force});
  return result;
}

std::vector<AppliedWrench<Jet>> wrenches_of(const LoadNode& load, const Model& model, double t,
                                            std::span<const double> y, const std::vector<FrameState<Jet>>& frames,
                                            bool& depends) {
  const auto value = [](const Jet& x) { return x.value(); };
  std::vector<FrameMotion> motions;
  for (const FrameState<Jet>& f : frames)
    motions.push_back({f.R.unaryExpr(value), f.p.unaryExpr(value), f.w.unaryExpr(value), f.v.unaryExpr(value)});
  std::vector<double> scratch(model.load_scratch());
  const auto wrenches_at = [&](const std::vector<FrameMotion>& at) {
    std::vector<Wrench> values(at.size());
    load.wrenches(t, y, model.layout(), at, values, scratch);
    Eigen::Matrix<double, 6, Eigen::Dynamic> all(6, static_cast<Eigen::Index>(at.size()));
    for (std::size_t k = 0; k < at.size(); ++k)
      all.col(static_cast<Eigen::Index>(k)) << values[k].moment, values[k].force;
    return all;
  };
  const Eigen::Matrix<double, 6, Eigen::Dynamic> here = wrenches_at(motions);
  Eigen::Matrix<Jet, 6, Eigen::Dynamic> all = here.cast<Jet>();
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const FrameMotion& m = motions[k];
    for (int part = 0; part < 4; ++part) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        // The change of this element along each direction; a turn is Ṙ Rᵀ, whose axial vector it is.
        JetDerivatives change;
        if (part == 0) {
          const Eigen::Index i = (axis + 1) % 3, j = (axis + 2) % 3;
          change.setZero();
          for (Eigen::Index c = 0; c < 3; ++c) change += derivatives_of(frames[k].R(j, c)) * m.R(i, c);
        } else {
          const auto& x = part == 1 ? frames[k].p : part == 2 ? frames[k].w : frames[k].v;
          change = derivatives_of(x[axis]);
        }
        if (change.isZero(0)) continue;
        const Eigen::Matrix<double, 6, Eigen::Dynamic> slope = central_difference(
            [&](double h) {
              std::vector<FrameMotion> moved = motions;
              const Vector3 step = h * Vector3::Unit(axis);
              if (part == 0) moved[k].R = Eigen::AngleAxisd(h, Vector3::Unit(axis)) * m.R;
              if (part == 1) moved[k].position += step;
              if (part == 2) moved[k].angular_velocity += step;
              if (part == 3) moved[k].velocity += step;
              return wrenches_at(moved);
            },
            difference_step);
        if (slope.isZero(0)) continue;
        depends = true;
        for (Eigen::Index e = 0; e < slope.size(); ++e) derivatives_of(all(e)) += slope(e) * change;
      }
    }
  }
  std::vector<AppliedWrench<Jet>> result;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const auto column = all.col(static_cast<Eigen::Index>(k));
    result.push_back({load.load->frames()[k], column.head<3>(), column.tail<3>()});
  }
  return result;
}

}  // namespace withy::analysis
