#include "withy/results/scene_edit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/output_name.hpp"
#include "withy/scene/document.hpp"
#include "withy/scene/same_content.hpp"
#include "withy/scene/scene.hpp"
#include "withy/scene/value_path.hpp"
#include "withy/study/input_error.hpp"

namespace withy {
namespace {

Document read(const std::string& text, const std::string& what) {
  Document document;
  Diagnostics diagnostics;
  if (!read_document(text, {}, document, diagnostics))
    throw study::InputError(what + ": " + diagnostics.errors().front().message);
  return document;
}

/// Index in the text of a place's line and column.
std::size_t offset(const std::string& text, const Place& place) {
  std::size_t at = 0;
  for (int line = 1; line < place.line; ++line) at = text.find('\n', at) + 1;
  return at + static_cast<std::size_t>(place.column - 1);
}

std::size_t line_end(const std::string& text, std::size_t at) { return std::min(text.find('\n', at), text.size()); }

/// Past the quoted text that begins here.
std::size_t past_quoted(const std::string& text, std::size_t at) {
  const char quote = text[at++];
  for (; at < text.size() && text[at] != quote; ++at)
    if (quote == '"' && text[at] == '\\') ++at;
  return std::min(at + 1, text.size());
}

bool opens_comment(const std::string& text, std::size_t at) {
  return text[at] == '#' && (at == 0 || text[at - 1] == ' ' || text[at - 1] == '\n');
}

/// Past the value that begins here: a bracketed one, a quoted one, or a plain scalar on one line.
std::size_t past_value(const std::string& text, std::size_t at, bool in_braces) {
  if (text[at] == '"' || text[at] == '\'') return past_quoted(text, at);
  if (text[at] == '{' || text[at] == '[') {
    int depth = 0;
    while (at < text.size()) {
      const char c = text[at];
      if (c == '"' || c == '\'') {
        at = past_quoted(text, at);
        continue;
      }
      if (opens_comment(text, at)) at = line_end(text, at);
      if (c == '{' || c == '[') ++depth;
      if ((c == '}' || c == ']') && --depth == 0) return at + 1;
      ++at;
    }
    return at;
  }
  std::size_t end = at;
  while (end < text.size() && text[end] != '\n' && !opens_comment(text, end) &&
         !(in_braces && std::string_view(",}]").find(text[end]) != std::string_view::npos))
    ++end;
  while (end > at && text[end - 1] == ' ') --end;
  return end;
}

/// One change of a text that is read anew for each.
class Edit {
 public:
  Edit(std::string text, const std::string& override_text) : text_(std::move(text)) {
    const std::size_t equals = override_text.find('=');
    keys_ = keys_of_path(override_text.substr(0, equals));
    value_ = override_text.substr(equals + 1);
    const std::size_t first = text_.find_first_not_of(" \n\r\t");
    json_ = first != std::string::npos && text_[first] == '{';
    if (json_) value_ = value_json(read(value_, override_text).root).dump();
  }

  std::string made() {
    const Document document = read(text_, "the scene");
    const Value* at = &document.root;
    bool in_braces = json_;
    std::string path;
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      if (at->kind() == Value::Kind::list) throw study::InputError("--write: " + path + " is a list");
      in_braces = in_braces || (i > 0 && text_[offset(text_, at->place())] == '{');
      const Value* next = at->find(keys_[i]);
      if (next == nullptr) return inserted(*at, i);
      path += "/" + keys_[i];
      at = next;
    }
    const bool block = at->kind() == Value::Kind::map && text_[offset(text_, at->place())] != '{';
    if (block) return with_block_replaced(document.keys.at(path));
    const std::size_t begin = offset(text_, at->place()), end = past_value(text_, begin, in_braces);
    return text_.replace(begin, end - begin, value_);
  }

 private:
  /// The value under the keys from `first` on: "a: {b: value}".
  [[nodiscard]] std::string member(std::size_t first) const {
    std::string out = value_;
    for (std::size_t i = keys_.size(); i-- > first;) {
      out = (json_ ? '"' + keys_[i] + '"' : keys_[i]) + ": " + out;
      if (i > first) out = "{" + out + "}";
    }
    return out;
  }

