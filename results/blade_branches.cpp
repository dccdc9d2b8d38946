#include "withy/results/blade_branches.hpp"

#include <fmt/format.h>

#include <map>

namespace withy {

std::vector<BladeBranch> blade_branches(const study::ModesOf& run, std::size_t count) {
  std::map<std::string, std::vector<const study::NamedMode*>> branches;
  for (std::size_t k = 0; k < run.points.size(); ++k) {
    const study::ModesAt& at = run.points[k];
    if (!at.turn || !at.turn->blades) continue;
    std::map<std::string, int> met;
    std::size_t shown = 0;
    for (const study::NamedMode& m : at.turn->blades->modes) {
      if (!(m.exponent.imag() > 0) || shown++ >= count) continue;
      const int nth = ++met[m.dominated_by];
      auto& values = branches[m.dominated_by + (nth > 1 ? fmt::format(" ({})", nth) : "")];
      values.resize(run.points.size());
      values[k] = &m;
    }
  }
  std::vector<BladeBranch> all;
  for (auto& [name, at] : branches) all.push_back({name, std::move(at)});
  return all;
}

std::size_t blades_seen(const study::ModesOf& run) {
  for (const study::ModesAt& at : run.points)
    if (at.turn && at.turn->blades) return at.turn->blades->blades.size();
  return 0;
}

}  // namespace withy
