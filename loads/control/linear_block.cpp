#include "withy/loads/control/linear_block.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "withy/loads/control/reference.hpp"

namespace withy {

LinearBlock::LinearBlock(StateSpace system, std::optional<Trajectory> reference, Start start)
    : system_(std::move(system)), reference_(std::move(reference)) {
  if (start == Start::settled) settled_ = -system_.A.partialPivLu().solve(system_.B);
}

std::vector<std::string> LinearBlock::states() const {
  std::vector<std::string> names;
  for (Eigen::Index i = 0; i < system_.A.rows(); ++i) names.push_back("x" + std::to_string(i));
  return names;
}

double LinearBlock::input(double t, std::span<const double> w, Eigen::Index i) const noexcept {
  const double measured = w[static_cast<std::size_t>(i)];
  return reference_ ? at(*reference_, t).position - measured : measured;
}

void LinearBlock::combine(const Eigen::MatrixXd& by_state, const Eigen::MatrixXd& by_input, double t,
                          std::span<const double> w, std::span<const double> z, std::span<double> sum) const noexcept {
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    sum[i] = 0;
    for (Eigen::Index j = 0; j < by_state.cols(); ++j) sum[i] += by_state(row, j) * z[static_cast<std::size_t>(j)];
    for (Eigen::Index j = 0; j < by_input.cols(); ++j) sum[i] += by_input(row, j) * input(t, w, j);
  }
}

void LinearBlock::begin(double t, std::span<const double> w, std::span<double> z) const noexcept {
  for (std::size_t i = 0; i < z.size(); ++i) {
    z[i] = 0;
    for (Eigen::Index j = 0; j < settled_.cols(); ++j)
      z[i] += settled_(static_cast<Eigen::Index>(i), j) * input(t, w, j);
  }
}

void LinearBlock::rates(double t, std::span<const double> w, std::span<const double> z,
                        std::span<double> rates) const noexcept {
  combine(system_.A, system_.B, t, w, z, rates);
}

void LinearBlock::output(double t, std::span<const double> w, std::span<const double> z,
                         std::span<double> v) const noexcept {
  combine(system_.C, system_.D, t, w, z, v);
}

bool LinearBlock::feeds_through(std::size_t input) const {
  return !system_.D.col(static_cast<Eigen::Index>(input)).isZero(0);
}

void LinearBlock::set_sample(double period) {
  const Eigen::Index n = system_.A.rows(), m = system_.B.cols();
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(n + m, n + m);
  both.topLeftCorner(n, n) = system_.A * period;
  both.topRightCorner(n, m) = system_.B * period;
  const Eigen::MatrixXd over = matrix_exponential(both);
  transition_ = over.topLeftCorner(n, n);
  held_ = over.topRightCorner(n, m);
}

void LinearBlock::advance(double t, std::span<const double> w, std::span<double> z) const noexcept {
  std::array<double, most_states> next{};
  combine(transition_, held_, t, w, z, {next.data(), z.size()});
  std::copy_n(next.begin(), z.size(), z.begin());
}

bool LinearBlock::slopes(double /*t*/, std::span<const double> /*w*/, std::span<const double> /*z*/,
                         Slopes& slopes) const {
  const double sign = reference_ ? -1 : 1;
  slopes = {sign * system_.B, system_.A, sign * system_.D, system_.C};
  return true;
}

std::vector<double> LinearBlock::discontinuities() const {
  return reference_ ? jumps_of(*reference_) : std::vector<double>{};
}
double LinearBlock::end() const { return reference_ ? end_of(*reference_) : 0; }

Eigen::MatrixXd matrix_exponential(const Eigen::MatrixXd& M) {
  const double size = M.size() > 0 ? M.cwiseAbs().rowwise().sum().maxCoeff() : 0;
  const int halvings = size > 0.5 ? static_cast<int>(std::ceil(std::log2(size / 0.5))) : 0;
  const Eigen::MatrixXd scaled = std::ldexp(1.0, -halvings) * M;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Identity(M.rows(), M.cols()), term = sum;
  for (int k = 1; k <= 18; ++k) {  // 0.5^18/18! is below rounding
    term = (term * scaled / k).eval();
    sum += term;
  }
  for (int k = 0; k < halvings; ++k) sum = (sum * sum).eval();
  return sum;
}

StateSpace canonical_form(const std::vector<double>& numerator, const std::vector<double>& denominator) {
  const auto n = static_cast<Eigen::Index>(denominator.size()) - 1;
  // Of the power n, n − 1, … 0, over the denominator's first.
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n + 1), a(n + 1);
  for (std::size_t i = 0; i < numerator.size(); ++i)
    b[n + 1 - static_cast<Eigen::Index>(numerator.size()) + static_cast<Eigen::Index>(i)] =
        numerator[i] / denominator[0];
  for (Eigen::Index i = 0; i <= n; ++i) a[i] = denominator[static_cast<std::size_t>(i)] / denominator[0];
  StateSpace s{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, 1), Eigen::MatrixXd::Zero(1, n),
               Eigen::MatrixXd::Constant(1, 1, b[0])};
  if (n == 0) return s;
  s.A.row(0) = -a.tail(n).transpose();
  s.A.bottomLeftCorner(n - 1, n - 1).setIdentity();
  s.B(0, 0) = 1;
  s.C.row(0) = (b.tail(n) - b[0] * a.tail(n)).transpose();
  return s;
}

}  // namespace withy
