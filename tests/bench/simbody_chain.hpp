/// \file
/// The rigid chain of chain_bench.cpp as Simbody's user builds it; apart, since its headers are not C++20.
#pragma once

#include <memory>
#include <vector>

namespace withy::bench {

/// A random joint: axis and place in the link before it, angle [rad], rate [rad/s].
struct Joint {
  double axis[3], at[3], angle, rate;
};

class SimbodyChain {
 public:
  explicit SimbodyChain(const std::vector<Joint>& chain);
  ~SimbodyChain();
  SimbodyChain(const SimbodyChain&) = delete;
  SimbodyChain& operator=(const SimbodyChain&) = delete;
  /// Forward dynamics with the first angle changed by `offset`.
  void evaluate(double offset);
  [[nodiscard]] double acceleration(int joint) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace withy::bench
