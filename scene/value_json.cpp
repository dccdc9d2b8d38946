#include "withy/scene/value_json.hpp"

#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

namespace withy {
namespace {
using Json = nlohmann::ordered_json;
}  // namespace

void append_member(Json& object, std::string key, Json value) {
  // operator[] looks through all members that are there.
  std::vector<Json::object_t::value_type>& members = object.get_ref<Json::object_t&>();
  members.emplace_back(std::move(key), std::move(value));
}

Json value_json(const Value& value) {
  switch (value.kind()) {
    case Value::Kind::null:
      return nullptr;
    case Value::Kind::boolean:
      return value.boolean();
    case Value::Kind::number:
      return value.number();
    case Value::Kind::text:
      return value.text();
    case Value::Kind::list: {
      Json list = Json::array();
      for (const Value& item : value.items()) list.push_back(value_json(item));
      return list;
    }
    case Value::Kind::map: {
      Json map = Json::object();
      for (const auto& [key, member] : value.members()) append_member(map, key, value_json(member));
      return map;
    }
  }
  return nullptr;
}

}  // namespace withy
