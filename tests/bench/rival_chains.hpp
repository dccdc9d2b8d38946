/// \file
/// The rigid chain of chain_bench.cpp as users of Simbody, RBDL and Pinocchio build it; apart, since their headers are
/// not C++20.
#pragma once

#include <memory>
#include <vector>

namespace withy::bench {

/// A random joint: axis and place in the link before it, angle [rad], rate [rad/s].
struct Joint {
  double axis[3], at[3], angle, rate;
};

/// A chain in another program.
class RivalChain {
 public:
  RivalChain() = default;
  virtual ~RivalChain() = default;
  RivalChain(const RivalChain&) = delete;
  RivalChain& operator=(const RivalChain&) = delete;
  /// Forward dynamics with the first angle changed by `offset`.
  virtual void evaluate(double offset) = 0;
  [[nodiscard]] virtual double acceleration(int joint) const = 0;
};

std::unique_ptr<RivalChain> simbody_chain(const std::vector<Joint>& chain);
/// By its articulated-body algorithm.
std::unique_ptr<RivalChain> rbdl_chain(const std::vector<Joint>& chain);
/// Likewise.
std::unique_ptr<RivalChain> pinocchio_chain(const std::vector<Joint>& chain);

}  // namespace withy::bench
