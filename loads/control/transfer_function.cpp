/// \file
/// Linear controllers by their transfer function or their matrices.
#include <fmt/format.h>

#include "withy/loads/control/control_load.hpp"
#include "withy/loads/control/linear_block.hpp"
#include "withy/loads/control/reference.hpp"

namespace withy {
namespace {

/// Reports and gives false where a block is too large for a sampled controller.
bool small_enough(const ControlEnds& ends, std::size_t states, const Value& at, const MakeContext& context) {
  if (!(ends.sample > 0) || states <= most_states) return true;
  context.diagnostics.error(at.place(),
                            fmt::format("has {} states; a sampled controller has at most {}", states, most_states));
  return false;
}

/// Without the zeros that stand before the highest power.
std::vector<double> stripped(const Value& polynomial) {
  std::vector<double> c = polynomial.numbers();
  c.erase(c.begin(), std::find_if(c.begin(), c.end(), [](double x) { return x != 0; }));
  return c;
}

std::unique_ptr<Load> make_transfer_function(const Value& p, const MakeContext& context) {
  std::optional<ControlEnds> ends = read_ends(p, context);
  const std::optional<Trajectory> reference = read_reference(p, context);
  const std::vector<double> numerator = stripped(p.at("numerator")), denominator = stripped(p.at("denominator"));
  const auto error = [&](const char* key, const std::string& message) {
    context.diagnostics.error(p.at(key).place(), message);
    return nullptr;
  };
  bool given = true;
  for (const char* key : {"numerator", "denominator"}) {
    if (!p.at(key).items().empty()) continue;
    error(key, "got an empty list; need one coefficient or more");
    given = false;
  }
  if (!given) return nullptr;
  if (denominator.empty()) return error("denominator", "is zero");
  if (numerator.size() > denominator.size())
    return error("numerator", fmt::format("is of degree {} over a denominator of degree {}: the transfer function is "
                                          "improper, it would differentiate its input; give the denominator poles "
                                          "that are faster than what is controlled",
                                          numerator.size() - 1, denominator.size() - 1));
  if (!ends || !reference) return nullptr;
  const bool compares = p.has("reference") || p.has("motion");
  auto block = std::make_shared<LinearBlock>(canonical_form(numerator, denominator),
                                             compares ? std::optional(*reference) : std::nullopt);
  if (!small_enough(*ends, denominator.size() - 1, p.at("denominator"), context)) return nullptr;
  if (ends->sample > 0) block->set_sample(ends->sample);
  return make_control(std::move(*ends), std::move(block));
}

Eigen::MatrixXd matrix_of(const Value& rows) {
  const auto n = static_cast<Eigen::Index>(rows.items().size()),
             m = static_cast<Eigen::Index>(rows.items()[0].items().size());
  Eigen::MatrixXd M(n, m);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < m; ++j)
      M(i, j) = rows.items()[static_cast<std::size_t>(i)].items()[static_cast<std::size_t>(j)].number();
  return M;
}

std::unique_ptr<Load> make_state_space(const Value& p, const MakeContext& context) {
  std::optional<ControlEnds> ends = read_ends(p, context);
  StateSpace s{matrix_of(p.at("A")), matrix_of(p.at("B")), matrix_of(p.at("C")), {}};
  s.D = p.has("D") ? matrix_of(p.at("D")) : Eigen::MatrixXd::Zero(s.C.rows(), s.B.cols());
  bool good = true;
  const auto expect = [&](const char* key, const Eigen::MatrixXd& M, Eigen::Index rows, Eigen::Index columns) {
    if (M.rows() == rows && M.cols() == columns) return;
    context.diagnostics.error(
        p.at(key).place(),
        fmt::format("is {} x {}; with the other matrices it needs to be {} x {}", M.rows(), M.cols(), rows, columns));
    good = false;
  };
  expect("A", s.A, s.A.rows(), s.A.rows());
  expect("B", s.B, s.A.rows(), s.B.cols());
  expect("C", s.C, s.C.rows(), s.A.rows());
  if (p.has("D")) expect("D", s.D, s.C.rows(), s.B.cols());
  if (!ends || !good || !small_enough(*ends, static_cast<std::size_t>(s.A.rows()), p.at("A"), context)) return nullptr;
  auto block = std::make_shared<LinearBlock>(std::move(s));
  if (ends->sample > 0) block->set_sample(ends->sample);
  return make_control(std::move(*ends), std::move(block));
}

}  // namespace

void enroll_transfer_function(Enrollment& enrollment) {
  std::vector<ParameterSpec> own{vector("numerator", 0, "1", "coefficients from the highest power of s on"),
                                 vector("denominator", 0, "1", "likewise; of no lower degree")};
  for (ParameterSpec& spec : reference_parameters("1")) own.push_back(std::move(spec));
  enrollment.add<Load>({.id = "transfer-function",
                        .summary = "Linear controller of one signal by its transfer function",
                        .parameters = control_parameters(std::move(own)),
                        .make = &make_transfer_function});
  enrollment.add<Load>(
      {.id = "state-space",
       .summary = "Linear controller of signals, x' = A x + B w, v = C x + D w",
       .parameters = control_parameters({matrix("A", "1", "states x states"), matrix("B", "1", "states x signals"),
                                         matrix("C", "1", "places to act x states"),
                                         matrix("D", "1", "places to act x signals; zero where left out").optional()}),
       .make = &make_state_space});
}

}  // namespace withy
