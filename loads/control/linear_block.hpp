/// \file
/// Linear systems as blocks.
#pragma once

#include <optional>

#include "withy/loads/control/control_block.hpp"
#include "withy/loads/trajectory.hpp"

namespace withy {

/// States that a sampled system may have: `advance` keeps them on the stack.
inline constexpr std::size_t most_states = 64;

/// ẋ = A x + B w, v = C x + D w.
struct StateSpace {
  Eigen::MatrixXd A, B, C, D;
};

/// A linear system of what is measured, or of what it lacks to a reference. By the clock it is the exact solution for
/// inputs held over a sample.
class LinearBlock final : public ControlBlock, public CourseOfTime {
 public:
  enum class Start {
    zero,
    settled  ///< in the steady state of what is measured then; A is regular
  };
  /// \param reference with one input: w is the reference less what is measured
  explicit LinearBlock(StateSpace system, std::optional<Trajectory> reference = {}, Start start = Start::zero);

  std::size_t inputs() const override { return static_cast<std::size_t>(system_.B.cols()); }
  std::size_t outputs() const override { return static_cast<std::size_t>(system_.C.rows()); }
  std::vector<std::string> states() const override;
  std::string unit_of_output() const override { return settled_.size() > 0 ? "signal" : "1"; }
  std::string unit_of_state(std::size_t /*state*/) const override { return unit_of_output(); }
  std::vector<Shown> shown() const override {
    return reference_ ? std::vector<Shown>{{"error", "signal"}} : std::vector<Shown>{};
  }
  void tell(double t, std::span<const double> w, std::span<const double> /*z*/,
            std::span<double> values) const noexcept override {
    if (reference_) values[0] = input(t, w, 0);
  }
  void begin(double t, std::span<const double> w, std::span<double> z) const noexcept override;
  void rates(double t, std::span<const double> w, std::span<const double> z,
             std::span<double> rates) const noexcept override;
  bool feeds_through(std::size_t input) const override;
  void output(double t, std::span<const double> w, std::span<const double> z,
              std::span<double> v) const noexcept override;
  void set_sample(double period) override;
  void advance(double t, std::span<const double> w, std::span<double> z) const noexcept override;
  bool slopes(double t, std::span<const double> w, std::span<const double> z, Slopes& slopes) const override;
  std::vector<double> discontinuities() const override;
  std::size_t courses() const override { return reference_ ? courses_of(*reference_) : 0; }
  void course(double t, std::span<double> values) const noexcept override { course_of(*reference_, t, values); }
  double end() const override;

 private:
  [[nodiscard]] double input(double t, std::span<const double> w, Eigen::Index i) const noexcept;
  void combine(const Eigen::MatrixXd& by_state, const Eigen::MatrixXd& by_input, double t, std::span<const double> w,
               std::span<const double> z, std::span<double> sum) const noexcept;

  StateSpace system_;
  std::optional<Trajectory> reference_;
  Eigen::MatrixXd settled_;            ///< z by w at the start; empty: zero
  Eigen::MatrixXd transition_, held_;  ///< over a sample, of the states and of the inputs
};

/// e^M by scaling and squaring of its Taylor series.
Eigen::MatrixXd matrix_exponential(const Eigen::MatrixXd& M);

/// The controllable canonical form of numerator/denominator, coefficients from the highest power of s on; the first of
/// the denominator is not zero, and the numerator's degree is no higher.
StateSpace canonical_form(const std::vector<double>& numerator, const std::vector<double>& denominator);

}  // namespace withy
