#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "withy/core/plugin/memory.hpp"
#include "withy/host/snapshot_parts.hpp"
#include "withy/results/provenance.hpp"
#include "withy/scene/sha256.hpp"

namespace withy::host {
namespace {

constexpr double snapshot_form = 1;  ///< of the list of numbers

/// The i-th 48 bits of a SHA-256, as a number.
double bits_of(const std::string& digest, std::size_t i) {
  constexpr std::size_t digits = 12;
  return static_cast<double>(std::stoull(digest.substr(i * digits, digits), nullptr, 16));
}

void drop(Value& map, std::initializer_list<std::string_view> keys) {
  std::erase_if(map.members(), [&](const Value::Member& m) { return std::ranges::find(keys, m.first) != keys.end(); });
}

/// Drops the names of objects of Python, which no other process gives: that their laws are the same is up to the host.
void drop_python_objects(Value& parts) {
  for (auto& [name, part] : parts.members()) {
    const Value* type = part.find("type");
    if (type != nullptr && type->text() == "python") drop(part, {"object"});
  }
}

/// All that a value says in words, a word a line.
void add_words(const Value& value, std::string& words) {
  if (value.kind() == Value::Kind::text) words += value.text() + '\n';
  for (const auto& [key, member] : value.members()) add_words(member, words);
  for (const Value& item : value.items()) add_words(item, words);
}

/// Whether `name` stands in the text as a name or as the beginning of one with a dot, as in "2 * imu.z".
bool mentions(const std::string& text, const std::string& name) {
  const auto in_name = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-'; };
  for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
    const std::size_t end = at + name.size();
    const bool begins = at == 0 || !(in_name(text[at - 1]) || text[at - 1] == '.');
    if (begins && (end == text.size() || !in_name(text[end]))) return true;
  }
  return false;
}

/// Takes out the outputs that are shown alone: no load, event or motion has their names.
void drop_shown_outputs(Value& source) {
  Value* outputs = nullptr;
  std::string words;
  for (auto& [key, value] : source.members()) {
    if (key == "outputs") outputs = &value;
    if (key == "loads" || key == "events" || key == "motions") add_words(value, words);
  }
  if (outputs == nullptr) return;
  std::vector<Value::Member> kept;
  for (bool more = true; more;) {  // what is kept may have the names of others
    more = false;
    for (const Value::Member& output : std::as_const(*outputs).members()) {
      const bool again = std::ranges::any_of(kept, [&](const Value::Member& m) { return m.first == output.first; });
      if (again || !mentions(words, output.first)) continue;
      kept.push_back(output);
      add_words(output.second, words);
      more = true;
    }
  }
  if (kept.empty()) return drop(source, {"outputs"});  // as of a scene that asks for none
  outputs->members() = std::move(kept);
}

/// Without what decides on where a run begins and ends and on what it shows, but not on the steps from a state.
Value deciding(Value source) {
  drop(source, {"name", "time", "initial", "closing"});  // the last says how `initial` closed loops
  drop_shown_outputs(source);
  for (auto& [key, value] : source.members())
    if (key == "bodies" || key == "loads") drop_python_objects(value);
  return source;
}

/// A type of sensors.
bool has_output_of(const Value& source, const std::string& type) {
  const Value* outputs = source.find("outputs");
  return outputs != nullptr && std::ranges::any_of(outputs->members(), [&](const Value::Member& output) {
           const Value* given = output.second.find("type");
           return given != nullptr && given->text() == type;
         });
}

SnapshotOrigin origin_of(const withy::Scene& scene) {
  withy::Scene trimmed = scene;
  trimmed.source = deciding(std::move(trimmed.source));
  // Whatever builds the sensors are of that it only shows.
  std::erase_if(trimmed.sources.plugins, [&](const PluginUsed& used) {
    return used.kind == kind_name<Sensor>() && !has_output_of(trimmed.source, used.id);
  });
  const Provenance p = provenance_of(trimmed);
  const std::string subject = p.subject();
  std::string builds = p.program.version + '\n' + p.program.description + '\n' + p.program.build;
  for (const std::string& build : p.plugin_builds) builds += '\n' + build;
  return {{bits_of(subject, 0), bits_of(subject, 1)}, bits_of(sha256(builds), 0)};
}

/// Of everything before it in a list: numbers that were changed or cut off are no snapshot.
double sum_of(std::span<const double> numbers) {
  return bits_of(sha256({reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()}), 0);
}

void pass(Memory& memory, Checkpoint& checkpoint, SnapshotOrigin& origin) {
  for (double& part : origin.scene) memory(part);
  memory(origin.build);
  memory(checkpoint.state.time);
  memory(checkpoint.state.y);
  memory(checkpoint.stepper);
  memory(checkpoint.watches);
}

bool is_finite(const State& state) {
  return std::isfinite(state.time) &&
         std::all_of(state.y.begin(), state.y.end(), [](double number) { return std::isfinite(number); });
}

}  // namespace

void SnapshotOrigin::check_against(const SnapshotOrigin& own) const {
  if (scene != own.scene)
    throw std::invalid_argument(
        "the snapshot is of another scene: what moves, acts, integrates or watches there is not the same as here");
  if (build != own.build)
    throw std::invalid_argument("the snapshot is of this scene by another build of withy or of a plugin");
}

const SnapshotOrigin& OriginOnce::operator()(const withy::Scene& scene) {
  if (!found_) found_ = origin_of(scene);
  return *found_;
}

double Snapshot::time() const {
  if (parts_ == nullptr) throw std::invalid_argument("the snapshot is empty");
  return parts_->checkpoint.state.time;
}

std::vector<double> Snapshot::numbers() const {
  if (parts_ == nullptr) throw std::invalid_argument("the snapshot is empty");
  Parts parts = *parts_;
  Memory memory;
  double form = snapshot_form;
  memory(form);
  pass(memory, parts.checkpoint, parts.origin);
  std::vector<double> numbers = memory.numbers();
  numbers.push_back(sum_of(numbers));
  return numbers;
}

Snapshot Snapshot::of_numbers(std::span<const double> numbers) {
  if (numbers.empty() || numbers.front() != snapshot_form ||
      sum_of(numbers.first(numbers.size() - 1)) != numbers.back())
    throw std::invalid_argument("these numbers are no snapshot, or not all of one as it was");
  Parts parts;
  Memory memory(numbers.subspan(1, numbers.size() - 2));
  pass(memory, parts.checkpoint, parts.origin);
  memory.finish();
  if (!is_finite(parts.checkpoint.state)) throw std::invalid_argument("the snapshot's state is not finite");
  Snapshot snapshot;
  snapshot.parts_ = std::make_shared<const Parts>(std::move(parts));
  return snapshot;
}

}  // namespace withy::host
