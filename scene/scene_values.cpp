#include "withy/scene/scene_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "withy/scene/asked_outputs.hpp"
#include "withy/scene/describe.hpp"
#include "withy/scene/grammar.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/scene.hpp"
#include "withy/scene/sha256.hpp"
#include "withy/scene/value_path.hpp"

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

void lengthen_choices(Value& root) {
  if (root.kind() != Value::Kind::map) return;
  lengthen_choice(root, "formulation");
  if (const Value* given = root.find("formulation")) root.set("formulation", grammar::named_formulation(*given));
  lengthen_choice(root, "integrator");
}

/// True where members are things with names of the user's: an operation on one of their values makes no new ones.
bool holds_user_names(const std::vector<std::string>& path, std::size_t depth) {
  if (depth == 1) return path[0] == "bodies" || path[0] == "hinges" || path[0] == "loads" || path[0] == "motions";
  return depth == 3 && path[0] == "bodies" && path[2] == "frames";
}

/// Whether a value is all of a thing with a name: a map that says of what type it is, or of a frame any map.
bool defines(const std::vector<std::string>& path, const Value& value) {
  return value.kind() == Value::Kind::map && (path.size() > 2 || value.has("type"));
}

/// How a thing with a name is made, in a clause behind others.
std::string how_to_add(const std::vector<std::string>& path) {
  return fmt::format("; to add it, give all of it, as {}", path.size() > 2 ? "{position: [1, 0, 0]}" : "{type: …}");
}

/// The keys of "bodies.hub.mass"; none where one is empty or too long.
std::vector<std::string> split(std::string_view path) {
  std::vector<std::string> keys = keys_of_path(path);
  const auto bad = [](const std::string& key) { return key.empty() || key.size() > DocumentLimits::key_bytes; };
  if (std::any_of(keys.begin(), keys.end(), bad)) keys.clear();
  return keys;
}

/// A name, or a list of names.
bool is_names(const Value& value) {
  const auto& items = value.items();
  return value.kind() == Value::Kind::text ||
         (!items.empty() &&
          std::all_of(items.begin(), items.end(), [](const Value& item) { return item.kind() == Value::Kind::text; }));
}

std::string joined(const std::vector<std::string>& keys) {
  std::string path;
  for (const std::string& key : keys) path += "/" + key;
  return path;
}

/// What is wrong with a path; empty where it is right.
std::string path_problem(const std::vector<std::string>& keys) {
  if (keys.empty()) return "need a path of keys with dots between them, as time.end=2";
  return keys.size() > static_cast<std::size_t>(DocumentLimits::depth) ? "the path is too long" : "";
}

/// As "time.end = 2" is written: no key begins or ends with a blank.
std::string_view without_blanks(std::string_view path) {
  const std::size_t first = path.find_first_not_of(' '), last = path.find_last_not_of(' ');
  return first == std::string_view::npos ? std::string_view() : path.substr(first, last - first + 1);
}

}  // namespace

SceneValues SceneValues::read(const std::string& file) { return parse(read_bytes(file), file); }

SceneValues SceneValues::parse(std::string_view text, const std::string& name) {
  return parse(text, name, whole(std::filesystem::path(name).parent_path().string()));
}

SceneValues SceneValues::parse(std::string_view text, const std::string& name, const std::string& folder) {
  SceneValues values;
  values.file_ = name;
  values.text_ = text;
  values.sha256_ = withy::sha256(text);
  values.document_.directory = std::filesystem::path(name).parent_path().string();
  values.document_.whole_directory = folder;
  if (!read_document(text, {}, values.document_, values.diagnostics_))
    throw SceneError(name, values.diagnostics_.errors());
  lengthen_choices(values.document_.root);
  return values;
}

int SceneValues::add_origin(std::string origin) {
  origins_.push_back(std::move(origin));
  return -static_cast<int>(origins_.size());
}

