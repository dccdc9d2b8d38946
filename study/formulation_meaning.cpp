#include "withy/study/formulation_meaning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "withy/core/plugin/formulation.hpp"
#include "withy/core/plugin/strain_kinematics.hpp"
#include "withy/study/prepared.hpp"

namespace withy::study {
namespace {

/// Of one name each, the engine's own.
constexpr const char* presets[] = {"ruthless",  "inconsistent",     "linear",    "consistent",
                                   "symmetric", "symmetric-linear", "quadratic", "exact"};

/// The two choices of a formulation that is made of them.
struct Pair {
  std::string kinematics, truncation;
};

bool is_pair(const Value& choice) { return choice.kind() == Value::Kind::map && choice.find("kinematics") != nullptr; }

Pair pair_of(const Value& choice) {
  const Value* truncation = choice.find("truncation");
  return {choice.text_at("kinematics"), truncation == nullptr ? "none" : truncation->text()};
}

/// Two choices alone are those of `general`.
std::string formulation_id(const Value& choice) {
  if (choice.kind() == Value::Kind::text) return choice.text();
  const Value* named = choice.find("name");
  return named == nullptr ? "general" : named->text();
}

std::string title_of(const std::string& id, const Value& choice) {
  if (!is_pair(choice)) return id;
  const Pair pair = pair_of(choice);
  return fmt::format("{}: {}, {}", id, pair.kinematics, pair.truncation);
}

bool keeps_the_same(const Terms& a, const Terms& b) {
  return a.strain == b.strain && a.truncation == b.truncation && a.products_of_speeds == b.products_of_speeds &&
         a.kinematics == nullptr && b.kinematics == nullptr;
}

/// The one of a single name that keeps the same terms; null where none does.
const Plugin<Formulation>* named_alike(const std::string& id, const Value& choice, Registry& registry) {
  const Plugin<Formulation>* plugin = registry.find<Formulation>(id);
  if (plugin == nullptr) return nullptr;
  Diagnostics unheard;  // the scene was made with it: there is nothing to say
  const std::unique_ptr<Formulation> made = plugin->make(choice, {registry, unheard});
  if (made == nullptr) return nullptr;
  const std::vector<std::string> known = registry.ids<Formulation>();
  for (const char* other : presets)
    if (std::find(known.begin(), known.end(), other) != known.end() &&
        keeps_the_same(make_formulation(registry, other)->terms(), made->terms()))
      return registry.find<Formulation>(other);
  return nullptr;
}

}  // namespace

std::string formulation_title(const Value& choice) { return title_of(formulation_id(choice), choice); }

FormulationWords formulation_words_of(const Value& choice, Registry& registry) {
  FormulationWords words;
  words.name = formulation_id(choice);
  words.title = title_of(words.name, choice);
  const Plugin<Formulation>* plugin = registry.find<Formulation>(words.name);
  if (!is_pair(choice)) {
    words.meaning = plugin == nullptr ? "" : plugin->summary;
    return words;
  }
  const Pair pair = pair_of(choice);
  words.meaning = fmt::format("Strain kinematics '{}' with truncation '{}'", pair.kinematics, pair.truncation);
  if (const Plugin<Formulation>* alike = named_alike(words.name, choice, registry))
    words.meaning += fmt::format(", the same as formulation '{}': {}", alike->id, alike->summary);
  return words;
}

FormulationWords formulation_words_of(const Scene& scene, Registry& registry) {
  FormulationWords words = formulation_words_of(scene.source.at("formulation"), registry);
  words.name = scene.formulation_name;
  return words;
}

std::string formulation_title(const Scene& scene) {
  return title_of(scene.formulation_name, scene.source.at("formulation"));
}

}  // namespace withy::study
