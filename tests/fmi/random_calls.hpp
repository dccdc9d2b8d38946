/// \file
/// Calls by chance, in and out of order, with good and bad arguments: what both standards' tests of it share.
#pragma once

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "withy/tests/fmi/importer.hpp"

namespace withy::test {

/// Arguments that are right, wrong and missing, by chance.
class Chance {
 public:
  Chance(unsigned seed, const Unpacked& fmu) : random_(seed), variables_(fmu.variables.size()) {}
  bool rarely() { return random_() % 12 == 0; }
  std::size_t below(std::size_t n) { return random_() % n; }
  double number() {
    constexpr double some[] = {0, 0.1, -0.3, 1, 2.5, 1e-3};
    return rarely() ? (below(2) == 0 ? std::nan("") : 1e300) : some[below(std::size(some))];
  }
  /// Of time to go: 1e300 s would be gone, step by step.
  double step() {
    if (!rarely()) return 0.01;
    const double h = number();
    return h > 10 ? 0 : h;
  }
  template <class T>
  T* maybe(T* pointer) {
    return rarely() ? nullptr : pointer;
  }
  std::vector<std::uint32_t> references() {
    std::vector<std::uint32_t> all(below(4));
    for (auto& r : all) r = static_cast<std::uint32_t>(rarely() ? random_() : below(variables_));
    return all;
  }
  double* array() {
    for (double& x : numbers_) x = number();
    return maybe(numbers_.data());
  }
  /// For what comes after the 32 numbers of `array`.
  double* more() { return numbers_.data() + 32; }
  std::size_t count(std::size_t right) { return rarely() ? right + 1 : right; }

 private:
  std::mt19937 random_;
  std::size_t variables_;
  std::vector<double> numbers_ = std::vector<double>(64);
};

template <class Status>
using Calls = std::vector<std::function<Status()>>;

template <class Status>
Calls<Status> joined(const std::vector<Calls<Status>>& groups) {
  Calls<Status> all;
  for (const Calls<Status>& group : groups) all.insert(all.end(), group.begin(), group.end());
  return all;
}

/// Sequences of calls, each after `begin`. \returns how many calls were in order
template <class Status>
std::size_t play(Chance& chance, const Calls<Status>& calls, std::size_t sequences, const Heard& heard,
                 const std::function<void()>& begin) {
  std::size_t good = 0;
  for (std::size_t s = 0; s < sequences; ++s) {
    begin();
    for (int k = 0; k < 12; ++k) {
      const int lines = heard.lines;
      const auto status = static_cast<int>(calls[chance.below(calls.size())]());
      EXPECT_TRUE(status == 0 || status == 2 || status == 3) << status;
      EXPECT_TRUE(status == 0 || heard.lines > lines) << "an error without a sentence";
      good += status == 0 ? 1 : 0;
    }
  }
  return good;
}

}  // namespace withy::test