/// The value a path leads to, made where it is missing; null after reporting.
Value* SceneValues::target(const std::vector<std::string>& keys, int line, const Value& value) {
  const auto error = [&](const std::string& path, std::string message) {
    diagnostics_.error({line, 0, path}, std::move(message));
  };
  Value* at = &document_.root;
  std::string path;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const std::string& key = keys[i];
    if (at->kind() == Value::Kind::null) *at = Value::map({}, {line, 0, path});
    if (at->kind() == Value::Kind::list) {
      const auto index = list_index(key, at->items().size());
      if (!index) {
        error(path,
              fmt::format("got index {}; need 0 to {}", in_quotes(key), static_cast<long>(at->items().size()) - 1));
        return nullptr;
      }
      at->set_place({line, 0, path});  // what is wrong with the whole of it may be of what is put there
      at = &at->items()[*index];
      path += "/" + key;
      continue;
    }
    if (at->kind() != Value::Kind::map) {
      error(path, fmt::format("got {}; need a map or list to find {} in", shown(*at), in_quotes(key)));
      return nullptr;
    }
    if (!at->has(key)) {
      if (holds_user_names(keys, i) && !(i + 1 == keys.size() && defines(keys, value))) {
        error(path, fmt::format("no {} here to change{}{}", in_quotes(key), suggestion(key, keys_of(*at)),
                                i + 1 == keys.size() ? how_to_add(keys) : ""));
        return nullptr;
      }
      at->set(key, Value());
      document_.keys[path + "/" + key] = {line, 0, {}};
    }
    path += "/" + key;
    at = &std::find_if(at->members().begin(), at->members().end(), [&](const auto& m) {
            return m.first == key;
          })->second;
  }
  return at;
}

/// Takes away what is at the path, so that it is as if the scene had never said it.
void SceneValues::take_away(const std::vector<std::string>& keys, int line) {
  Value* at = &document_.root;
  std::string path;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto found = std::find_if(at->members().begin(), at->members().end(),
                                    [&](const auto& member) { return member.first == keys[i]; });
    if (found == at->members().end()) {
      diagnostics_.error(
          {line, 0, path},
          at->kind() == Value::Kind::list
              ? "an element of a list cannot be taken away; give the whole list without it"
              : fmt::format("no {} here to take away{}", in_quotes(keys[i]), suggestion(keys[i], keys_of(*at))));
      return;
    }
    path += "/" + keys[i];
    if (i + 1 == keys.size())
      at->members().erase(found);
    else
      at = &found->second;
  }
  std::erase_if(document_.keys,
                [&](const auto& entry) { return entry.first == path || entry.first.starts_with(path + "/"); });
}

/// Puts the document read in the place of what is at the path.
void SceneValues::put(const std::vector<std::string>& keys, Document read, int line) {
  if (document_.root.kind() != Value::Kind::map) return;  // make_scene says what the scene has to be
  if (read.root.kind() == Value::Kind::null) return take_away(keys, line);
  if (keys.size() == 1 && keys[0] == "outputs" && is_names(read.root)) {
    const std::vector<Value> one{read.root};
    for (const Value& name : read.root.items().empty() ? one : read.root.items()) {
      if (defines_output(document_.root, name.text())) continue;
      const std::optional<AskedOutput> asked = asked_output(document_.root, name.text());
      if (!asked) {
        const std::string problem = problem_of_place(document_.root, name.text());
        diagnostics_.error({line, 0, "/outputs"},
                           !problem.empty() ? problem
                                            : fmt::format("got {}, which names no output{}", in_quotes(name.text()),
                                                          suggestion(name.text(), asked_names(document_.root))));
        continue;
      }
      const Place place{line, 0, "/outputs/" + asked->name};
      put({"outputs", asked->name}, {placed(asked->definition, place), {}, {}}, line);
    }
    return;
  }
  Value* at = target(keys, line, read.root);
  if (at == nullptr) return;
  const std::string path = joined(keys);
  const bool holds_keys = !std::as_const(*at).members().empty() || !std::as_const(*at).items().empty();
  *at = std::move(read.root);
  if (holds_keys) std::erase_if(document_.keys, [&](const auto& entry) { return entry.first.starts_with(path + "/"); });
  document_.keys.merge(read.keys);
  document_.keys[path] = {line, 0, {}};
  lengthen_choices(document_.root);  // the short form may have been given again
}

