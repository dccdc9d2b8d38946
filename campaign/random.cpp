#include "withy/campaign/random.hpp"

#include <bit>
#include <boost/random/sobol.hpp>

namespace withy::campaign {
namespace {

constexpr std::uint64_t golden = 0x9e3779b97f4a7c15;  // 2⁶⁴ over the golden ratio

std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

}  // namespace

Key::Key(std::uint64_t seed) : state_(mixed(seed + golden)) {}

Key Key::operator[](std::uint64_t branch) const {
  Key key = *this;
  key.state_ = mixed(state_ + golden * (2 * branch + 1));
  key.state_ = mixed(key.state_ ^ branch);
  return key;
}

Key Key::operator[](std::string_view branch) const {
  Key key = *this;
  for (const char c : branch) key = key[static_cast<unsigned char>(c)];
  return key[branch.size() + 256];
}

double unit_interval(std::uint64_t bits) { return (static_cast<double>(bits >> 12) + 0.5) * 0x1p-52; }

double Key::uniform() const { return unit_interval(state_); }

std::uint64_t permuted(const Key& key, std::uint64_t i, std::uint64_t n) {
  constexpr std::uint64_t rounds = 8;
  const int half = (std::bit_width(n - 1) + 1) / 2;
  const std::uint64_t mask = (std::uint64_t{1} << half) - 1;
  do {
    std::uint64_t left = i >> half, right = i & mask;
    for (std::uint64_t round = 0; round < rounds; ++round) {
      const std::uint64_t next = left ^ (key[round][right].bits() & mask);
      left = right;
      right = next;
    }
    i = left << half | right;
  } while (i >= n);
  return i;
}

std::vector<double> sobol_point(const Key& key, std::uint64_t index, std::size_t dimensions) {
  std::vector<double> point(dimensions);
  boost::random::sobol sequence(dimensions);
  if (index > 0) sequence.seed(index - 1);  // the library leaves the origin out
  for (std::size_t d = 0; d < dimensions; ++d) point[d] = unit_interval((index > 0 ? sequence() : 0) ^ key[d].bits());
  return point;
}

}  // namespace withy::campaign
