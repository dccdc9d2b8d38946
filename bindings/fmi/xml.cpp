#include "withy/bindings/fmi/xml.hpp"

#include <fmt/format.h>

namespace withy::fmi {

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\n':
      case '\t':
      case '\r':
        out += ' ';
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string number_text(double x) { return fmt::format("{}", x); }

void Xml::begin(const std::string& name, const Attributes& attributes) {
  text_ += std::string(2 * inside_.size(), ' ') + '<' + name;
  for (const auto& [key, value] : attributes) text_ += fmt::format(" {}=\"{}\"", key, escaped(value));
}

Xml& Xml::open(const std::string& name, const Attributes& attributes) {
  begin(name, attributes);
  text_ += ">\n";
  inside_.push_back(name);
  return *this;
}

Xml& Xml::close() {
  const std::string name = std::move(inside_.back());
  inside_.pop_back();
  text_ += std::string(2 * inside_.size(), ' ') + "</" + name + ">\n";
  return *this;
}

Xml& Xml::empty(const std::string& name, const Attributes& attributes) {
  begin(name, attributes);
  text_ += "/>\n";
  return *this;
}

}  // namespace withy::fmi
