#include "withy/scene/names_alone.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "withy/scene/names.hpp"

namespace withy {
namespace {

/// A part of the scene by its key; an empty map where there is none, or no map.
const Value& part_of(const Value& map, const char* key) {
  static const Value none = Value::map({});
  const Value* const part = map.kind() == Value::Kind::map ? map.find(key) : nullptr;
  return part != nullptr && part->kind() == Value::Kind::map ? *part : none;
}

/// The names that a value gives: one, or those of a list.
std::vector<const Value*> texts_in(const Value* value) {
  std::vector<const Value*> texts;
  if (value == nullptr) return texts;
  if (value->kind() == Value::Kind::text) texts.push_back(value);
  for (const Value& item : value->items())
    if (item.kind() == Value::Kind::text) texts.push_back(&item);
  return texts;
}

/// NAME of NAME.2.
std::string without_number(const std::string& name) {
  const std::size_t dot = name.find_last_not_of("0123456789");
  return dot != std::string::npos && dot + 1 < name.size() && name[dot] == '.' ? name.substr(0, dot) : name;
}

struct NamesAlone {
  const Document& document;
  const SceneNames& names;
  const Checker& checker;

  /// Loads, and what motions and constraints may bring of them.
  [[nodiscard]] std::vector<std::string> loads() const {
    std::vector<std::string> all;
    for (const char* key : {"loads", "motions", "constraints"})
      for (const auto& [name, given] : part_of(document.root, key).members()) all.push_back(name);
    return all;
  }

  void need(const char* what, const Value& name, const std::vector<std::string>& known) const {
    if (known.empty()) return;  // the part that has them is none, which is said
    if (std::find(known.begin(), known.end(), name.text()) == known.end())
      checker.diagnostics().error(
          name.place(), fmt::format("no {} {}{}", what, in_quotes(name.text()), checker.suggest(name.text(), known)));
  }

  /// \param parts whether NAME.2 may be a part of NAME: how many there are, its plugin says when it makes it
  void need_keys(const char* what, const Value& map, const std::vector<std::string>& known, bool parts = false) const {
    if (known.empty()) return;
    for (const auto& [name, given] : map.members())
      if (std::find(known.begin(), known.end(), parts ? without_number(name) : name) == known.end())
        checker.key_error(given.place().path,
                          fmt::format("no {} {}{}", what, in_quotes(name), checker.suggest(name, known)));
  }

  void check_event(const Value& event, const std::vector<std::string>& events) const {
    const std::vector<std::string> hinges = names.hinges.names(), known_loads = loads();
    const Value* const hinge = event.kind() == Value::Kind::map ? event.find("hinge") : nullptr;
    for (const Value* name : texts_in(hinge))
      if (!hinges.empty() && !names.hinges.has(name->text()))
        checker.key_error(event.place().path + "/hinge",
                          fmt::format("no hinge {}{}", in_quotes(name->text()), checker.suggest(name->text(), hinges)));
    const Value& asked = part_of(event, "do");
    for (const char* key : {"lock", "unlock"})
      for (const Value* name : texts_in(asked.find(key))) need("hinge", *name, hinges);
    for (const Value* name : texts_in(asked.find("release"))) need("body", *name, names.bodies.names());
    for (const char* key : {"switch_on", "switch_off"})
      for (const Value* name : texts_in(asked.find(key))) need("load", *name, known_loads);
    const Value* const after = event.kind() == Value::Kind::map ? event.find("after") : nullptr;
    for (const Value* name : texts_in(after))
      if (std::find(events.begin(), events.end(), name->text()) == events.end())
        checker.key_error(event.place().path + "/after",
                          fmt::format("no event {}{}", in_quotes(name->text()), checker.suggest(name->text(), events)));
  }
};

}  // namespace

void check_event_names(const Document& document, const SceneNames& names, const Checker& checker) {
  const Value& events = part_of(document.root, "events");
  std::vector<std::string> known;
  for (const auto& [name, event] : events.members()) known.push_back(name);
  for (const auto& [name, event] : events.members()) NamesAlone{document, names, checker}.check_event(event, known);
}

void check_start_names(const Document& document, const SceneNames& names, const Checker& checker) {
  const Value& initial = part_of(document.root, "initial");
  const NamesAlone alone{document, names, checker};
  alone.need_keys("hinge", part_of(initial, "hinges"), names.hinges.names());
  alone.need_keys("body", part_of(initial, "bodies"), names.bodies.names(), true);
  for (const Value* name : texts_in(initial.find("locked"))) alone.need("hinge", *name, names.hinges.names());
}

}  // namespace withy
