#include "scaled_scene.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "scaled_sid.hpp"
#include "withy/core/model/hinge_rates.hpp"
#include "withy/scene/grammar.hpp"
#include "withy/scene/units.hpp"

namespace withy::extremes {
namespace {

using Json = nlohmann::ordered_json;

Json plain(const Value& value) {
  Json json;
  switch (value.kind()) {
    case Value::Kind::null:
      break;
    case Value::Kind::boolean:
      json = value.boolean();
      break;
    case Value::Kind::number:
      json = value.number();
      break;
    case Value::Kind::text:
      json = value.text();
      break;
    case Value::Kind::list:
      json = Json::array();
      for (const Value& item : value.items()) json.push_back(plain(item));
      break;
    case Value::Kind::map:
      json = Json::object();
      for (const auto& [key, member] : value.members()) json[key] = plain(member);
      break;
  }
  return json;
}

class Scaler {
 public:
  Scaler(const Scene& scene, Registry& registry, const Gauge& gauge, const std::filesystem::path& folder)
      : directory_(std::filesystem::path(scene.file).parent_path()),
        registry_(registry),
        gauge_(gauge),
        folder_(folder) {}

  Json members(const Value& value, const std::vector<ParameterSpec>& specs) const {
    Json json = Json::object();
    for (const auto& [key, member] : value.members()) {
      if (key == "visual") continue;  // a picture, from files in the units of the scene that is scaled
      const auto spec = std::find_if(specs.begin(), specs.end(), [&](const auto& s) { return s.key == key; });
      json[key] = spec == specs.end() ? plain(member) : one(member, *spec);
    }
    return json;
  }

  /// Those that act make the equations what they are. Their values are angles in the scenes that are compared.
  Json events(const Value* all) const {
    Json json = Json::object();
    if (all == nullptr) return json;
    for (const auto& [name, event] : all->members()) {
      json[name] = plain(event);
      for (const char* key : {"at", "delay"})
        if (json[name].contains(key)) json[name][key] = event.number_at(key) * gauge_.factor("s");
    }
    return json;
  }

  /// Bodies, hinges, loads or motions: each has its plugin's members and the common ones.
  template <class Interface>
  Json parts(const Value* all, const std::vector<ParameterSpec>& common) const {
    Json json = Json::object();
    if (all == nullptr) return json;
    for (const auto& [name, part] : all->members()) {
      std::vector<ParameterSpec> specs = registry_.find<Interface>(part.text_at("type"))->parameters;
      specs.insert(specs.end(), common.begin(), common.end());
      // What an input's table holds depends on where it acts; the scenes have torques alone.
      for (ParameterSpec& spec : specs)
        if (part.text_at("type") == "input" && spec.key == "table") spec.columns = {"s", "N m"};
      json[name] = members(part, specs);
    }
    return json;
  }

 private:
  Json rows(const Value& value, const std::vector<std::string>& columns) const {
    Json table = Json::array();
    for (const Value& row : value.items()) {
      Json numbers = Json::array();
      for (std::size_t i = 0; i < row.items().size(); ++i)
        numbers.push_back(row.items()[i].number() * gauge_.factor(columns.at(i)));
      table.push_back(std::move(numbers));
    }
    return table;
  }

  Json one(const Value& value, const ParameterSpec& spec) const {
    using enum ParameterSpec::Kind;
    switch (spec.kind) {
      case number:
        if (value.kind() == Value::Kind::list) return rows(value, spec.columns);
        return value.number() * gauge_.factor(spec.unit);
      case vector: {
        Json list = Json::array();
        for (const Value& item : value.items()) list.push_back(item.number() * gauge_.factor(spec.unit));
        return list;
      }
      case table:
        return rows(value, spec.columns);
      case map:
        return members(value, spec.members);
      case named: {
        Json json = Json::object();
        for (const auto& [name, member] : value.members()) json[name] = members(member, spec.members);
        return json;
      }
      case text:
        if (value.kind() == Value::Kind::number) return value.number() * gauge_.factor(spec.unit);
        if (value.kind() == Value::Kind::map && spec.refers == ParameterSpec::Refers::motion)
          return members(value, registry_.find<Motion>(value.text_at("type"))->parameters);
        if (value.kind() == Value::Kind::map)
          return members(value, registry_.find<ModeFamily>(value.text_at("name"))->parameters);
        if (spec.key == "file") return file(value.text());
        return plain(value);
      default:
        return plain(value);
    }
  }

