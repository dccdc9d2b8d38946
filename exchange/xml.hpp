/// \file
/// XML text as elements with their places. Nothing outside xml.cpp knows the XML library.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "withy/core/plugin/value.hpp"

namespace withy::exchange {

/// An element. Its place has the line and column of its tag and a path as "/robot/link[arm]/inertial", by names where
/// elements have them.
struct Element {
  std::string name;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<Element> children;
  Place place;

  /// The text of an attribute; null where there is none.
  [[nodiscard]] const std::string* find(std::string_view key) const;
  /// The first child of this name; null where there is none.
  [[nodiscard]] const Element* child(std::string_view child_name) const;
};

/// Reads a document. Refused, besides wrong syntax: document type declarations, and with them entities; more than 200
/// levels. \throws SceneError with the place
Element read_xml(std::string_view text, const std::string& file);

}  // namespace withy::exchange
