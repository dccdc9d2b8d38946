#include "withy/core/plugin/value.hpp"

#include <algorithm>
#include <stdexcept>

namespace withy {

Value Value::list(std::vector<Value> items, Place where) {
  Value v;
  v.kind_ = Kind::list;
  v.items_ = std::move(items);
  v.place_ = std::move(where);
  return v;
}

Value Value::map(std::vector<Member> members, Place where) {
  Value v;
  v.kind_ = Kind::map;
  v.members_ = std::move(members);
  v.place_ = std::move(where);
  return v;
}

const Value* Value::find(std::string_view key) const {
  const auto it = std::find_if(members_.begin(), members_.end(), [&](const Member& m) { return m.first == key; });
  return it == members_.end() ? nullptr : &it->second;
}

const Value& Value::at(std::string_view key) const {
  const Value* v = find(key);
  if (v == nullptr) throw std::logic_error("no member '" + std::string(key) + "' at " + place_.path);
  return *v;
}

std::vector<double> Value::numbers() const {
  std::vector<double> x;
  x.reserve(items_.size());
  for (const Value& item : items_) x.push_back(item.number());
  return x;
}

void Value::set(std::string_view key, Value value) {
  kind_ = Kind::map;
  const auto it = std::find_if(members_.begin(), members_.end(), [&](const Member& m) { return m.first == key; });
  if (it == members_.end()) {
    members_.emplace_back(std::string(key), std::move(value));
  } else {
    it->second = std::move(value);
  }
}

}  // namespace withy
