/// \file
/// Random numbers that are looked up, not drawn one after the other: each depends on the keys that lead to it alone, so
/// that any case of a plan is made without those before it.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace withy::campaign {

/// A place in a tree of random numbers: `Key(seed)["bodies.hub.mass"][17]`. Hashes by the finalizer of SplitMix64
/// (Steele, Lea and Flood, 2014).
class Key {
 public:
  explicit Key(std::uint64_t seed);
  Key operator[](std::uint64_t branch) const;
  Key operator[](std::string_view branch) const;
  /// 64 random bits.
  [[nodiscard]] std::uint64_t bits() const { return state_; }
  /// Of the open interval from 0 to 1, with 52 random bits.
  [[nodiscard]] double uniform() const;

 private:
  std::uint64_t state_;
};

/// The number of the open interval from 0 to 1 with these leading 52 bits, in the middle of those that share them.
double unit_interval(std::uint64_t bits);

/// Where a random permutation of 0 … n−1 takes i, without making the permutation: a Feistel network over the next power
/// of four, gone through until the image is below n (Black and Rogaway, 2002).
std::uint64_t permuted(const Key& key, std::uint64_t i, std::uint64_t n);

/// Point `index` of the Sobol sequence, counted from the origin, in the open unit cube. A random digital shift, which
/// keeps the sequence's balance, tells keys apart.
std::vector<double> sobol_point(const Key& key, std::uint64_t index, std::size_t dimensions);

/// Dimensions that the table of direction numbers has.
inline constexpr std::size_t most_sobol_dimensions = 3667;

}  // namespace withy::campaign