  std::string inserted(const Value& map, std::size_t first) {
    const std::size_t begin = offset(text_, map.place());
    if (text_[begin] == '{') return text_.insert(begin + 1, member(first) + (map.members().empty() ? "" : ", "));
    // The scene's own keys after its head, others before the first of their map.
    std::size_t at = begin;
    if (first == 0) {
      const Document document = read(text_, "the scene");
      at = offset(text_, document.keys.at("/bodies"));
    }
    const std::string indent(at - (text_.rfind('\n', at) + 1), ' ');
    return text_.insert(at, member(first) + '\n' + indent);
  }

  /// A map in lines of its own becomes one line.
  std::string with_block_replaced(const Place& key) {
    const std::size_t begin = offset(text_, key);
    std::size_t end = line_end(text_, begin);
    while (end < text_.size()) {
      const std::size_t first = text_.find_first_not_of(' ', end + 1);
      const bool inside = first != std::string::npos && text_[first] != '\n' && text_[first] != '#' &&
                          first - end - 1 >= static_cast<std::size_t>(key.column);
      if (!inside) break;
      end = line_end(text_, first);
    }
    return text_.replace(begin, end - begin, member(keys_.size() - 1));
  }

  std::string text_;
  std::vector<std::string> keys_;
  std::string value_;
  bool json_ = false;
};

using Json = nlohmann::ordered_json;

std::string in_braces(const Json& value) {
  if (!value.is_object()) return value.get<std::string>();
  std::string out;
  for (const auto& [key, member] : value.items()) out += (out.empty() ? "" : ", ") + key + ": " + in_braces(member);
  return "{" + out + "}";
}

void add_lines(std::string& out, const Json& map, int depth) {
  for (const auto& [key, value] : map.items()) {
    const bool lines = value.is_object() && depth < 2;
    out += std::string(static_cast<std::size_t>(2 * depth), ' ') + key + ":" + (lines ? "" : " " + in_braces(value)) +
           '\n';
    if (lines) add_lines(out, value, depth + 1);
  }
}

/// Without what a command line changes.
SceneValues as_in_file(const SceneValues& scene) {
  return SceneValues::parse(scene.text(), scene.file(), scene.document().whole_directory);
}

/// Outputs that a command line asks for beside the file's make no other scene.
Value without_outputs(const SceneValues& scene) {
  Value root = scene.root();
  std::erase_if(root.members(), [](const auto& member) { return member.first == "outputs"; });
  return root;
}

}  // namespace

std::string edited(std::string text, const std::vector<std::string>& overrides) {
  for (const std::string& o : overrides) text = Edit(std::move(text), o).made();
  return text;
}

void check_written(const study::Prepared& prepared, const std::string& file, const std::string& also,
                   Registry& registry) {
  keep_inputs(file, files_of(prepared.scene, also));
  const SceneValues& scene = prepared.values;
  if (!same_content(without_outputs(as_in_file(scene)), without_outputs(scene)))
    throw study::InputError("--write takes the scene as its file has it: leave out --formulation and --integrator");
  // What the scene names has to be found from the new file's folder, too.
  make_scene(SceneValues::parse(scene.text(), file), registry);
}

void write_changed(const SceneValues& scene, const std::vector<study::Change>& changes, const std::string& file,
                   Registry& registry) {
  SceneValues wanted = as_in_file(scene);
  std::vector<std::string> overrides;
  for (const study::Change& change : changes) {
    wanted.set(change.path, change.value, "--write");
    overrides.push_back(change.text());
  }
  const std::string text = edited(scene.text(), overrides);
  const SceneValues written = SceneValues::parse(text, file);
  if (!same_content(written.root(), wanted.root()))
    throw study::InputError("--write: the text of " + scene.file() +
                            " cannot be edited into this; nothing is written. Change it by hand as the lines say");
  // An older file of this name is replaced; what the new scene reads, and the file it comes from, are not.
  std::vector<std::filesystem::path> read = files_of(make_scene(written, registry));
  read.front() =
      std::filesystem::path(scene.document().directory_now()) / std::filesystem::path(scene.file()).filename();
  keep_inputs(file, read);
  write_file(file, text);
}

std::string scene_lines(const std::vector<std::string>& overrides) {
  Json tree = Json::object();
  for (const std::string& o : overrides) {
    Json* at = &tree;
    for (const std::string& key : keys_of_path(o.substr(0, o.find('=')))) at = &(*at)[key];
    *at = o.substr(o.find('=') + 1);
  }
  std::string out;
  add_lines(out, tree, 0);
  return out;
}

}  // namespace withy