SceneValues& SceneValues::set(std::string_view path, Value value, const std::string& origin) {
  const int line = add_origin(origin);
  const std::vector<std::string> keys = split(path);
  if (const std::string problem = path_problem(keys); !problem.empty()) {
    diagnostics_.error({line, 0, ""}, problem);
  } else {
    put(keys, {placed(std::move(value), {line, 0, joined(keys)}), {}, {}}, line);
  }
  return *this;
}

void SceneValues::set_again(const SceneValues& base) {
  origins_.resize(base.origins_.size());
  diagnostics_ = base.diagnostics_;
}

SceneValues& SceneValues::set_text(const std::string& text, std::string origin) {
  const int line = add_origin(origin.empty() ? fmt::format("--set '{}'", text) : std::move(origin));
  settings_.push_back(text);
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    diagnostics_.error({line, 0, ""}, "need path=value, as time.end=2");
    return *this;
  }
  const std::vector<std::string> keys = split(without_blanks(std::string_view(text).substr(0, equals)));
  if (const std::string problem = path_problem(keys); !problem.empty()) {
    diagnostics_.error({line, 0, ""}, problem);
    return *this;
  }
  Document read;
  if (read_document(std::string_view(text).substr(equals + 1), {line, joined(keys)}, read, diagnostics_))
    put(keys, std::move(read), line);
  return *this;
}

void SceneValues::put_choice(const char* key, Value choice, const std::string& origin) {
  const int line = add_origin(origin);
  put({key}, {placed(std::move(choice), {line, 0, std::string("/") + key}), {}, {}}, line);
}

void SceneValues::choose(const char* key, const std::string& id, const std::string& origin) {
  const Value* given = document_.root.find(key);
  const Value* name = given == nullptr ? nullptr : given->find("name");
  if (name != nullptr && name->kind() == Value::Kind::text && name->text() == id) {
    origins_.push_back(origin);
    return;
  }
  put_choice(key, Value::map({{"name", Value(id)}}), origin);
}

SceneValues& SceneValues::choose_formulation(const std::string& id, const std::string& origin) {
  choose("formulation", id, origin);
  return *this;
}
SceneValues& SceneValues::choose_integrator(const std::string& id, const std::string& origin) {
  choose("integrator", id, origin);
  return *this;
}
SceneValues& SceneValues::choose_formulation(Value choice, const std::string& origin) {
  put_choice("formulation", std::move(choice), origin);
  return *this;
}
SceneValues& SceneValues::choose_integrator(Value choice, const std::string& origin) {
  put_choice("integrator", std::move(choice), origin);
  return *this;
}

SceneValues& SceneValues::body_formulation(const std::string& body, const std::string& id, const std::string& origin) {
  return set("bodies." + body + ".formulation", Value(id), origin);
}

SceneValues& SceneValues::initial(const Model& model, const State& state, const std::string& origin) {
  return set("initial", state_value(model, state), origin);
}

SceneValues& SceneValues::motions(Value motions, const std::string& origin) {
  return set("motions", std::move(motions), origin);
}

SceneValues& SceneValues::apply(const SceneOptions& options) {
  if (!options.formulation.empty())
    choose_formulation(options.formulation, fmt::format("--formulation '{}'", options.formulation));
  if (!options.integrator.empty())
    choose_integrator(options.integrator, fmt::format("--integrator '{}'", options.integrator));
  for (const std::string& text : options.overrides) set_text(text);
  return *this;
}

const Value* SceneValues::find(std::string_view path) const { return value_at(document_.root, path); }

}  // namespace withy
