#include "withy/campaign/correlation.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>

#include "withy/scene/describe.hpp"
#include "withy/scene/names.hpp"

namespace withy::campaign {
namespace {

/// False where a name is of no value that is drawn freely.
bool read_paths(const Value* given, const PlanReader& reader, Plan& plan) {
  const auto bad = [&](const std::string& why) {
    reader.key_error("/correlation/of", why);
    return false;
  };
  std::vector<std::string> paths;
  for (const Axis& a : plan.axes) paths.push_back(a.path);
  for (const std::string& path : reader.texts(given)) {
    const auto at = static_cast<std::size_t>(std::find(paths.begin(), paths.end(), path) - paths.begin());
    if (at == paths.size()) return bad(fmt::format("{} does not vary{}", in_quotes(path), suggestion(path, paths)));
    if (!plan.axes[at].drawn() || plan.axes[at].sampling == Sampling::latin)
      return bad(fmt::format("{} is not drawn freely: need a distribution, or sobol", in_quotes(path)));
    if (std::find(plan.correlated.begin(), plan.correlated.end(), at) != plan.correlated.end())
      return bad(in_quotes(path) + " is there twice");
    plan.correlated.push_back(at);
  }
  return true;
}

/// Nothing where the value is no square matrix of numbers.
std::optional<Eigen::MatrixXd> read_matrix(const Value* given, const PlanReader& reader, std::size_t size) {
  if (given == nullptr || given->items().size() != size) return {};
  const auto n = static_cast<Eigen::Index>(size);
  Eigen::MatrixXd matrix(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Value& row = given->items()[static_cast<std::size_t>(i)];
    if (row.items().size() != size) return {};
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto x = reader.number(row.items()[static_cast<std::size_t>(j)]);
      if (!x) return {};
      matrix(i, j) = x->si;
    }
  }
  return matrix;
}

}  // namespace

void read_correlation(const Value& given, const PlanReader& reader, Plan& plan) {
  if (!reader.is_map(given, keys::correlation)) return;
  if (plan.design != Design::product)
    return reader.key_error("/correlation", "this design needs values that are independent: leave it out");
  if (!read_paths(given.find("of"), reader, plan)) return;
  const std::size_t size = plan.correlated.size();
  const auto matrix = read_matrix(given.find("matrix"), reader, size);
  const auto n = static_cast<Eigen::Index>(size);
  if (matrix && *matrix == matrix->transpose() && matrix->diagonal() == Eigen::VectorXd::Ones(n)) {
    const Eigen::LLT<Eigen::MatrixXd> llt(*matrix);
    const Eigen::MatrixXd l = llt.matrixL();
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j) plan.cholesky.push_back(l(i, j));
    if (llt.info() == Eigen::Success) return;
  }
  reader.key_error("/correlation/matrix", fmt::format("need {0} rows of {0} correlations, symmetric, with 1 on the "
                                                      "diagonal and positive definite",
                                                      size));
}

}  // namespace withy::campaign
