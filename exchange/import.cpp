#include "import.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "elastodyn.hpp"
#include "mjcf.hpp"
#include "relaxation.hpp"
#include "scene_text.hpp"
#include "urdf.hpp"
#include "withy/core/model/compiled_model.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/equations.hpp"
#include "withy/core/plugin/formulation.hpp"
#include "withy/core/simulation/accuracy.hpp"
#include "withy/scene/document.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/scene.hpp"

namespace withy::exchange {
namespace {

constexpr const char* scene_made = "the scene made of it";

std::string extension_of(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

/// The place in the files that a path of the scene comes from, as "booms.yaml:4:7"; empty where there is none.
std::string origin_of_path(const std::string& path, const Tree& tree, const FlexibleLinks& flexible,
                           const std::string& file) {
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    const std::string begin = "/bodies/" + tree.links[i].name;
    if (path != begin && !path.starts_with(begin + "/")) continue;
    if (!flexible.of_link.contains(static_cast<int>(i))) return fmt::format("{}:{}", file, tree.links[i].place.line);
    const Place at = flexible.document.key_place("/links" + path.substr(std::string("/bodies").size()));
    return fmt::format("{}:{}:{}", flexible.file, at.line, at.column);
  }
  for (const Joint& joint : tree.joints)
    if (path.starts_with("/hinges/" + joint.name) || path.starts_with("/loads/" + joint.name + "_spring"))
      return fmt::format("{}:{}", file, joint.place.line);
  return {};
}

/// Makes the scene and gives it; what is wrong with it is said of the files it comes from.
Scene check_made(const std::string& text, const Tree& tree, const FlexibleLinks& flexible, const std::string& file,
                 Registry& registry) {
  try {
    return parse_scene(text, scene_made, registry);
  } catch (const SceneError& e) {
    std::vector<Diagnostic> problems;
    std::vector<std::string> origins;
    for (Diagnostic problem : e.problems()) {
      const std::string origin = origin_of_path(problem.place.path, tree, flexible, file);
      origins.push_back(origin.empty() ? fmt::format("{}, line {}", scene_made, problem.place.line) : origin);
      problem.place.line = -static_cast<int>(origins.size());
      problems.push_back(std::move(problem));
    }
    throw SceneError(file, std::move(problems), origins);
  }
}

/// Refuses a joint that moves no mass in the scene's state, as one about an axis on which all of its mass sits: no run
/// could begin.
/// \returns a remark where joints move none together: elsewhere runs begin, and the scene is good for these
std::string check_motion(const Scene& scene, const Tree& tree, const std::string& file) {
  const auto equations = compile_model(*scene.formulation, scene.model);
  const auto rate = unsolvable_rate(*scene.model, *equations, scene.initial);
  if (!rate) return {};
  if (rate->together) return "no run begins in the state that the scene has: " + rate->why;
  const std::string& hinge = scene.model->hinges()[rate->hinge].name;
  const auto joint =
      std::find_if(tree.joints.begin(), tree.joints.end(), [&](const Joint& j) { return j.name == hinge; });
  throw SceneError(file, {{joint != tree.joints.end() ? joint->place : Place{},
                           fmt::format("the joint {}: {}", in_quotes(hinge), rate->why)}});
}

ImportedScene import_tree(const ModelImport& what, const std::string& text, Registry& registry) {
  if (what.length > 0 || what.tip_mass > 0)
    throw std::invalid_argument("--length and --tip-mass are for blades and towers of ElastoDyn");
  const Element root = read_xml(text, what.file);
  Diagnostics diagnostics;
  Tree tree;
  ImportedScene scene;
  if (root.name == "robot") {
    scene.from = "URDF";
    tree = read_urdf(root, what.free_base, what.mend_inertias, diagnostics);
  } else if (root.name == "mujoco") {
    if (what.free_base) throw std::invalid_argument("--free-base is for URDF; in MJCF a free joint says so");
    scene.from = "MJCF";
    tree = read_mjcf(root, what.mend_inertias, diagnostics);
  } else {
    diagnostics.error(root.place, "got <" + root.name + ">; need <robot> (URDF) or <mujoco> (MJCF)");
  }
  if (diagnostics.ok() && has_relaxation(tree)) {
    const Scene rigid = check_made(scene_text(tree, {}, what.file), tree, {}, what.file, registry);
    settle_relaxation(tree, rigid, diagnostics);
  }
  if (!diagnostics.ok()) throw SceneError(what.file, diagnostics.errors());
  FlexibleLinks flexible;
  if (!what.flexible.empty()) flexible = read_flexible(read_bytes(what.flexible), what.flexible, tree);
  scene.text = scene_text(tree, flexible, what.file);
  scene.remarks = tree.remarks;
  const std::string remark = check_motion(check_made(scene.text, tree, flexible, what.file, registry), tree, what.file);
  if (!remark.empty()) scene.remarks.push_back(remark);
  return scene;
}

/// \throws std::invalid_argument where the file cannot be read
std::string model_text(const std::string& file) {
  try {
    return read_bytes(file);
  } catch (const std::system_error& e) {
    throw std::invalid_argument(e.what());
  }
}

}  // namespace

bool is_model_file(const std::string& file) {
  const std::string ending = extension_of(file);
  return ending == ".urdf" || ending == ".xml" || ending == ".mjcf" || ending == ".dat";
}

ImportedScene import_model(const ModelImport& what, Registry& registry) {
  const std::string text = model_text(what.file);
  if (extension_of(what.file) != ".dat") return import_tree(what, text, registry);
  if (!what.flexible.empty() || what.free_base || what.mend_inertias)
    throw std::invalid_argument("--flexible, --free-base and --mend-inertias are for URDF and MJCF");
  if (!(what.length > 0))
    throw std::invalid_argument(
        "--length is missing: ElastoDyn's files of blades and towers have fractions of it alone");
  ElastoDynBeam beam = read_elastodyn(text, what.file);
  const auto made = [&] { return scene_text(beam, what.length, what.tip_mass, what.file); };
  // The modes that damping is of are known of the beam alone.
  const Scene undamped = check_made(made(), {}, {}, what.file, registry);
  assign_damping(beam, *undamped.model->bodies()[0].body);
  ImportedScene scene{made(), beam.tower ? "ElastoDyn tower" : "ElastoDyn blade", beam.remarks};
  static_cast<void>(check_made(scene.text, {}, {}, what.file, registry));
  return scene;
}

}  // namespace withy::exchange
