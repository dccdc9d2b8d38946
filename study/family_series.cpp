#include "withy/study/family_series.hpp"

namespace withy::study {

const Reference* FamilySeries::richest(const std::string& family) const {
  const auto runs = runs_.find(family);
  return runs == runs_.end() ? nullptr : &runs->second.rbegin()->second;
}

bool FamilySeries::has(const std::string& family, int modes) const {
  const auto runs = runs_.find(family);
  return runs != runs_.end() && runs->second.contains(modes);
}

std::vector<Reference> FamilySeries::from(const std::string& family, int modes) const {
  std::vector<Reference> all;
  const auto runs = runs_.find(family);
  if (runs == runs_.end()) return all;
  for (auto at = runs->second.lower_bound(modes); at != runs->second.end(); ++at) all.push_back(at->second);
  return all;
}

ModeSeries FamilySeries::series(const std::string& family, int from) const {
  ModeSeries series(outputs_, kinds_);
  for (const Reference& run : this->from(family, from)) series.add(run.point.modes, run.readings);
  return series;
}

}  // namespace withy::study
