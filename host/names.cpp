#include "withy/host/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "withy/results/csv.hpp"
#include "withy/scene/names.hpp"

namespace withy::host {

std::size_t index_of(std::span<const Port> ports, std::string_view name, const char* what) {
  auto found = std::find_if(ports.begin(), ports.end(), [&](const Port& p) { return p.name == name; });
  // As results.csv, where brackets hold units alone, calls "link1.bending_y[1]".
  if (found == ports.end())
    found = std::find_if(ports.begin(), ports.end(), [&](const Port& p) { return column_name(p.name) == name; });
  if (found != ports.end()) return static_cast<std::size_t>(found - ports.begin());
  std::vector<std::string> names;
  for (const Port& p : ports) names.push_back(p.name);
  const std::string near = nearest(name, names);
  throw std::out_of_range(
      fmt::format("no {} {}", what, in_quotes(name)) +
      (near.empty() ? "; known: " + (names.empty() ? "none" : listed(names)) : "; did you mean '" + near + "'?"));
}

}  // namespace withy::host
