/// \file
/// What a result comes from: scene, files, plugins, program; and the fingerprint of all of it.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "withy/results/build_identity.hpp"
#include "withy/scene/scene.hpp"

namespace withy {

struct Provenance {
  std::string scene;                  ///< the scene's file
  std::string scene_sha256;           ///< of its text
  std::vector<std::string> settings;  ///< of the command line, `path=value`
  std::string values;                 ///< SHA-256 of the checked values, defaults and settings included
  SceneSources sources;
  std::vector<std::string> plugin_builds;         ///< of each of sources.plugins: build id or SHA-256 of its library
  std::map<std::string, std::string> versions{};  ///< of plugin libraries, by their files; may be empty
  BuildIdentity program;
  std::vector<std::filesystem::path> reads{};  ///< files it comes from, as they are found now; they are not stored

  /// Of the values and the content of the files: the same result is meant, whoever computes it.
  [[nodiscard]] std::string subject() const;
  /// Of everything that decides on the bits of a result. Names of scene and files are not part of it.
  [[nodiscard]] std::string fingerprint() const;
};
/// \param versions of plugin libraries by their files, as a host of plugins knows them
Provenance provenance_of(const Scene& scene, std::map<std::string, std::string> versions = {});

/// What differs, in words: "the values of the scene, the file 'boom.SID_FEM', the program"; empty where nothing does.
std::string differences(const Provenance& kept, const Provenance& now);

/// The members of run.json that tell where it comes from: scene_sha256, files, set, plugins, program, fingerprint.
nlohmann::ordered_json provenance_json(const Provenance& provenance);
/// Everything, to be read back by provenance_of_json.
nlohmann::ordered_json stored_provenance(const Provenance& provenance);
/// \throws ResultsError where it is none.
Provenance provenance_of_json(const nlohmann::ordered_json& stored);

}  // namespace withy
