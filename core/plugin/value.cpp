#include "withy/core/plugin/value.hpp"

#include <algorithm>
#include <atomic>
#include <stdexcept>

namespace withy {
namespace {

/// What a value alone holds: its own copy of what it has shared.
template <class Content>
Content& alone(std::shared_ptr<Content>& content) {
  if (content == nullptr) {
    content = std::make_shared<Content>();
  } else if (content.use_count() > 1) {
    content = std::make_shared<Content>(*content);
  } else {
    // Another thread may have read it as the last to share it.
    std::atomic_thread_fence(std::memory_order_acquire);
  }
  return *content;
}

}  // namespace

const std::vector<Value>& Value::no_items() {
  static const std::vector<Value> none;
  return none;
}

const std::vector<Value::Member>& Value::no_members() {
  static const std::vector<Member> none;
  return none;
}

std::vector<Value>& Value::items() { return alone(items_); }
std::vector<Value::Member>& Value::members() { return alone(members_); }

Value Value::list(std::vector<Value> items, Place where) {
  Value v;
  v.kind_ = Kind::list;
  if (!items.empty()) v.items_ = std::make_shared<std::vector<Value>>(std::move(items));
  v.place_ = std::move(where);
  return v;
}

Value Value::map(std::vector<Member> members, Place where) {
  Value v;
  v.kind_ = Kind::map;
  if (!members.empty()) v.members_ = std::make_shared<std::vector<Member>>(std::move(members));
  v.place_ = std::move(where);
  return v;
}

const Value* Value::find(std::string_view key) const {
  if (members_ == nullptr) return nullptr;
  const auto it = std::find_if(members_->begin(), members_->end(), [&](const Member& m) { return m.first == key; });
  return it == members_->end() ? nullptr : &it->second;
}

const Value& Value::at(std::string_view key) const {
  const Value* v = find(key);
  if (v == nullptr) throw std::logic_error("no member '" + std::string(key) + "' at " + place_.path);
  return *v;
}

std::vector<double> Value::numbers() const {
  std::vector<double> x;
  x.reserve(items().size());
  for (const Value& item : items()) x.push_back(item.number());
  return x;
}

void Value::set(std::string_view key, Value value) {
  kind_ = Kind::map;
  std::vector<Member>& own = members();
  const auto it = std::find_if(own.begin(), own.end(), [&](const Member& m) { return m.first == key; });
  if (it == own.end()) {
    own.emplace_back(std::string(key), std::move(value));
  } else {
    it->second = std::move(value);
  }
}

}  // namespace withy
