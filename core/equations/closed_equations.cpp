#include "withy/core/equations/closed_equations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "withy/core/equations/sensing.hpp"

namespace withy::equations {
namespace {

double greatest(std::span<const double> values) {
  double most = 0;
  for (const double x : values) most = std::isfinite(x) ? std::max(most, std::abs(x)) : std::abs(x);
  return most;
}

}  // namespace

ClosedEquations::ClosedEquations(std::shared_ptr<const Model> model, Terms terms,
                                 std::unique_ptr<EquationsOfMotion> tree)
    : model_(std::move(model)),
      terms_(terms),
      tree_(std::move(tree)),
      mass_(dynamic_cast<const MassSolver*>(tree_.get())),
      loads_(*model_, terms),
      paths_(*model_, terms),
      angles_(*model_),
      in_loops_(speeds_in_loops(*model_)),
      reaches_(reaches_of_speeds(*model_, paths_.length())),
      rows_(paths_.size()),
      speeds_(layout().speeds) {
  if (mass_ == nullptr || mass_->mass_factors_size() == 0)
    throw std::invalid_argument(
        "closed loops (constraints) need a symmetric mass matrix, which strict first order has not; use quadratic, "
        "ruthless, symmetric or exact");
  for (std::size_t h = 0; h < layout().hinges.size(); ++h)
    if (model_->driven(h)) driven_.push_back(layout().hinges[h]);
  for (const Slot& slot : driven_) std::fill_n(&reaches_[slot.speed], slot.speeds, 0.0);
  lay_out();
}

void ClosedEquations::lay_out() {
  sweep::WorkLayout memory;
  // The tree's evaluations and its factors take turns.
  memory.take<std::byte>(std::max(tree_->make_work().size(), mass_->mass_factors_size()));
  of_paths_ = {memory, paths_.work_size()};
  of_loads_ = {memory, loads_.work_size()};
  for (Slice<double>* s : {&gaps_, &rates_, &multipliers_, &left_}) *s = {memory, rows_};
  for (Slice<double>* s : {&J_, &J_after_, &Z_}) *s = {memory, rows_ * speeds_};
  held_ = {memory, driven_.empty() ? 0 : rows_ * speeds_};
  for (Slice<double>* s : {&A_, &L_, &other_A_, &other_L_}) *s = {memory, rows_ * rows_};
  for (Slice<double>* s : {&change_, &on_loads_, &on_motions_}) *s = {memory, speeds_};
  for (Slice<double>* s : {&state_, &slopes_}) *s = {memory, size()};
  for (Slice<std::size_t>* s : {&order_, &other_order_}) *s = {memory, rows_};
  rank_ = {memory, 1};
  work_size_ = memory.size();
}

PivotedFactors ClosedEquations::factors(Work& work) const noexcept {
  return {rows_, L_.in(work).data(), order_.in(work).data(), left_.in(work).data(), rank_.in(work)[0]};
}

void ClosedEquations::find_rows(std::span<const double> y, std::span<double> rows, Work& work,
                                LoopPaths::Held held) const noexcept {
  std::byte* const memory = of_paths_.in(work);
  paths_.gaps(y, gaps_.in(work), memory, held);
  std::fill(rows.begin(), rows.end(), 0.0);
  const std::span<double> one = multipliers_.in(work);
  std::fill(one.begin(), one.end(), 0.0);
  for (std::size_t i = 0; i < rows_; ++i) {
    one[i] = 1;
    paths_.add_efforts(one, rows.subspan(i * speeds_, speeds_), memory, held);
    one[i] = 0;
  }
  const double rounding = paths_.rounding(memory);
  for (std::size_t i = 0; i < rows_; ++i) {
    const std::span<double> row = rows.subspan(i * speeds_, speeds_);
    std::size_t k = 0;
    while (k < speeds_ && (reaches_[k] == 0 || std::abs(row[k]) <= rounding * reaches_[k])) ++k;
    if (k < speeds_) continue;
    for (k = 0; k < speeds_; ++k)
      if (reaches_[k] > 0) row[k] = 0;
  }
}

Evaluation ClosedEquations::factorize(std::span<const double> y, Work& work) const noexcept {
  const std::span<double> J = J_.in(work), Z = Z_.in(work), A = A_.in(work);
  find_rows(y, J, work);
  const Evaluation e = mass_->factorize_mass(y, work);
  if (!e.ok()) return e;
  for (std::size_t i = 0; i < rows_; ++i)
    mass_->accelerate(J.subspan(i * speeds_, speeds_), Z.subspan(i * speeds_, speeds_), work);
  for (std::size_t i = 0; i < rows_; ++i)
    for (std::size_t j = 0; j < rows_; ++j) A[i * rows_ + j] = row_product(&J[i * speeds_], &Z[j * speeds_], speeds_);
  PivotedFactors f = factors(work);
  // Rows that depend on others where loops are closed do so to the square of the gap where they are not.
  const double open = 100 * greatest(gaps_.in(work)) / paths_.length();
  f.factorize(A.data(), std::max(PivotedFactors::independent, std::min(open * open, 1e-2)));
  rank_.in(work)[0] = f.rank;
  return e;
}

void ClosedEquations::answer(std::span<const double> b, std::span<double> change, Work& work) const noexcept {
  const std::span<double> lambda = multipliers_.in(work);
  factors(work).solve(b.data(), lambda.data());
  const std::span<const double> Z = Z_.in(work);
  for (std::size_t i = 0; i < rows_; ++i) {
    lambda[i] = -lambda[i];
    for (std::size_t k = 0; lambda[i] != 0 && k < speeds_; ++k) change[k] += lambda[i] * Z[i * speeds_ + k];
  }
}

Evaluation ClosedEquations::derivatives(double t, std::span<const double> y, std::span<double> y_dot,
                                        Work& work) const noexcept {
  Evaluation e = factorize(y, work);
  if (!e.ok()) return e;
  const std::span<const double> J = J_.in(work), Z = Z_.in(work);
  const std::span<double> held = held_.in(work);
  for (std::size_t i = 0; !driven_.empty() && i < rows_; ++i) {
    const std::span<double> row = held.subspan(i * speeds_, speeds_);
    tree_->mass_times(y, Z.subspan(i * speeds_, speeds_), row, work);
    for (std::size_t k = 0; k < speeds_; ++k) row[k] -= J[i * speeds_ + k];
  }
  e = tree_->derivatives(t, y, y_dot, work);
  if (!e.ok()) return e;
  const std::span<double> u_dot = y_dot.subspan(layout().positions, speeds_), b = rates_.in(work);
  paths_.biases(b, of_paths_.in(work));
  for (std::size_t i = 0; i < rows_; ++i) b[i] += row_product(&J[i * speeds_], u_dot.data(), speeds_);
  answer(b, u_dot, work);
  if (!(greatest(u_dot) < std::numeric_limits<double>::infinity())) return {Evaluation::Outcome::nonfinite, -1};
  // What loads measure of accelerations is that of the closed loops.
  if (layout().continuous > 0 && !loads_.rates(t, y, y_dot, of_loads_.in(work)))
    return {Evaluation::Outcome::nonfinite, -1};
  // Other multipliers give the same accelerations, and other efforts of motions than reactions tell.
  if (!driven_.empty() && rank_.in(work)[0] < rows_) find_least(work);
  const std::span<const double> lambda = multipliers_.in(work);
  const std::span<double> on_motions = on_motions_.in(work);
  for (const Slot& slot : driven_) {
    for (std::size_t k = slot.speed; k < slot.speed + slot.speeds; ++k) {
      on_motions[k] = 0;
      for (std::size_t i = 0; i < rows_; ++i) on_motions[k] += lambda[i] * held[i * speeds_ + k];
      y_dot.back() += on_motions[k] * y[layout().positions + k];
    }
  }
  return e;
}

bool ClosedEquations::found_efforts(Work& work, std::span<double> loads, std::span<double> motions) const noexcept {
  if (!tree_->found_efforts(work, loads, motions)) return false;
  const std::span<const double> more = on_motions_.in(work);
  for (const Slot& slot : driven_)
    for (std::size_t k = slot.speed; k < slot.speed + slot.speeds; ++k) motions[k] += more[k];
  return true;
}

Evaluation ClosedEquations::motion_efforts(double t, std::span<const double> y, std::span<double> efforts,
                                           Work& work) const noexcept {
  std::fill(efforts.begin(), efforts.end(), 0.0);
  if (driven_.empty()) return {};
  const Evaluation e = derivatives(t, y, slopes_.in(work), work);
  if (e.ok()) found_efforts(work, on_loads_.in(work), efforts);
  return e;
}

void ClosedEquations::move(std::span<double> y, Work& work) const noexcept {
  const std::span<double> there = state_.in(work), slopes = slopes_.in(work), change = change_.in(work);
  std::copy(y.begin(), y.end(), there.begin());
  std::copy(change.begin(), change.end(), there.begin() + static_cast<std::ptrdiff_t>(layout().positions));
  tree_->position_rates(0, there, slopes, work);
  for (std::size_t i = 0; i < layout().positions; ++i) y[i] += slopes[i];
  tree_->normalize(y);
}

// With the factors of the first state; gaps after a step are so small that each change leaves their square.
//
// A gap that motions open grows from one step to the next. With one bound for it a state just below would be followed
// by none, and steps would be halved as long as rounding lets one of them pass. So the states between two bounds are
// reached, as steps are halved on the way to the second, and are known as the last.
void ClosedEquations::close_positions(std::span<double> y, Closing& closing, Work& work) const noexcept {
  const double rounding = 1e-15 * paths_.length(), good = 1e-9 * paths_.length(), last = 2 * good;
  constexpr int most = 12, most_factors = 4;
  const std::span<double> g = gaps_.in(work), change = change_.in(work);
  double left = greatest(g);
  for (int i = 0, made = 1; i < most && left > rounding; ++i) {
    std::fill(change.begin(), change.end(), 0.0);
    answer(g, change, work);
    move(y, work);
    paths_.gaps(y, g, of_paths_.in(work));
    const double now = greatest(g);
    if (!(now < std::numeric_limits<double>::infinity())) {
      left = now;
      break;
    }
    const bool slow = now > 0.1 * left;
    left = now;
    if (!slow) continue;
    if (left <= good || ++made > most_factors) break;
    if (!factorize(y, work).ok()) {
      closing.closed = false;
      return;
    }
  }
  closing.closed = left <= last;
  closing.apart = closing.closed && left > good;
}

void ClosedEquations::close_speeds(std::span<double> y, Work& work) const noexcept {
  constexpr int most = 6;
  const std::span<double> rates = rates_.in(work), g = gaps_.in(work), change = change_.in(work);
  std::byte* const memory = of_paths_.in(work);
  paths_.rates(rates, memory);
  const double rounding = 1e-16 * paths_.length() * greatest(y.subspan(layout().positions, speeds_));
  double left = greatest(rates);
  for (int i = 0; i < most && left > rounding; ++i) {
    std::fill(change.begin(), change.end(), 0.0);
    answer(rates, change, work);
    for (std::size_t k = 0; k < speeds_; ++k) y[layout().positions + k] += change[k];
    paths_.gaps(y, g, memory);
    paths_.rates(rates, memory);
    const double now = greatest(rates);
    if (!(now < 0.1 * left)) return;
    left = now;
  }
}

Closing ClosedEquations::close(std::span<double> y, Work& work) const noexcept {
  tree_->normalize(y);
  Closing closing;
  closing.closed = factorize(y, work).ok();
  closing.gap = greatest(gaps_.in(work));
  closing.closed = closing.closed && std::isfinite(closing.gap);
  if (closing.closed) close_positions(y, closing, work);
  if (closing.closed) close_speeds(y, work);
  return closing;
}

void ClosedEquations::see(std::span<const double> y, std::span<double> gaps, std::span<double> rates,
                          std::span<double> J, Work& work) const noexcept {
  find_rows(y, J, work);
  const std::span<const double> g = gaps_.in(work);
  std::copy(g.begin(), g.end(), gaps.begin());
  paths_.rates(rates, of_paths_.in(work));
}

void ClosedEquations::see_turns(std::span<const double> y, std::span<double> gaps, std::span<double> J,
                                Work& work) const noexcept {
  std::fill(J.begin(), J.end(), 0.0);
  find_rows(y, J, work, LoopPaths::Held::turn);
  const std::span<const double> g = gaps_.in(work);
  std::copy(g.begin(), g.end(), gaps.begin());
}

bool ClosedEquations::right_way_round(std::span<const double> y, std::size_t index, Work& work) const noexcept {
  paths_.gaps(y, gaps_.in(work), of_paths_.in(work));
  return paths_.right_way_round(index, of_paths_.in(work));
}

// Rows beyond the rank are sums of those within, J₂ = W J₁ in free speeds, so that λ may change along the rows of
// N = [−W, 1]: λ ← λ − Nᵀ (N Nᵀ)⁻¹ N λ.
void ClosedEquations::find_least(Work& work) const noexcept {
  const PivotedFactors f = factors(work);
  const std::size_t m = rows_, r = f.rank, rest = m - r;
  const std::span<double> lambda = multipliers_.in(work), c = rates_.in(work);
  const std::span<double> W = other_A_.in(work).first(rest * r), G = other_A_.in(work).subspan(rest * r, rest * rest);
  for (std::size_t i = 0; i < rest; ++i) {
    double* const w = W.data() + i * r;
    c[i] = lambda[f.order[r + i]];
    for (std::size_t k = r; k-- > 0;) {
      w[k] = f.L[(r + i) * m + k];
      for (std::size_t j = k + 1; j < r; ++j) w[k] -= f.L[j * m + k] * w[j];
      w[k] /= f.L[k * m + k];
      c[i] -= w[k] * lambda[f.order[k]];
    }
    for (std::size_t j = 0; j <= i; ++j)
      G[i * rest + j] = G[j * rest + i] = row_product(w, W.data() + j * r, r) + (i == j ? 1 : 0);
  }
  PivotedFactors inner{rest, other_L_.in(work).data(), other_order_.in(work).data(), left_.in(work).data()};
  inner.factorize(G.data(), 0);
  inner.solve(c.data(), c.data());
  for (std::size_t i = 0; i < rest; ++i) {
    lambda[f.order[r + i]] -= c[i];
    for (std::size_t k = 0; k < r; ++k) lambda[f.order[k]] += c[i] * W[i * r + k];
  }
}

void ClosedEquations::multipliers(double t, std::span<const double> y, std::span<double> multipliers,
                                  Work& work) const noexcept {
  std::fill(multipliers.begin(), multipliers.end(), 0.0);
  if (!derivatives(t, y, slopes_.in(work), work).ok()) return;
  find_least(work);
  const std::span<const double> lambda = multipliers_.in(work);
  std::copy(lambda.begin(), lambda.end(), multipliers.begin());
}

Wrench ClosedEquations::reaction(std::size_t index, std::span<const double> multipliers, Work& work) const noexcept {
  std::byte* const memory = of_paths_.in(work);
  const Matrix3 R = paths_.axes(index, memory);
  const Wrench on_b = paths_.on_b(index, multipliers, memory);
  return {R.transpose() * on_b.moment, R.transpose() * on_b.force};
}

std::unique_ptr<SensedState> ClosedEquations::make_sensed_state(std::span<const SectionPlace> sections) const {
  return make_sensing(std::make_unique<const sensed::Plan>(*model_, terms_, sections), *this, loads_);
}

std::vector<std::string> ClosedEquations::savings() const {
  std::vector<std::string> lines = tree_->savings();
  lines.push_back("loops are closed by " + std::to_string(rows_) +
                  " equations with multipliers: each costs a solution by the tree's factors, in time proportional to "
                  "the number of bodies");
  return lines;
}

}  // namespace withy::equations
