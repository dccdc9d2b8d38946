#include "withy/apps/withy/variation.hpp"

#include <algorithm>

#include "withy/apps/withy/engine.hpp"

namespace withy::app {

Variation parse_variation(const std::string& text) {
  if (text.empty()) return {"", {""}};
  const auto equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size())
    throw InputError("--over: got '" + text + "'; need PATH=VALUE,VALUE,...");
  Variation v{text.substr(0, equals), {}};
  for (std::size_t begin = equals + 1; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    v.values.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return v;
}

}  // namespace withy::app
