/// \file
/// Writes XML: elements with attributes, nested.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace withy::fmi {

/// A text as it stands in an attribute or between tags.
std::string escaped(std::string_view text);
/// A number that reads back to the same bits.
std::string number_text(double x);

class Xml {
 public:
  using Attributes = std::vector<std::pair<std::string, std::string>>;

  Xml() : text_("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n") {}
  /// An element that holds others, until `close`.
  Xml& open(const std::string& name, const Attributes& attributes = {});
  Xml& close();
  /// An element that holds nothing.
  Xml& empty(const std::string& name, const Attributes& attributes = {});
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void begin(const std::string& name, const Attributes& attributes);
  std::string text_;
  std::vector<std::string> inside_;
};

}  // namespace withy::fmi
