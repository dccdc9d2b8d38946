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
  std::string out;  ///< empty: <job>.SID_FEM
};

ExitStatus import_mesh(const ImportArguments& a) {
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

std::function<ExitStatus()> add_import_mesh(CLI::App& c) {
  const auto arguments = std::make_shared<ImportArguments>();
  ImportArguments& a = *arguments;
  c.add_option("JOB", a.job, "Name of the job: JOB.inp, and of CalculiX JOB.sti, JOB.mas and JOB.dof")->required();
  c.add_option("--mesh", a.mesh, "Input deck or .frd file with the nodes; default: JOB.inp")->type_name("FILE");
  c.add_option("--stiffness", a.stiffness, "Stiffness matrix of Abaqus (*_STIF*.mtx)")->type_name("FILE");
  c.add_option("--mass", a.mass_matrix, "Mass matrix of Abaqus (*_MASS*.mtx)")->type_name("FILE");
  c.add_option("--root", a.root, "Nodes that are clamped: a node set, or numbers separated by commas")
      ->type_name("NODES")
      ->required();
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
  c.add_option("--out", a.out, "File of Standard Input Data; default: JOB.SID_FEM")->type_name("FILE");
  add_common(c, a);
  return [arguments] { return import_mesh(*arguments); };
}

}  // namespace

const Command import_command = {
    "import", "Reduce a finite-element mesh to a modal body",
    "  withy import scenes/meshes/cantilever --root ROOT --interface TIP --modes 6\n"
    "  withy import scenes/meshes/cantilever --root ROOT --station 85 --modes 4 --out boom.SID_FEM",
    &add_import_mesh};

}  // namespace withy::app
