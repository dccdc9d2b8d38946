#include "withy/results/formulation_words.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "withy/core/plugin/formulation.hpp"

namespace withy {

std::string formulation_words(const std::vector<std::string>& names, Registry& registry) {
  std::size_t width = 0;
  for (const std::string& name : names) width = std::max(width, name.size());
  std::string text;
  for (auto name = names.begin(); name != names.end(); ++name) {
    if (std::find(names.begin(), name, *name) != name) continue;
    if (const auto* plugin = registry.find<Formulation>(*name))
      text += fmt::format("{:<{}}  {}\n", *name, width, plugin->summary);
  }
  return text.empty() ? text : '\n' + text;
}

}  // namespace withy
