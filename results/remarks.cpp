#include "withy/results/remarks.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace withy {

nlohmann::ordered_json remarks_json(const Scene& scene, const std::vector<study::Remark>& remarks) {
  nlohmann::ordered_json j{{"scene", scene.file}, {"valid", true}, {"remarks", nlohmann::ordered_json::array()}};
  for (const study::Remark& r : remarks)
    j["remarks"].push_back(
        {{"line", r.place.line}, {"column", r.place.column}, {"path", r.place.path}, {"text", r.text}});
  return j;
}

std::string remarks_text(const Scene& scene, const std::vector<study::Remark>& remarks) {
  std::string text;
  for (const study::Remark& remark : remarks) {
    const Place& p = remark.place;
    const std::string at = p.line > 0 ? fmt::format("{}:{}:{}", scene.file, p.line, p.column) : scene.file;
    text += fmt::format("{}: {}: {}\n", at, p.path.empty() ? "/" : p.path, remark.text);
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
