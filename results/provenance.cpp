#include "withy/results/provenance.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "withy/results/json_text.hpp"
#include "withy/results/output_name.hpp"
#include "withy/results/results_error.hpp"
#include "withy/scene/sha256.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

Json files_json(const SceneSources& sources) {
  Json all = Json::array();
  for (const FileUsed& f : sources.files) all.push_back({{"path", f.path}, {"sha256", f.sha256}});
  return all;
}

Json plugins_json(const Provenance& p, bool builds) {
  Json all = Json::array();
  for (std::size_t i = 0; i < p.sources.plugins.size(); ++i) {
    const PluginUsed& used = p.sources.plugins[i];
    const auto version = p.versions.find(used.file);
    all.push_back({{"id", used.kind + '/' + used.id},
                   {"version", version == p.versions.end() ? "" : version->second},
                   {"file", used.file}});
    if (builds) all.back()["build"] = p.plugin_builds[i];
  }
  return all;
}

Json program_json(const BuildIdentity& program) {
  return {{"version", program.version}, {"git", program.description}, {"build", program.build}};
}

void list(std::string& text, const std::string& what) { text += (text.empty() ? "" : ", ") + what; }

}  // namespace

std::string Provenance::subject() const {
  Json j = Json::array({values});
  for (const FileUsed& f : sources.files) j.push_back(f.sha256);
  return sha256(json_line(j));
}

std::string Provenance::fingerprint() const {
  Json j = Json::array({subject(), program.version, program.description, program.build});
  for (std::size_t i = 0; i < plugin_builds.size(); ++i)
    j.push_back({sources.plugins[i].kind, sources.plugins[i].id, plugin_builds[i]});
  return sha256(json_line(j));
}

Provenance provenance_of(const Scene& scene, std::map<std::string, std::string> versions) {
  Provenance p{scene.file, scene.sha256, scene.settings, {}, scene.sources, {}, std::move(versions), build_identity()};
  p.reads = files_of(scene);
  p.values = sha256(json_line(value_json(scene.source)));
  // Many plugins may be of one library.
  std::string file, build;
  for (const PluginUsed& used : p.sources.plugins) {
    if (used.file != file) build = library_identity(file = used.file);
    p.plugin_builds.push_back(build);
  }
  return p;
}

std::string differences(const Provenance& kept, const Provenance& now) {
  std::string text;
  if (kept.values != now.values) list(text, "the values of the scene");
  const auto& before = kept.sources.files;
  for (const FileUsed& f : now.sources.files) {
    const auto same = [&](const FileUsed& k) { return k.path == f.path && k.sha256 == f.sha256; };
    if (std::none_of(before.begin(), before.end(), same)) list(text, "the file '" + f.path + "'");
  }
  for (std::size_t i = 0; i < now.sources.plugins.size(); ++i) {
    const PluginUsed& p = now.sources.plugins[i];
    for (std::size_t k = 0; k < kept.sources.plugins.size(); ++k)
      if (kept.sources.plugins[k].kind == p.kind && kept.sources.plugins[k].id == p.id &&
          kept.plugin_builds[k] != now.plugin_builds[i])
        list(text, "the plugin " + p.kind + "/" + p.id);
  }
  const BuildIdentity &a = kept.program, &b = now.program;
  if (a.version != b.version || a.description != b.description || a.build != b.build) list(text, "the program");
  return text;
}

Json provenance_json(const Provenance& p) {
  return {{"scene_sha256", p.scene_sha256},    {"files", files_json(p.sources)},     {"set", p.settings},
          {"plugins", plugins_json(p, false)}, {"program", program_json(p.program)}, {"fingerprint", p.fingerprint()}};
}

Json stored_provenance(const Provenance& p) {
  Json j = provenance_json(p);
  j["scene"] = p.scene;
  j["values"] = p.values;
  j["plugins"] = plugins_json(p, true);
  return j;
}

Provenance provenance_of_json(const Json& j) {
  try {
    Provenance p;
    p.scene = j.at("scene");
    p.scene_sha256 = j.at("scene_sha256");
    p.settings = j.at("set").get<std::vector<std::string>>();
    p.values = j.at("values");
    for (const Json& f : j.at("files")) p.sources.files.push_back({f.at("path"), f.at("sha256")});
    for (const Json& used : j.at("plugins")) {
      const std::string id = used.at("id");
      const std::size_t slash = std::min(id.find('/'), id.size() - 1);
      p.sources.plugins.push_back({id.substr(0, slash), id.substr(slash + 1), used.at("file")});
      p.versions[used.at("file")] = used.at("version");
      p.plugin_builds.push_back(used.at("build"));
    }
    const Json& program = j.at("program");
    p.program = {program.at("version"), program.at("git"), program.at("build")};
    return p;
  } catch (const Json::exception&) {
    throw ResultsError("it does not say where a result comes from");
  }
}

}  // namespace withy
