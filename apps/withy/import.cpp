#include "withy/exchange/import.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/fem/import_report.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"

namespace withy::app {
namespace {

struct ImportArguments : CommonArguments, fem::ImportJob {
  std::string out;  ///< empty: <job>.SID_FEM, or <model>.yaml
  exchange::ModelImport model;
  bool force = false;
};

/// A scene of another program's model. A scene that is there may have been edited: it stays unless --force is given.
ExitStatus import_model(ImportArguments a) {
  const Plugins plugins(a);
  a.model.file = a.job;
  exchange::ImportedScene scene;
  try {
    scene = exchange::import_model(a.model, plugins.registry());
  } catch (const std::invalid_argument& e) {
    throw InputError(e.what());
  }
  const std::string file =
      a.out.empty() ? std::filesystem::path(a.job).filename().replace_extension(".yaml").string() : a.out;
  if (!a.force && std::filesystem::exists(file)) throw InputError(file + " is there already; --force replaces it");
  write_file(file, scene.text);
  if (a.json) {
    print(json_text(nlohmann::ordered_json{{"file", file}, {"from", scene.from}, {"remarks", scene.remarks}}));
  } else {
    std::string text = "read as " + scene.from + "\n";
    for (const std::string& remark : scene.remarks) text += "* " + remark + "\n";
    print(text + "written: " + file + "\n");
  }
  return ExitStatus::done;
}

ExitStatus import_mesh(const ImportArguments& a) {
  if (a.root.empty()) throw InputError("--root is required: the nodes of the mesh that are clamped");
  try {
    const fem::Imported imported = fem::import(a);
    const std::string file = a.out.empty() ? std::filesystem::path(a.job).filename().string() + ".SID_FEM" : a.out;
    write_file(file, sid::write(imported.data));
    const auto report = fem::import_json(imported, file);
    print(a.json ? json_text(report)
                 : fem::import_text(report) + "\nwritten: " + file + "; in a scene:\n\n" +
                       fem::scene_snippet(file, imported.data));
    return ExitStatus::done;
  } catch (const fem::InputError& e) {
    throw InputError(e.what());
  } catch (const std::domain_error& e) {
    throw InputError(e.what());
  }
}

std::function<ExitStatus()> add_import(CLI::App& c) {
  const auto arguments = std::make_shared<ImportArguments>();
  ImportArguments& a = *arguments;
  c.add_option("FILE", a.job,
               "A model, .urdf, .xml (URDF or MJCF) or .dat (ElastoDyn); or the job of a mesh: JOB.inp, and of "
               "CalculiX JOB.sti, JOB.mas and JOB.dof")
      ->required();
  c.add_option("--flexible", a.model.flexible, "Of a model: file with the links that are beams")->type_name("FILE");
  c.add_flag("--free-base", a.model.free_base, "Of a URDF: its root link floats");
  c.add_option("--length", a.model.length, "Of a blade or tower of ElastoDyn")
      ->type_name("M")
      ->check(CLI::PositiveNumber);
  c.add_option("--tip-mass", a.model.tip_mass, "What its tip carries, a point")
      ->type_name("KG")
      ->check(CLI::PositiveNumber);
  c.add_option("--mesh", a.mesh, "Input deck or .frd file with the nodes; default: JOB.inp")->type_name("FILE");
  c.add_option("--stiffness", a.stiffness, "Stiffness matrix of Abaqus (*_STIF*.mtx)")->type_name("FILE");
  c.add_option("--mass", a.mass_matrix, "Mass matrix of Abaqus (*_MASS*.mtx)")->type_name("FILE");
  c.add_option("--root", a.root, "Of a mesh: nodes that are clamped, a node set, or numbers separated by commas")
      ->type_name("NODES");
  const auto several = [&](const char* name, std::vector<std::string>& value, const char* meaning) {
    c.add_option(name, value, meaning)
        ->type_name("NODES")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->expected(1)
        ->allow_extra_args(false);
  };
  several("--interface", a.interfaces,
          "Nodes to attach to, a rigid section with static modes: a set, a node, or name=17,18,19; repeatable");
  several("--station", a.stations, "A node to attach to without modes of its own; repeatable");
  c.add_option("--modes", a.modes, "Number of normal modes with the interfaces held")
      ->check(CLI::Range(0, 200))
      ->capture_default_str();
  c.add_option("--highest", a.highest, "Drop modes of the reduced body above this frequency [Hz]")
      ->type_name("HZ")
      ->check(CLI::PositiveNumber);
  c.add_option("--out", a.out, "Scene, default: FILE with .yaml; of a mesh Standard Input Data, default: JOB.SID_FEM")
      ->type_name("FILE");
  c.add_flag("--force", a.force, "Replace a scene that is there");
  add_common(c, a);
  return [arguments] {
    return exchange::is_model_file(arguments->job) ? import_model(*arguments) : import_mesh(*arguments);
  };
}

}  // namespace

const Command import_command = {
    "import", "Make a scene of a URDF, MJCF or ElastoDyn file; reduce a finite-element mesh to a modal body",
    "  withy import scenes/models/double-pendulum.urdf --flexible scenes/models/bending-arm.yaml\n"
    "  withy import scenes/models/blade.dat --length 61.5 --out blade.yaml\n"
    "  withy import scenes/meshes/cantilever --root ROOT --interface TIP --modes 6\n"
    "  withy import scenes/meshes/cantilever --root ROOT --station 85 --modes 4 --out boom.SID_FEM",
    &add_import};

}  // namespace withy::app
