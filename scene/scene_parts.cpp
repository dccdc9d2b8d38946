#include "withy/scene/scene_parts.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "withy/scene/check.hpp"
#include "withy/scene/same_content.hpp"

namespace withy {
namespace {

std::string key_of(std::string_view kind, const Value& value) {
  return std::string(kind).append(":").append(value.place().path);
}

/// Whether two values are equal in all that a check sees: content, order and places.
bool identical(const Value& a, const Value& b) {
  const Place &p = a.place(), &q = b.place();
  if (a.kind() != b.kind() || p.line != q.line || p.column != q.column || p.path != q.path) return false;
  switch (a.kind()) {
    case Value::Kind::null:
      return true;
    case Value::Kind::boolean:
      return a.boolean() == b.boolean();
    case Value::Kind::number:
      return std::bit_cast<std::uint64_t>(a.number()) == std::bit_cast<std::uint64_t>(b.number());
    case Value::Kind::text:
      return a.text() == b.text();
    case Value::Kind::list:
      return a.shares(b) ||
             std::equal(a.items().begin(), a.items().end(), b.items().begin(), b.items().end(), &identical);
    case Value::Kind::map:
      break;
  }
  return a.shares(b) || std::equal(a.members().begin(), a.members().end(), b.members().begin(), b.members().end(),
                                   [](const Value::Member& m, const Value::Member& n) {
                                     return m.first == n.first && identical(m.second, n.second);
                                   });
}

bool equal(const SceneNames& a, const SceneNames& b) {
  const auto same = [](const NameList& m, const NameList& n) { return m.names() == n.names(); };
  return same(a.bodies, b.bodies) && same(a.hinges, b.hinges) && same(a.frames, b.frames) && same(a.loads, b.loads) &&
         same(a.sliding, b.sliding) && a.units == b.units && same(a.signals, b.signals) &&
         a.frames_complete == b.frames_complete;
}

}  // namespace

SceneParts::SceneParts() = default;
SceneParts::~SceneParts() = default;

void SceneParts::know(std::size_t stage, const SceneNames& names) {
  std::unique_ptr<SceneNames>& known = names_[stage];
  if (known == nullptr || !equal(*known, names)) {
    known = std::make_unique<SceneNames>(names);
    names_of_[stage] = ++last_names_;
  }
  names_now_ = names_of_[stage];
}

/// Fills the part of a key where that pays.
template <class Part>
void SceneParts::put(std::unordered_map<std::string, Part>& parts, std::string key, const auto& fill) {
  const auto [at, first] = parts.try_emplace(std::move(key));
  if (first || at->second.worth_another()) fill(at->second);
}

const SceneParts::Checked* SceneParts::checked(std::string_view kind, const Value& given) {
  const auto found = maps_.find(key_of(kind, given));
  if (found == maps_.end() || found->second.names != names_now_ || !identical(found->second.given, given))
    return nullptr;
  found->second.changes = 0;
  return &found->second.checked;
}

void SceneParts::remember(std::string_view kind, const Value& given, const void* plugin, const Value& value,
                          SceneSources sources) {
  put(maps_, key_of(kind, given), [&](Map& map) {
    map.given = given;
    map.names = names_now_;
    map.checked = {plugin, value, std::move(sources)};
  });
}

std::shared_ptr<const void> SceneParts::made(std::string_view kind, const void* plugin, const Value& value) {
  const auto found = objects_.find(key_of(kind, value));
  if (found == objects_.end() || found->second.plugin != plugin || !same_content(found->second.value, value)) return {};
  found->second.changes = 0;
  return found->second.object;
}

void SceneParts::remember(std::string_view kind, const void* plugin, const Value& value,
                          std::shared_ptr<const void> object) {
  put(objects_, key_of(kind, value), [&](Object& known) {
    known.plugin = plugin;
    known.value = value;
    known.object = std::move(object);
  });
}

}  // namespace withy
