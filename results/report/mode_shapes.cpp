#include "withy/results/report/mode_shapes.hpp"

namespace withy {

ModeShapes::ModeShapes(const std::vector<PointExpansion>& points, bool second_order) {
  if (points.empty()) return;
  modes_ = points.front().phi.cols();
  const Eigen::Index pairs = second_order ? modes_ * (modes_ + 1) / 2 : 0;
  shapes_.resize(3 * static_cast<Eigen::Index>(points.size()), modes_ + pairs);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PointExpansion& e = points[i];
    const auto row = 3 * static_cast<Eigen::Index>(i);
    shapes_.block(row, 0, 3, modes_) = e.phi.cast<float>();
    Eigen::Index at = modes_;
    for (Eigen::Index k = 0; k < modes_ && second_order; ++k)
      for (Eigen::Index l = k; l < modes_; ++l, ++at)
        for (std::size_t c = 0; c < 3; ++c)
          shapes_(row + static_cast<Eigen::Index>(c), at) = static_cast<float>(e.gamma[c](k, l));
  }
  scale_squares();
}

ModeShapes::ModeShapes(const Eigen::MatrixXf& first, const Eigen::MatrixXf& second)
    : modes_(first.cols()), shapes_(first.rows(), first.cols() + second.cols()) {
  shapes_.leftCols(modes_) = first;
  shapes_.rightCols(second.cols()) = second;
  scale_squares();
}

/// ½ qᵀ Γ q has each Γ_kl of two coordinates twice and each Γ_kk once.
void ModeShapes::scale_squares() {
  Eigen::Index at = modes_;
  for (Eigen::Index k = 0; at < shapes_.cols(); at += modes_ - k, ++k) shapes_.col(at) *= 0.5F;
}

Eigen::VectorXf ModeShapes::weights(std::span<const double> q) const {
  Eigen::VectorXf w(shapes_.cols());
  Eigen::Index at = 0;
  for (Eigen::Index k = 0; k < modes_; ++k) w[at++] = static_cast<float>(q[static_cast<std::size_t>(k)]);
  for (Eigen::Index k = 0; at < w.size(); ++k)
    for (Eigen::Index l = k; l < modes_; ++l)
      w[at++] = static_cast<float>(q[static_cast<std::size_t>(k)] * q[static_cast<std::size_t>(l)]);
  return w;
}

}  // namespace withy
