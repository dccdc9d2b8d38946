#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/bodies/modal/sid_body.hpp"
#include "withy/fem/reduce.hpp"
#include "withy/fem/summary.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"

namespace withy::app {
namespace {

/// Files of a finite-element program, and what to reduce them to.
struct ImportArguments : CommonArguments {
  std::string job;          ///< of CalculiX: the files' name without extension
  std::string mesh;         ///< input deck or result file; empty: that of the job
  std::string stiffness;    ///< of Abaqus; empty: the job's
  std::string mass_matrix;  ///< the same
  std::string root;         ///< node set or numbers
  std::vector<std::string> interfaces;
  std::vector<std::string> stations;
  int modes = 10;      ///< fixed-interface modes
  double highest = 0;  ///< [Hz]; 0: none
  std::string out;     ///< empty: <job>.SID_FEM
};

using Json = nlohmann::ordered_json;

/// "TIP" or "17" names itself; "tip=17,18,19" gives nodes a name.
fem::Interface interface_of(const fem::Mesh& mesh, const std::string& text) {
  const std::size_t equals = text.find('=');
  fem::Interface interface;
  interface.name = text.substr(0, equals);
  interface.nodes = fem::nodes_of(mesh, equals == std::string::npos ? text : text.substr(equals + 1));
  if (interface.name.find_first_of(",. \t=") != std::string::npos || interface.name.empty())
    throw InputError(fmt::format("got '{}'; nodes without a set need a name, as tip=17,18,19", text));
  return interface;
}

struct Files {
  std::filesystem::path mesh, stiffness, mass;
  bool calculix;
};

/// The files of a job of CalculiX, or those that the command line names.
Files files_of(const ImportArguments& a) {
  const std::filesystem::path job = a.job;
  const auto with = [&](const char* extension) { return std::filesystem::path(a.job + extension); };
  Files f{a.mesh.empty() ? with(".inp") : std::filesystem::path(a.mesh), a.stiffness, a.mass_matrix, false};
  if (f.stiffness.empty() != f.mass.empty()) throw InputError("need both --stiffness and --mass, or neither");
  f.calculix = f.stiffness.empty();
  if (f.calculix) {
    f.stiffness = with(".sti");
    f.mass = with(".mas");
  }
  return f;
}

fem::Matrices matrices_of(const ImportArguments& a, const Files& f, const fem::Mesh& mesh) {
  if (!f.calculix) return fem::combined(fem::read_abaqus(f.stiffness, mesh), fem::read_abaqus(f.mass, mesh), mesh);
  const std::filesystem::path freedoms = a.job + ".dof";
  return fem::combined(fem::read_calculix(f.stiffness, freedoms), fem::read_calculix(f.mass, freedoms), mesh);
}

/// Whether the geometric stiffness is known.
struct SecondOrder {
  double imbalance = 0;  ///< of stresses and unit loads, relative
  std::string lacking;   ///< why it is not known; empty where it is
};

SecondOrder second_order_of(const fem::Mesh& mesh, const fem::Matrices& matrices, const fem::ReductionOptions& options,
                            fem::Reduction& body) {
  try {
    return {fem::add_second_order(mesh, matrices, options, body), ""};
  } catch (const fem::InputError& e) {
    return {0, e.what()};
  }
}

Json vector_json(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

Json report_json(const fem::Reduction& body, const fem::Summary& s, const sid::Data& data, const SidReport& sid,
                 const SecondOrder& second_order, const std::string& file) {
  Json j;
  j["file"] = file;
  j["origin"] = vector_json(body.origin);
  const Matrix3& I = s.inertia;
  j["mass"] = {{"mass", s.mass},
               {"center_of_mass", vector_json(s.centre)},
               {"inertia", {I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)}},
               {"difference_from_mesh", s.mesh_difference},
               {"stiffness_of_rigid_motions", s.rigid_stiffness}};
  j["modes"] = Json::array();
  for (Eigen::Index k = 0; k < body.omega.size(); ++k) {
    Json shares = Json::array();
    for (Eigen::Index d = 0; d < 6; ++d) shares.push_back(s.effective_mass(k, d));
    j["modes"].push_back({{"frequency", body.frequency(k)}, {"effective_mass", shares}});
  }
  j["effective_mass"] = s.held;
  j["fixed_interface_frequencies"] = body.fixed_frequencies;
  j["dropped_frequencies"] = body.dropped_frequencies;
  j["nodes"] = Json::array();
  for (const sid::Node& node : data.nodes)
    j["nodes"].push_back({{"name", node.id}, {"position", vector_json(node.origin.m0)}});
  j["geometric_stiffness"] = {{"known", second_order.lacking.empty()}};
  if (second_order.lacking.empty()) {
    j["geometric_stiffness"]["unit_loads"] = body.second_order.size();
    j["geometric_stiffness"]["imbalance"] = second_order.imbalance;
  } else {
    j["geometric_stiffness"]["reason"] = second_order.lacking;
  }
  j["missing"] = sid.missing;
  return j;
}

std::string scene_snippet(const std::string& file, const sid::Data& data) {
  const std::string base = data.nodes.front().id;
  std::string text = fmt::format(
      "bodies:\n  part:\n    type: modal\n    file: {}   # relative to the scene\n    damping_ratio: 0.01\nhinges:\n"
      "  mount: {{type: weld, parent: world, child: part}}   # holds the nodes of the root\n",
      std::filesystem::path(file).filename().string());
  for (const sid::Node& node : data.nodes) {
    if (node.id != base) text += fmt::format("  # parent: part.{} attaches there\n", node.id);
  }
  return text;
}

std::string report_text(const Json& j) {
  const auto numbers = [](const Json& list, const char* format) {
    // What is rounding beside the greatest of them is shown as zero.
    double most = 0;
    for (const Json& x : list) most = std::max(most, std::abs(x.get<double>()));
    std::string text;
    for (const Json& x : list) {
      const double number = x.get<double>();
      text += (text.empty() ? "" : ", ") +
              fmt::format(fmt::runtime(format), std::abs(number) < 1e-12 * most ? 0.0 : number);
    }
    return text;
  };
  const Json& m = j["mass"];
  std::string out = fmt::format("origin of the body, in the mesh   {} m\n\n", numbers(j["origin"], "{:.6g}"));
  out += fmt::format("mass                              {:.9g} kg\n", m["mass"].get<double>());
  out += fmt::format("centre of mass                    {} m\n", numbers(m["center_of_mass"], "{:.6g}"));
  out +=
      fmt::format("inertia about it                  {} kg m^2 (xx yy zz xy xz yz)\n", numbers(m["inertia"], "{:.6g}"));
  out += fmt::format("these differ from the mesh's by   {:.1g}\n", m["difference_from_mesh"].get<double>());
  out += fmt::format("rigid motions meet                {:.1g} of the greatest stiffness\n\n",
                     m["stiffness_of_rigid_motions"].get<double>());
  out += "mode   frequency [Hz]   effective mass and inertia, % (x y z, about x y z)\n";
  std::size_t number = 0;
  for (const Json& mode : j["modes"]) {
    out += fmt::format("{:>4}   {:>14.6g}  ", ++number, mode["frequency"].get<double>());
    for (const Json& share : mode["effective_mass"]) out += fmt::format(" {:>6.2f}", 100 * share.get<double>());
    out += '\n';
  }
  out += fmt::format("{:>23} ", "all");
  for (const Json& share : j["effective_mass"]) out += fmt::format(" {:>6.2f}", 100 * share.get<double>());
  out += '\n';
  if (!j["fixed_interface_frequencies"].empty())
    out += fmt::format("\nleft out: motions with the interfaces held above {:.6g} Hz\n",
                       j["fixed_interface_frequencies"].back().get<double>());
  if (!j["dropped_frequencies"].empty())
    out += fmt::format("dropped: {} modes, from {:.6g} Hz on\n", j["dropped_frequencies"].size(),
                       j["dropped_frequencies"][0].get<double>());
  const Json& stiffness = j["geometric_stiffness"];
  if (stiffness["known"].get<bool>()) {
    out += fmt::format("\ngeometric stiffness of             {} unit loads, which the stresses balance within {:.1g}\n",
                       stiffness["unit_loads"].get<int>(), stiffness["imbalance"].get<double>());
  } else {
    out += fmt::format("\nno geometric stiffness: {}\n", stiffness["reason"].get<std::string>());
  }
  for (const Json& lack : j["missing"]) out += fmt::format("missing: {}\n", lack.get<std::string>());
  return out;
}

ExitStatus import_mesh(const ImportArguments& a) {
  try {
    const Files files = files_of(a);
    const fem::Mesh mesh = fem::read_mesh(files.mesh);
    const fem::Matrices matrices = matrices_of(a, files, mesh);
    fem::ReductionOptions options;
    options.root = fem::nodes_of(mesh, a.root);
    options.modes = a.modes;
    options.highest = a.highest;
    for (const std::string& text : a.interfaces) options.interfaces.push_back(interface_of(mesh, text));
    for (const std::string& text : a.stations) options.stations.push_back(interface_of(mesh, text));
    fem::Reduction body = fem::reduce(matrices, options);
    const SecondOrder second_order = second_order_of(mesh, matrices, options, body);
    const sid::Data data = fem::sid_of(body);
    // What the modal body will make of it, before anything is written.
    SidReport sid_report;
    (void)body_of(data, {}, sid_report);
    const std::string file = a.out.empty() ? std::filesystem::path(a.job).filename().string() + ".SID_FEM" : a.out;
    write_file(file, sid::write(data));
    const Json j = report_json(body, fem::summary_of(matrices, body, data), data, sid_report, second_order, file);
    print(a.json ? json_text(j)
                 : report_text(j) + "\nwritten: " + file + "; in a scene:\n\n" + scene_snippet(file, data));
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
