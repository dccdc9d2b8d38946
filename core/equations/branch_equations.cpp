#include "withy/core/equations/branch_equations.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <utility>

#include "withy/core/equations/sweep_equations.hpp"
#include "withy/core/plugin/forwarding_equations.hpp"
#include "withy/core/sweep/symmetric/branched_sweep.hpp"

namespace withy {
namespace {

template <class Space>
using Whole = equations::SweepEquations<sweep::SymmetricSweep<Space>>;

template <class Space>
class Branched final : public ForwardingEquations, public ForwardDynamics, public MassSolver {
 public:
  Branched(std::shared_ptr<const EquationsOfMotion> own, const Whole<Space>& whole, std::size_t threads)
      : own_(std::move(own)), whole_(whole), sweep_(whole.sweep(), threads), team_(threads) {
    sweep::WorkLayout memory;
    memory.take<std::byte>(own_->make_work().size());
    of_sweep_ = {memory, sweep_.work_size()};
    work_size_ = memory.size();
  }
  [[nodiscard]] double share() const { return sweep_.branches().share; }

  // The memory of the equations themselves stands first: what they find in it, and leave there, is theirs.
  [[nodiscard]] Work make_work() const override { return Work(work_size_); }
  Evaluation derivatives(double t, std::span<const double> y, std::span<double> y_dot,
                         Work& work) const noexcept override {
    [[maybe_unused]] const equations::DenormalsAreZero guard;
    const Layout& order = whole_.layout();
    const std::span<const double> speeds = y.subspan(order.positions, order.speeds);
    const std::span<double> efforts = whole_.applied(t, y, y_dot, work);
    const Evaluation evaluation = sweep_.accelerations(y.data(), speeds.data(), efforts.data(),
                                                       y_dot.data() + order.positions, of_sweep_.in(work), team_);
    if (!evaluation.ok()) return evaluation;
    return whole_.finish(t, y, speeds, efforts, y_dot, evaluation, work);
  }
  Evaluation forward_dynamics(std::span<const double> y, std::span<const double> efforts, std::span<double> u_dot,
                              Work& work) const noexcept override {
    return whole_.forward_dynamics(y, efforts, u_dot, work);
  }
  [[nodiscard]] std::size_t mass_factors_size() const override { return whole_.mass_factors_size(); }
  Evaluation factorize_mass(std::span<const double> y, Work& factors) const noexcept override {
    return whole_.factorize_mass(y, factors);
  }
  void accelerate(std::span<const double> forces, std::span<double> accelerations,
                  Work& factors) const noexcept override {
    whole_.accelerate(forces, accelerations, factors);
  }

 private:
  [[nodiscard]] const EquationsOfMotion& own() const noexcept override { return *own_; }

  std::shared_ptr<const EquationsOfMotion> own_;
  const Whole<Space>& whole_;  ///< the same
  sweep::BranchedSweep<Space> sweep_;
  equations::Region of_sweep_;
  std::size_t work_size_ = 0;
  mutable sweep::ThreadTeam team_;  ///< of one caller at a time
};

/// Why no thread may evaluate a node of these equations; empty where one may.
template <class Space>
std::string refusal_of(const Whole<Space>& whole) {
  if (!whole.terms().products_of_speeds) return "the formulation drops products of speeds";
  const auto& nodes = whole.sweep().nodes();
  if (std::any_of(nodes.begin(), nodes.end(), [](const auto& n) { return n.joint.kind == sweep::Joint::custom; }))
    return "a hinge has code of its own";
  return {};
}

template <class Space>
BranchEquations make_branched(std::shared_ptr<const EquationsOfMotion> equations, const Whole<Space>& whole,
                              std::size_t threads) {
  if (std::string refusal = refusal_of(whole); !refusal.empty()) return {nullptr, std::move(refusal), 1};
  auto branched = std::make_unique<Branched<Space>>(std::move(equations), whole, threads);
  const double share = branched->share();
  constexpr double most = 0.9;
  if (share > most) return {nullptr, "its tree has no two branches of some size", share};
  return {std::move(branched), {}, share};
}

}  // namespace

BranchEquations on_threads(std::shared_ptr<const EquationsOfMotion> equations, std::size_t threads) {
  if (threads < 2 || threads > most_threads)
    throw std::invalid_argument("got " + std::to_string(threads) + " threads; need 2 to " +
                                std::to_string(most_threads));
  if (const auto* planar = dynamic_cast<const Whole<Planar>*>(equations.get()))
    return make_branched(std::move(equations), *planar, threads);
  if (const auto* spatial = dynamic_cast<const Whole<Spatial>*>(equations.get()))
    return make_branched(std::move(equations), *spatial, threads);
  return {nullptr, "the formulation is none of the symmetric ones, or loops are closed, or events lock hinges", 1};
}

double hand_over_seconds(std::size_t threads) {
  sweep::ThreadTeam team(threads);
  // Threads meet twice in an evaluation, and then some lines of the caches go over: states and the trunk's motion to a
  // helper, rates and what it has summed for the trunk back.
  constexpr std::size_t lines = 32, numbers = 8;
  std::vector<double> given(lines * numbers), found(threads * lines * numbers);
  const auto work = [&](std::size_t member) {
    for (std::size_t i = 0; member > 0 && i < lines; ++i) found[(member * lines + i) * numbers] += given[i * numbers];
  };
  double least = std::numeric_limits<double>::infinity();
  constexpr int batches = 200, each = 50, meetings = 2;
  for (int batch = 0; batch < batches; ++batch) {
    const auto began = std::chrono::steady_clock::now();
    for (int i = 0; i < each * meetings; ++i) {
      team.run(work);
      for (std::size_t k = 0; k < threads * lines; ++k) given[k % lines * numbers] = found[k * numbers];
    }
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count() / each);
  }
  return least;
}

}  // namespace withy
