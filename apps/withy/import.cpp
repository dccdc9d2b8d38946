#include "withy/exchange/import.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "withy/apps/withy/engine.hpp"
#include "withy/fem/import_report.hpp"
#include "withy/fem/surface.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/output_name.hpp"

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
  const std::filesystem::path name = a.out.empty() ? renamed(a.job, ".yaml") : std::filesystem::path(a.out);
  const std::string file = output_name("", name, a.force, {a.job, a.model.flexible});
  write_file(file, scene.text);
  print(a.json ? json_text(nlohmann::ordered_json{{"file", file}, {"from", scene.from}, {"remarks", scene.remarks}})
               : "read as " + scene.from + "\n" + written_text(scene.remarks, file));
  return ExitStatus::done;
}

/// The name of a job has no ending of its own: one that has may be a model's that is misspelt, or of another kind.
void check_is_mesh(const fem::ImportJob& a) {
  std::string missing;
  for (const std::filesystem::path& file : fem::files_read(a)) {
    if (std::filesystem::exists(file)) return;
    missing += (missing.empty() ? "no " : ", no ") + file.string();
  }
  throw InputError(a.job + " is no model, whose name ends with .urdf, .xml, .mjcf or .dat, and no mesh: there is " +
                   missing);
}

ExitStatus import_mesh(const ImportArguments& a) {
  check_is_mesh(a);
  if (a.root.empty()) throw InputError("--root is required: the nodes of the mesh that are clamped");
  try {
    const fem::Imported imported = fem::import(a);
    const auto read = fem::files_read(a);
    const std::string file =
        output_name(a.out, std::filesystem::path(a.job).filename().string() + ".SID_FEM", a.force, read);
    const std::string drawn = fem::surface_file(file);
    const std::string surface =
        output_name("", drawn, a.force || imported.drawn.text.empty() || fem::is_surface(drawn), read);
    write_file(file, sid::write(imported.data));
    if (!imported.drawn.text.empty()) write_file(surface, imported.drawn.text);
    const auto report = fem::import_json(imported, file);
    print(a.json ? json_text(report)
                 : fem::import_text(report) + "\nwritten: " + file + "; in a scene:\n\n" +
                       fem::scene_snippet(file, imported));
    return ExitStatus::done;
  } catch (const fem::InputError& e) {
    throw InputError(e.what());
  } catch (const std::domain_error& e) {
    throw InputError(e.what());
  }
}

void add_import(Options& o, ImportArguments& a) {
  o.argument("FILE", a.job,
             "A model, .urdf, .xml (URDF or MJCF) or .dat (ElastoDyn); or the job of a mesh: JOB.inp, and of "
             "CalculiX JOB.sti, JOB.mas and JOB.dof")
      .required();
  o.value("--flexible", a.model.flexible, "FILE", "Of a model: file with the links that are beams");
  o.flag("--free-base", a.model.free_base, "Of a URDF: its root link floats");
  o.flag("--mend-inertias", a.model.mend_inertias,
         "Of a model: the nearest inertias in the place of those that no mass can have, each with a remark");
  o.value("--length", a.model.length, "M", "Of a blade or tower of ElastoDyn").positive();
  o.value("--tip-mass", a.model.tip_mass, "KG", "What its tip carries, a point").positive();
  o.value("--mesh", a.mesh, "FILE", "Input deck or .frd file with the nodes; default: JOB.inp");
  o.value("--stiffness", a.stiffness, "FILE", "Stiffness matrix of Abaqus (*_STIF*.mtx)");
  o.value("--mass", a.mass_matrix, "FILE", "Mass matrix of Abaqus (*_MASS*.mtx)");
  o.value("--root", a.root, "NODES", "Of a mesh: nodes that are clamped, a node set, or numbers separated by commas");
  o.repeated("--interface", a.interfaces, "NODES",
             "Nodes to attach to, a rigid section with static modes: a set, a node, or name=17,18,19; repeatable");
  o.repeated("--station", a.stations, "NODES", "A node to attach to without modes of its own; repeatable");
  o.argument("--modes", a.modes, "Number of normal modes with the interfaces held").between(0, 200).with_default();
  o.value("--highest", a.highest, "HZ", "Drop modes of the reduced body above this frequency [Hz]").positive();
  o.value("--out", a.out, "FILE",
          "Scene, default: FILE with .yaml; of a mesh Standard Input Data, default: JOB.SID_FEM");
  o.flag("--force", a.force, "Replace a scene that is there, or a file that has the default name");
  add_common(o, a);
}

ExitStatus import_file(const ImportArguments& a) {
  return exchange::is_model_file(a.job) ? import_model(a) : import_mesh(a);
}

}  // namespace

const Command import_command = {
    "import", "Make a scene of a URDF, MJCF or ElastoDyn file; reduce a finite-element mesh to a modal body",
    "  withy import scenes/models/double-pendulum.urdf --flexible scenes/models/bending-arm.yaml\n"
    "  withy import scenes/models/blade.dat --length 61.5 --out blade.yaml\n"
    "  withy import scenes/meshes/cantilever --root ROOT --interface TIP --modes 6\n"
    "  withy import scenes/meshes/cantilever --root ROOT --station 85 --modes 4 --out boom.SID_FEM",
    &taking<ImportArguments, add_import, import_file>};

}  // namespace withy::app
