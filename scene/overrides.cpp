#include "withy/scene/overrides.hpp"

#include <fmt/format.h>

#include <charconv>

#include "withy/scene/check.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/scene.hpp"

namespace withy {
namespace {

/// `formulation: quadratic` means `formulation: {name: quadratic}`.
void lengthen_choice(Value& root, const std::string& key) {
  const Value* given = root.find(key);
  if (given == nullptr || given->kind() != Value::Kind::text) return;
  Value name = *given;
  Place place = given->place();
  name.set_place({place.line, place.column, place.path + "/name"});
  root.set(key, Value::map({{"name", std::move(name)}}, std::move(place)));
}

/// A plugin chosen on the command line; options in the file stay where they are that plugin's.
void choose(Document& document, const std::string& key, const std::string& id, int line) {
  const Value* given = document.root.find(key);
  const Value* name = given == nullptr ? nullptr : given->find("name");
  if (name != nullptr && name->kind() == Value::Kind::text && name->text() == id) return;
  const Place place{line, 0, "/" + key};
  document.keys[place.path] = place;
  document.root.set(key, placed(Value::map({{"name", Value(id)}}), place));
}

/// True where members are things with names of the user's: an override changes them but makes no new ones.
bool holds_user_names(const std::vector<std::string>& path, std::size_t depth) {
  if (depth == 1) return path[0] == "bodies" || path[0] == "hinges" || path[0] == "loads" || path[0] == "motions";
  return depth == 3 && path[0] == "bodies" && path[2] == "frames";
}

class Override {
 public:
  Override(Document& document, int line, Diagnostics& diagnostics)
      : document_(document), line_(line), diagnostics_(diagnostics) {}

  void apply(const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) return error("", "need path=value, as time.end=2");
    std::string path;
    std::vector<std::string> keys;
    for (std::size_t start = 0; start <= equals;) {
      const std::size_t stop = std::min(text.find('.', start), equals);
      keys.push_back(text.substr(start, stop - start));
      path += "/" + keys.back();
      start = stop + 1;
      if (keys.back().empty() || keys.back().size() > DocumentLimits::key_bytes) {
        return error("", "need a path of keys with dots between them, as time.end=2");
      }
    }
    if (keys.size() > static_cast<std::size_t>(DocumentLimits::depth)) return error("", "the path is too long");
    Document read;
    if (!read_document(std::string_view(text).substr(equals + 1), {line_, path}, read, diagnostics_)) return;
    Value* target = find(keys);
    if (target == nullptr) return;
    *target = std::move(read.root);
    std::erase_if(document_.keys, [&](const auto& entry) { return entry.first.starts_with(path + "/"); });
    document_.keys.merge(read.keys);
    document_.keys[path] = {line_, 0, path};
  }

 private:
  void error(const std::string& path, std::string message) { diagnostics_.error({line_, 0, path}, std::move(message)); }

  /// The value a path leads to, made where the file does not have it; null after reporting.
  Value* find(const std::vector<std::string>& keys) {
    Value* at = &document_.root;
    std::string path;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      const std::string& key = keys[i];
      if (at->kind() == Value::Kind::null) *at = Value::map({}, {line_, 0, path});
      if (at->kind() == Value::Kind::list) {
        std::size_t index = 0;
        const auto [end, problem] = std::from_chars(key.data(), key.data() + key.size(), index);
        if (problem != std::errc() || end != key.data() + key.size() || index >= at->items().size()) {
          error(path,
                fmt::format("got index {}; need 0 to {}", in_quotes(key), static_cast<long>(at->items().size()) - 1));
          return nullptr;
        }
        at = &at->items()[index];
        path += "/" + key;
        continue;
      }
      if (at->kind() != Value::Kind::map) {
        error(path, fmt::format("got {}; need a map or list to find {} in", shown(*at), in_quotes(key)));
        return nullptr;
      }
      if (!at->has(key)) {
        if (holds_user_names(keys, i)) {
          error(path, fmt::format("no {} here to change{}", in_quotes(key), suggestion(key, keys_of(*at))));
          return nullptr;
        }
        at->set(key, Value());
        document_.keys[path + "/" + key] = {line_, 0, path + "/" + key};
      }
      path += "/" + key;
      for (auto& [name, member] : at->members()) {
        if (name == key) {
          at = &member;
          break;
        }
      }
    }
    return at;
  }

  Document& document_;
  int line_;
  Diagnostics& diagnostics_;
};

}  // namespace

std::vector<std::string> apply_options(Document& document, const SceneOptions& options, Diagnostics& diagnostics) {
  std::vector<std::string> origins;
  const auto add = [&](std::string description) {
    origins.push_back(std::move(description));
    return -static_cast<int>(origins.size());
  };
  const auto choice = [&](const std::string& key, const std::string& id) {
    lengthen_choice(document.root, key);
    if (!id.empty()) choose(document, key, id, add(fmt::format("--{} '{}'", key, id)));
  };
  if (document.root.kind() != Value::Kind::map) return origins;
  choice("formulation", options.formulation);
  choice("integrator", options.integrator);
  for (const std::string& text : options.overrides) {
    Override(document, add(fmt::format("--set '{}'", text)), diagnostics).apply(text);
    // An override may have given the short form again.
    lengthen_choice(document.root, "formulation");
    lengthen_choice(document.root, "integrator");
  }
  return origins;
}

}  // namespace withy
