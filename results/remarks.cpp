#include "withy/results/remarks.hpp"

#include <fmt/format.h>

#include <cctype>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "withy/scene/units.hpp"

namespace withy {

namespace {

/// What set the value at a place that is not in the file, as "--set 'a=1'"; empty: it is, or nothing did.
std::string origin_of(const Place& place, const std::vector<std::string>& origins) {
  const auto index = static_cast<std::size_t>(-static_cast<long>(place.line)) - 1;
  return place.line < 0 && index < origins.size() ? origins[index] : std::string();
}

}  // namespace

nlohmann::ordered_json remarks_json(const Scene& scene, const std::vector<study::Remark>& remarks,
                                    const std::vector<std::string>& origins) {
  nlohmann::ordered_json j{{"scene", scene.file}, {"valid", true}, {"remarks", nlohmann::ordered_json::array()}};
  for (const study::Remark& r : remarks) {
    nlohmann::ordered_json told{{"line", nullptr}, {"column", nullptr}, {"path", r.place.path}, {"text", r.text}};
    if (r.place.line > 0) told["line"] = r.place.line, told["column"] = r.place.column;
    if (const std::string origin = origin_of(r.place, origins); !origin.empty()) told["origin"] = origin;
    j["remarks"].push_back(std::move(told));
  }
  return j;
}

namespace {

/// Times that the same is said with its place: a chain of many equal links is not to fill the screen.
constexpr std::size_t few = 3;

bool digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// Where the number that begins at `begin` ends.
std::size_t end_of_number(std::string_view text, std::size_t begin) {
  std::size_t at = begin;
  const auto digits = [&] {
    while (at < text.size() && digit(text[at])) ++at;
  };
  digits();
  if (at + 1 < text.size() && text[at] == '.' && digit(text[at + 1])) {
    ++at;
    digits();
  }
  const std::size_t sign = at + 1 < text.size() && (text[at + 1] == '-' || text[at + 1] == '+') ? at + 2 : at + 1;
  if (at < text.size() && text[at] == 'e' && sign < text.size() && digit(text[sign])) {
    at = sign;
    digits();
  }
  return at;
}

/// A remark in parts: what it says of many bodies, and of each its own numbers. Digits of names are no numbers.
struct Parts {
  std::vector<std::string> words;    ///< before each number, and behind the last
  std::vector<std::string> numbers;  ///< as they stand
};

Parts parts_of(std::string_view text) {
  Parts parts{{""}, {}};
  for (std::size_t at = 0; at < text.size();) {
    const bool in_word = at > 0 && (std::isalnum(static_cast<unsigned char>(text[at - 1])) != 0 || text[at - 1] == '_');
    if (!digit(text[at]) || in_word) {
      parts.words.back() += text[at++];
      continue;
    }
    const std::size_t end = end_of_number(text, at);
    parts.numbers.emplace_back(text.substr(at, end - at));
    parts.words.emplace_back();
    at = end;
  }
  return parts;
}

/// Remarks that differ in numbers alone and are counted.
struct Counted {
  std::size_t times = 0;
  std::vector<std::string> least, greatest;

  void add(const std::vector<std::string>& numbers) {
    if (times++ == 0) least = greatest = numbers;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (plain_number(numbers[i]) < plain_number(least[i])) least[i] = numbers[i];
      if (plain_number(numbers[i]) > plain_number(greatest[i])) greatest[i] = numbers[i];
    }
  }
  /// With the ranges of their numbers.
  [[nodiscard]] std::string text(const std::vector<std::string>& words) const {
    std::string all = words[0];
    for (std::size_t i = 0; i < least.size(); ++i)
      all += (least[i] == greatest[i] ? least[i] : least[i] + " to " + greatest[i]) + words[i + 1];
    return all;
  }
};

}  // namespace

std::string remarks_text(const Scene& scene, const std::vector<study::Remark>& remarks,
                         const std::vector<std::string>& origins) {
  std::string text;
  std::map<std::vector<std::string>, std::size_t> said;
  std::map<std::vector<std::string>, Counted> counted;
  for (const study::Remark& remark : remarks) {
    Parts parts = parts_of(remark.text);
    if (++said[parts.words] > few) {
      counted[std::move(parts.words)].add(parts.numbers);
      continue;
    }
    const Place& p = remark.place;
    std::string at = p.line > 0 ? fmt::format("{}:{}:{}", scene.file, p.line, p.column) : origin_of(p, origins);
    if (at.empty()) at = scene.file;
    text += fmt::format("{}: {}: {}\n", at, p.path.empty() ? "/" : p.path, remark.text);
  }
  for (const auto& [words, more] : counted) text += fmt::format("and {} more: {}\n", more.times, more.text(words));
  const std::size_t bodies = scene.model->bodies().size(), speeds = scene.model->layout().speeds;
  text += fmt::format("{} is valid: {} {}, {} {}, formulation {}, integrator {}; ", scene.file, bodies,
                      bodies == 1 ? "body" : "bodies", speeds, speeds == 1 ? "speed" : "speeds", scene.formulation_name,
                      scene.integrator_name);
  if (!scene.end) text += "it has no end, and for a run wants time.end; ";
  if (remarks.empty()) return text + "nothing is implausible\n";
  if (remarks.size() == 1) return text + "one thing is implausible\n";
  return text + fmt::format("{} things are implausible\n", remarks.size());
}

}  // namespace withy
