#include "collocation.hpp"

#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>

namespace withy {

template class ShiftedSystem<double>;
template class ShiftedSystem<std::complex<double>>;

namespace {

/// More than the digits of two doubles: symplecticity, b_i a_ij + b_j a_ji = b_i b_j, fails by what coefficients lack,
/// and the energy of undamped motion drifts by as much a step.
using Quad = boost::multiprecision::cpp_bin_float_quad;

Collocation from_nodes(const std::array<Quad, 3>& nodes) {
  Collocation m;
  for (int j = 0; j < 3; ++j) {
    const auto node = [&](int k) -> const Quad& { return nodes[static_cast<std::size_t>(k % 3)]; };
    m.c[j] = static_cast<double>(node(j));
    // l_j = (t − p)(t − q)/((c_j − p)(c_j − q)), integrated.
    const Quad &at = node(j), &p = node(j + 1), &q = node(j + 2);
    const auto integral = [&](const Quad& t) -> Quad {
      return t * (t * t / 3 - (p + q) * t / 2 + p * q) / ((at - p) * (at - q));
    };
    const auto split = [](const Quad& exact, double& value, double& rest) {
      value = static_cast<double>(exact);
      rest = static_cast<double>(Quad(exact - value));
    };
    for (int i = 0; i < 3; ++i) split(integral(node(i)), m.A(i, j), m.A_rest(i, j));
    split(integral(1), m.b[j], m.b_rest[j]);
  }
  const Eigen::Matrix3d inverse = m.A.inverse();
  m.by_stages = inverse.transpose() * m.b;
  const Eigen::EigenSolver<Eigen::Matrix3d> eigen(inverse);
  int real = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::abs(eigen.eigenvalues()[i].imag()) < std::abs(eigen.eigenvalues()[real].imag())) real = i;
  }
  const int pair = real == 0 ? 1 : 0;
  m.gamma = eigen.eigenvalues()[real].real();
  const std::complex<double> lambda = eigen.eigenvalues()[pair];
  m.alpha = lambda.real();
  m.beta = lambda.imag();
  m.T << eigen.eigenvectors().col(real).real(), eigen.eigenvectors().col(pair).real(),
      eigen.eigenvectors().col(pair).imag();
  m.T_inverse = m.T.inverse();
  return m;
}

}  // namespace

const Collocation& Collocation::gauss() {
  static const Collocation method = [] {
    const Quad half = sqrt(Quad(15)) / 10, middle = Quad(1) / 2;
    return from_nodes({middle - half, middle, middle + half});
  }();
  return method;
}

const Collocation& Collocation::radau_iia() {
  static const Collocation method = [] {
    const Quad root = sqrt(Quad(6));
    return from_nodes({(4 - root) / 10, (4 + root) / 10, 1});
  }();
  return method;
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
    contraction_ = 1;
    return;
  }
  // The polynomial through 0 and z_i at 0 and c_i of the last step, from its end on.
  before_ = z_;
  const Eigen::Vector3d end = weights_at(1);
  for (int i = 0; i < 3; ++i) z_.col(i).noalias() = before_ * (weights_at(1 + method_.c[i] * h / last_) - end);
}

void CollocationStages::predict_along(double h, const Eigen::ArrayXd& slope) {
  z_.noalias() = h * slope.head(jacobian_.size()).matrix() * method_.c.transpose();
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
    before_ = z_;
    residual_.noalias() = slopes_.topRows(jacobian_.size()) * method_.A.transpose();
    residual_.noalias() += slopes_.topRows(jacobian_.size()) * method_.A_rest.transpose();
    residual_ = h * residual_ - z_;
    solve_residual(h);
    z_.noalias() += right_ * method_.T.transpose();
  } else {
    right_.noalias() = slopes_.topRows(jacobian_.size()) * method_.T_inverse.transpose();
    right_.col(0) -= method_.gamma / h * w_.col(0);
    right_.col(1) -= (method_.alpha * w_.col(1) + method_.beta * w_.col(2)) / h;
    right_.col(2) -= (method_.alpha * w_.col(2) - method_.beta * w_.col(1)) / h;
    solve_transformed();
    w_ += right_;
    z_.noalias() = w_ * method_.T.transpose();
  }
}

void CollocationStages::solve_residual(double h) {
  w_.noalias() = residual_ * method_.T_inverse.transpose();
  right_.col(0) = method_.gamma / h * w_.col(0);
  right_.col(1) = (method_.alpha * w_.col(1) + method_.beta * w_.col(2)) / h;
  right_.col(2) = (method_.alpha * w_.col(2) - method_.beta * w_.col(1)) / h;
  solve_transformed();
}

void CollocationStages::solve_transformed() {
  real_part_ = right_.col(0);
  real_.solve(real_part_);
  complex_part_.real() = right_.col(1);
  complex_part_.imag() = right_.col(2);
  complex_.solve(complex_part_);
  right_.col(0) = real_part_;
  right_.col(1) = complex_part_.real();
  right_.col(2) = complex_part_.imag();
}

void CollocationStages::end_of_step(double h, std::span<const double> y, const Eigen::ArrayXd& lost,
                                    Eigen::ArrayXd& next, Eigen::ArrayXd& lost_next) {
  // Σ weight_j f_j with both parts of the weights: one long double holds fewer digits than they have.
  const auto sum = [this](Eigen::Index k, const auto& weights, const auto& rest) {
    long double high = 0, low = 0;
    for (int j = 0; j < 3; ++j) {
      high += static_cast<long double>(weights[j]) * slopes_(k, j);
      low += static_cast<long double>(rest[j]) * slopes_(k, j);
    }
    return high + low;
  };
  for (Eigen::Index k = 0; k < jacobian_.size(); ++k) {
    const double here = y[static_cast<std::size_t>(k)];
    for (int i = 0; i < 3; ++i) {
      const double stage = here + before_(k, i);
      residual_(k, i) = static_cast<double>((static_cast<long double>(here) - stage) + lost[k] +
                                            h * sum(k, method_.A.row(i), method_.A_rest.row(i)));
    }
  }
  solve_residual(h);
  w_.noalias() = right_ * method_.T.transpose();  // d
  for (Eigen::Index k = 0; k < next.size(); ++k) {
    const double here = y[static_cast<std::size_t>(k)];
    long double increment = h * sum(k, method_.b, method_.b_rest) + lost[k];
    if (k < jacobian_.size()) increment += (w_.row(k) - residual_.row(k)).dot(method_.by_stages);
    next[k] = static_cast<double>(here + increment);
    lost_next[k] = static_cast<double>((static_cast<long double>(here) - next[k]) + increment);
  }
  z_ = before_ + w_;
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
