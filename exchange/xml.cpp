#include "xml.hpp"

#include <expat.h>

#include <memory>

#include "withy/scene/scene_error.hpp"

namespace withy::exchange {

const std::string* Element::find(std::string_view key) const {
  for (const auto& [name_of, value] : attributes)
    if (name_of == key) return &value;
  return nullptr;
}

const Element* Element::child(std::string_view child_name) const {
  for (const Element& e : children)
    if (e.name == child_name) return &e;
  return nullptr;
}

namespace {

constexpr std::size_t deepest = 200;

/// Builds the tree from expat's events. Open elements are kept by value and moved into their parents when they end.
struct ElementBuilder {
  XML_Parser parser;
  std::vector<Element> open;
  Element root;
  std::string refused;

  [[nodiscard]] Place here(std::string path) const {
    return {static_cast<int>(XML_GetCurrentLineNumber(parser)),
            static_cast<int>(XML_GetCurrentColumnNumber(parser)) + 1, std::move(path)};
  }
  void refuse(const char* why) {
    refused = why;
    XML_StopParser(parser, XML_FALSE);
  }
};

void XMLCALL begin_element(void* data, const XML_Char* name, const XML_Char** attributes) {
  auto& b = *static_cast<ElementBuilder*>(data);
  if (b.open.size() == deepest) return b.refuse("more than 200 levels of elements");
  Element e{name, {}, {}, {}};
  for (; *attributes != nullptr; attributes += 2) e.attributes.emplace_back(attributes[0], attributes[1]);
  std::string path = (b.open.empty() ? "" : b.open.back().place.path) + '/' + e.name;
  if (const std::string* called = e.find("name")) path += '[' + *called + ']';
  e.place = b.here(std::move(path));
  b.open.push_back(std::move(e));
}

void XMLCALL end_element(void* data, const XML_Char* /*name*/) {
  auto& b = *static_cast<ElementBuilder*>(data);
  Element done = std::move(b.open.back());
  b.open.pop_back();
  (b.open.empty() ? b.root : b.open.back().children.emplace_back()) = std::move(done);
}

void XMLCALL begin_doctype(void* data, const XML_Char* /*name*/, const XML_Char* /*system*/, const XML_Char* /*id*/,
                           int /*internal*/) {
  static_cast<ElementBuilder*>(data)->refuse("a document type declaration; need a document without one");
}

}  // namespace

Element read_xml(std::string_view text, const std::string& file) {
  const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(XML_ParserCreate(nullptr), &XML_ParserFree);
  if (parser == nullptr) throw std::bad_alloc();
  ElementBuilder b{parser.get(), {}, {}, {}};
  XML_SetUserData(parser.get(), &b);
  XML_SetElementHandler(parser.get(), &begin_element, &end_element);
  XML_SetStartDoctypeDeclHandler(parser.get(), &begin_doctype);
  if (XML_Parse(parser.get(), text.data(), static_cast<int>(text.size()), XML_TRUE) == XML_STATUS_OK) return b.root;
  const std::string why = b.refused.empty() ? XML_ErrorString(XML_GetErrorCode(parser.get())) : b.refused;
  throw SceneError(file,
                   {{b.here(b.open.empty() ? "/" : b.open.back().place.path), "not XML as it is read here: " + why}});
}

}  // namespace withy::exchange
