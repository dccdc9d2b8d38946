#include "withy/results/blade_branches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace withy {
namespace {

/// Of every branch that was followed, by its number, what it is at each value.
using Followed = std::map<std::size_t, std::vector<const study::NamedMode*>>;

/// The mode on which it begins.
const study::NamedMode& first_of(const std::vector<const study::NamedMode*>& at) {
  return **std::find_if(at.begin(), at.end(), [](const study::NamedMode* m) { return m != nullptr; });
}

}  // namespace

std::vector<BladeBranch> blade_branches(const study::ModesOf& run, std::size_t count) {
  Followed followed;
  std::set<std::size_t> shown;
  for (std::size_t k = 0; k < run.points.size(); ++k) {
    const study::ModesAt& at = run.points[k];
    if (!at.turn || !at.turn->blades) continue;
    const study::BladeModes& seen = *at.turn->blades;
    std::size_t lowest = 0;  // they are in the order of |λ|
    for (std::size_t i = 0; i < seen.branches.size(); ++i) {
      const study::NamedMode& m = seen.modes[i];
      if (m.exponent == 0.0) continue;
      auto& values = followed[seen.branches[i]];
      values.resize(run.points.size());
      values[k] = &m;
      if (lowest++ < count || grows(seen, m)) shown.insert(seen.branches[i]);
    }
  }
  std::vector<BladeBranch> all;
  std::map<std::string, int> met;
  for (auto& [number, at] : followed) {
    if (!shown.contains(number)) continue;
    const std::string& name = first_of(at).dominated_by;
    const int nth = ++met[name];
    all.push_back({number, nth > 1 ? fmt::format("{} ({})", name, nth) : name, std::move(at)});
  }
  return all;
}

double growth_resolution(const study::BladeModes& seen) {
  double greatest = 0;
  for (const study::NamedMode& m : seen.modes) greatest = std::max(greatest, std::abs(m.exponent));
  return 1e-10 * greatest;
}

bool grows(const study::BladeModes& seen, const study::NamedMode& mode) {
  return mode.exponent.real() > growth_resolution(seen);
}

std::size_t blades_seen(const study::ModesOf& run) {
  for (const study::ModesAt& at : run.points)
    if (at.turn && at.turn->blades) return at.turn->blades->blades.size();
  return 0;
}

}  // namespace withy