  /// Name of a scaled copy of the file. It is written with 17 digits, which are every bit.
  std::string file(const std::string& name) const {
    const sid::Data data = scaled(sid::read(text_of(directory_ / name)), gauge_);
    const std::filesystem::path copy = folder_ / std::filesystem::path(name).filename();
    std::ofstream out(copy);
    out << sid::write(data);
    out.close();
    if (!out) throw std::runtime_error("cannot write " + copy.string());
    return copy;
  }

  std::filesystem::path directory_;  ///< of the scene, from which names of files start
  Registry& registry_;
  const Gauge& gauge_;
  const std::filesystem::path& folder_;
};

}  // namespace

double Gauge::factor(const std::string& unit) const {
  if (unit.empty() || unit == "1") return 1;
  const auto dimension = read_unit(unit_at_hinge(unit, false)).unit->dimension;  // of metre, kilogram, second, radian
  return std::ldexp(1.0, dimension[0] * length + dimension[1] * mass + dimension[2] * time);
}

std::string scaled_text(const Scene& scene, Registry& registry, const Gauge& gauge,
                        const std::filesystem::path& folder) {
  const Scaler scaler(scene, registry, gauge, folder);
  Json json = scaler.members(scene.source, grammar::scene_members());
  json.erase("initial");
  if (const Value* initial = scene.source.find("initial"); initial != nullptr && initial->has("locked"))
    json["initial"] = {{"locked", plain(initial->at("locked"))}};
  json["formulation"] = plain(scene.source.at("formulation"));
  json["integrator"] = {{"name", "dopri5"}};
  json["bodies"] = scaler.parts<Body>(scene.source.find("bodies"), grammar::body_members());
  json["hinges"] = scaler.parts<Hinge>(scene.source.find("hinges"), grammar::hinge_members());
  json["loads"] = scaler.parts<Load>(scene.source.find("loads"), grammar::load_members());
  json["events"] = scaler.events(scene.source.find("events"));
  json["motions"] = scaler.parts<Motion>(scene.source.find("motions"), grammar::motion_members());
  return json.dump(1);
}

std::vector<double> state_factors(const Model& model, const Gauge& gauge, int derivatives) {
  const Layout& layout = model.layout();
  std::vector<int> exponents(layout.size());  // discrete states are those of relays, which have no unit
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const Slot& slot = layout.hinges[h];
    std::size_t i = 0;
    const std::vector<HingeRate> rates = hinge_rates(*model.hinges()[h].hinge);
    for (const HingeRate& rate : rates) {
      exponents[layout.positions + slot.speed + i++] = (rate.angular ? 0 : gauge.length) - gauge.time;
      if (rate.coordinate && !rate.angular) exponents[slot.position + *rate.coordinate] = gauge.length;
    }
  }
  for (const Slot& slot : layout.bodies) {
    for (std::size_t i = 0; i < slot.speeds; ++i) {
      const bool angle = layout.speed_names[slot.speed + i].find(".torsion") != std::string::npos;
      exponents[slot.position + i] = angle ? 0 : gauge.length;
      exponents[layout.positions + slot.speed + i] = (angle ? 0 : gauge.length) - gauge.time;
    }
  }
  exponents.back() = gauge.mass + 2 * (gauge.length - gauge.time);
  std::vector<double> factors;
  for (const int e : exponents) factors.push_back(std::ldexp(1.0, e - derivatives * gauge.time));
  return factors;
}

}  // namespace withy::extremes
