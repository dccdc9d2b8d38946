#include "withy/core/tangents/load_wrenches.hpp"

#include <cmath>

#include "withy/core/deformation/mass_points.hpp"
#include "withy/core/plugin/refined_difference.hpp"

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

namespace {

/// The change along each direction of an element of a frame's motion, `part` 0 to 3: a turn, the position, the angular
/// velocity, the velocity. A turn is Ṙ Rᵀ, whose axial vector it is.
JetDerivatives change_of(const FrameState<Jet>& frame, const FrameMotion& m, int part, Eigen::Index axis) {
  if (part > 0) {
    const auto& x = part == 1 ? frame.p : part == 2 ? frame.w : frame.v;
    return derivatives_of(x[axis]);
  }
  JetDerivatives change = JetDerivatives::Zero();
  const Eigen::Index i = (axis + 1) % 3, j = (axis + 2) % 3;
  for (Eigen::Index c = 0; c < 3; ++c) change += derivatives_of(frame.R(j, c)) * m.R(i, c);
  return change;
}

using Wrenches = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// A load on distributed mass says its own slopes, and the wrench of each of its points is of that point alone.
void add_slopes(const FieldLoad& field, double t, const std::vector<FrameMotion>& motions,
                const std::vector<FrameState<Jet>>& frames, Eigen::Matrix<Jet, 6, Eigen::Dynamic>& all) {
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const FieldLoad::Slope slope = field.slope(t, field.point(field.frames()[k]), motions[k]);
    for (Eigen::Index column = 0; column < slope.cols(); ++column) {
      const JetDerivatives change = change_of(frames[k], motions[k], static_cast<int>(column / 3), column % 3);
      for (Eigen::Index e = 0; e < slope.rows(); ++e)
        derivatives_of(all(e, static_cast<Eigen::Index>(k))) += slope(e, column) * change;
    }
  }
}

FrameMotion moved(const FrameMotion& m, int part, const Vector3& step) {
  FrameMotion n = m;
  if (part == 0) n.R = Eigen::AngleAxisd(step.norm(), step.normalized()) * m.R;
  if (part == 1) n.position += step;
  if (part == 2) n.angular_velocity += step;
  if (part == 3) n.velocity += step;
  return n;
}

/// Of the number that moved() adds a step to.
double size_of(const FrameMotion& m, int part, Eigen::Index axis) {
  if (part == 0) return 1;  // a rotation's
  return std::abs((part == 1 ? m.position : part == 2 ? m.angular_velocity : m.velocity)[axis]);
}

/// Of any other load by differences. \returns whether there are any.
template <class WrenchesAt>
bool add_differences(const WrenchesAt& wrenches_at, const std::vector<FrameMotion>& motions,
                     const std::vector<FrameState<Jet>>& frames, Eigen::Matrix<Jet, 6, Eigen::Dynamic>& all) {
  bool depends = false;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    for (int part = 0; part < 4; ++part) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const JetDerivatives change = change_of(frames[k], motions[k], part, axis);
        if (change.isZero(0)) continue;
        const Wrenches slope = refined_difference(
            [&](double h) {
              std::vector<FrameMotion> changed = motions;
              changed[k] = moved(motions[k], part, h * Vector3::Unit(axis));
              return wrenches_at(changed);
            },
            difference_step, size_of(motions[k], part, axis));
        if (slope.isZero(0)) continue;
        depends = true;
        for (Eigen::Index e = 0; e < slope.size(); ++e) derivatives_of(all(e)) += slope(e) * change;
      }
    }
  }
  return depends;
}

}  // namespace

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
    Wrenches all(6, static_cast<Eigen::Index>(at.size()));
    for (std::size_t k = 0; k < at.size(); ++k)
      all.col(static_cast<Eigen::Index>(k)) << values[k].moment, values[k].force;
    return all;
  };
  Eigen::Matrix<Jet, 6, Eigen::Dynamic> all = wrenches_at(motions).cast<Jet>();
  if (acts_on_mass(load)) {
    if (const FieldLoad* field = acting_field(load, y)) add_slopes(*field, t, motions, frames, all);
  } else {
    depends = add_differences(wrenches_at, motions, frames, all);
  }
  std::vector<AppliedWrench<Jet>> result;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const auto column = all.col(static_cast<Eigen::Index>(k));
    result.push_back({load.load->frames()[k], column.head<3>(), column.tail<3>()});
  }
  return result;
}

}  // namespace withy::analysis
