#include "collocation.hpp"

namespace withy {

template class ShiftedSystem<double>;
template class ShiftedSystem<std::complex<double>>;

Collocation::Collocation(const std::array<long double, 3>& nodes) {
  for (int j = 0; j < 3; ++j) {
    c[j] = static_cast<double>(nodes[static_cast<std::size_t>(j)]);
    // l_j = (t − p)(t − q)/((c_j − p)(c_j − q)), integrated.
    const long double p = nodes[static_cast<std::size_t>((j + 1) % 3)],
                      q = nodes[static_cast<std::size_t>((j + 2) % 3)];
    const long double at = nodes[static_cast<std::size_t>(j)];
    const auto integral = [&](long double t) {
      return t * (t * t / 3 - (p + q) * t / 2 + p * q) / ((at - p) * (at - q));
    };
    const auto split = [](long double exact, double& value, double& rest) {
      value = static_cast<double>(exact);
      rest = static_cast<double>(exact - value);
    };
    for (int i = 0; i < 3; ++i) split(integral(nodes[static_cast<std::size_t>(i)]), A(i, j), A_rest(i, j));
    split(integral(1), b[j], b_rest[j]);
  }
  const Eigen::EigenSolver<Eigen::Matrix3d> eigen(A.inverse());
  int real = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::abs(eigen.eigenvalues()[i].imag()) < std::abs(eigen.eigenvalues()[real].imag())) real = i;
  }
  int pair = real == 0 ? 1 : 0;
  gamma = eigen.eigenvalues()[real].real();
  const std::complex<double> lambda = eigen.eigenvalues()[pair];
  alpha = lambda.real();
  beta = lambda.imag();
  T << eigen.eigenvectors().col(real).real(), eigen.eigenvectors().col(pair).real(),
      eigen.eigenvectors().col(pair).imag();
  T_inverse = T.inverse();
}

CollocationStages::CollocationStages(const Collocation& method, StepJacobian& jacobian)
    : method_(method), jacobian_(jacobian), real_(jacobian), complex_(jacobian) {
  const Eigen::Index m = jacobian.size();
  for (Eigen::MatrixXd* a : {&z_, &before_, &w_, &right_, &residual_}) a->setZero(m, 3);
  slopes_.setZero(jacobian.all(), 3);
  stage_.setZero(jacobian.all());
  slope_.setZero(jacobian.all());
  real_part_.setZero(m);
  complex_part_.setZero(m);
}

void CollocationStages::factorize(double h) {
  if (h == factored_) return;
  factored_ = h;
  real_.factorize(method_.gamma / h);
  complex_.factorize(std::complex<double>(method_.alpha, -method_.beta) / h);
}

void CollocationStages::predict(double h) {
  if (!(last_ > 0)) {
    z_.setZero();
    return;
  }
  // The polynomial through 0 and z_i at 0 and c_i of the last step, from its end on.
  before_ = z_;
  const Eigen::Vector3d end = weights_at(1);
  for (int i = 0; i < 3; ++i) z_.col(i).noalias() = before_ * (weights_at(1 + method_.c[i] * h / last_) - end);
}

Eigen::Vector3d CollocationStages::weights_at(double theta) const {
  Eigen::Vector3d weights;
  for (int i = 0; i < 3; ++i) {
    weights[i] = theta / method_.c[i];
    for (int j = 0; j < 3; ++j)
      if (j != i) weights[i] *= (theta - method_.c[j]) / (method_.c[i] - method_.c[j]);
  }
  return weights;
}

void CollocationStages::forget() {
  last_ = 0;
  contraction_ = 1;
  factored_ = 0;
}

void CollocationStages::remember(Memory& memory) {
  memory(last_);
  memory(contraction_);
  for (Eigen::Index i = 0; i < z_.size(); ++i) memory(z_(i));
  if (memory.reading()) factored_ = 0;
}

void CollocationStages::correct(double h, bool from_residual) {
  if (from_residual) {
    residual_.noalias() = slopes_.topRows(jacobian_.size()) * method_.A.transpose();
    residual_.noalias() += slopes_.topRows(jacobian_.size()) * method_.A_rest.transpose();
    residual_ = h * residual_ - z_;
    w_.noalias() = residual_ * method_.T_inverse.transpose();
    right_.col(0) = method_.gamma / h * w_.col(0);
    right_.col(1) = (method_.alpha * w_.col(1) + method_.beta * w_.col(2)) / h;
    right_.col(2) = (method_.alpha * w_.col(2) - method_.beta * w_.col(1)) / h;
  } else {
    right_.noalias() = slopes_.topRows(jacobian_.size()) * method_.T_inverse.transpose();
    right_.col(0) -= method_.gamma / h * w_.col(0);
    right_.col(1) -= (method_.alpha * w_.col(1) + method_.beta * w_.col(2)) / h;
    right_.col(2) -= (method_.alpha * w_.col(2) - method_.beta * w_.col(1)) / h;
  }
  real_part_ = right_.col(0);
  real_.solve(real_part_);
  complex_part_.real() = right_.col(1);
  complex_part_.imag() = right_.col(2);
  complex_.solve(complex_part_);
  right_.col(0) = real_part_;
  right_.col(1) = complex_part_.real();
  right_.col(2) = complex_part_.imag();
  if (from_residual) {
    z_.noalias() += right_ * method_.T.transpose();
  } else {
    w_ += right_;
    z_.noalias() = w_ * method_.T.transpose();
  }
}

double CollocationStages::change(const Eigen::ArrayXd& tolerance) {
  const Eigen::Index m = jacobian_.size();
  double change = 0;
  for (int i = 0; i < 3; ++i) {
    slope_.head(m) = (right_ * method_.T.row(i).transpose()).array().abs() / tolerance.head(m);
    if (!std::isfinite(slope_.head(m).sum())) return std::numeric_limits<double>::infinity();
    change = std::max(change, slope_.head(m).maxCoeff());
  }
  return change;
}

}  // namespace withy
