#include "withy/results/remarks.hpp"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

namespace withy {

nlohmann::ordered_json remarks_json(const Scene& scene, const std::vector<study::Remark>& remarks) {
  nlohmann::ordered_json j{{"scene", scene.file}, {"valid", true}, {"remarks", nlohmann::ordered_json::array()}};
  for (const study::Remark& r : remarks)
    j["remarks"].push_back(
        {{"line", r.place.line}, {"column", r.place.column}, {"path", r.place.path}, {"text", r.text}});
  return j;
}

namespace {

/// Times that the same is said with its place: a chain of many equal links is not to fill the screen.
constexpr std::size_t few = 3;

}  // namespace

std::string remarks_text(const Scene& scene, const std::vector<study::Remark>& remarks) {
  std::string text;
  std::map<std::string, std::size_t> said;
  for (const study::Remark& remark : remarks) {
    if (++said[remark.text] > few) continue;
    const Place& p = remark.place;
    const std::string at = p.line > 0 ? fmt::format("{}:{}:{}", scene.file, p.line, p.column) : scene.file;
    text += fmt::format("{}: {}: {}\n", at, p.path.empty() ? "/" : p.path, remark.text);
  }
  for (const auto& [remark, times] : said) {
    if (times > few) text += fmt::format("and {} more: {}\n", times - few, remark);
  }
  const std::size_t bodies = scene.model->bodies().size(), speeds = scene.model->layout().speeds;
  text += fmt::format("{} is valid: {} {}, {} {}, formulation {}, integrator {}; ", scene.file, bodies,
                      bodies == 1 ? "body" : "bodies", speeds, speeds == 1 ? "speed" : "speeds", scene.formulation_name,
                      scene.integrator_name);
  if (remarks.empty()) return text + "nothing is implausible\n";
  if (remarks.size() == 1) return text + "one thing is implausible\n";
  return text + fmt::format("{} things are implausible\n", remarks.size());
}

}  // namespace withy
