#include "withy/fem/import.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace withy::fem {
namespace {

/// "TIP" or "17" names itself; "tip=17,18,19" gives nodes a name.
Interface interface_of(const Mesh& mesh, const std::string& text) {
  const std::size_t equals = text.find('=');
  Interface interface;
  interface.name = text.substr(0, equals);
  interface.nodes = nodes_of(mesh, equals == std::string::npos ? text : text.substr(equals + 1));
  if (interface.name.find_first_of(",. \t=") != std::string::npos || interface.name.empty())
    throw InputError(fmt::format("got '{}'; nodes without a set need a name, as tip=17,18,19", text));
  if (interface.name == "root")
    throw InputError(fmt::format(
        "got '{}'; `root` is the place where a body is held, so no node may have the name: give it another, "
        "as tip={}",
        text, text.substr(equals + 1)));
  return interface;
}

struct Files {
  std::filesystem::path mesh, stiffness, mass;
  bool calculix;
};

/// The files of a job of CalculiX, or those that the command line names.
Files files_of(const ImportJob& a) {
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

std::filesystem::path freedoms_of(const ImportJob& a) { return a.job + ".dof"; }

Matrices matrices_of(const ImportJob& a, const Files& f, const Mesh& mesh) {
  if (!f.calculix) return combined(read_abaqus(f.stiffness, mesh), read_abaqus(f.mass, mesh), mesh);
  const std::filesystem::path freedoms = freedoms_of(a);
  return combined(read_calculix(f.stiffness, freedoms), read_calculix(f.mass, freedoms), mesh);
}

SecondOrder second_order_of(const Mesh& mesh, const Matrices& matrices, const ReductionOptions& options,
                            Reduction& body) {
  try {
    return {add_second_order(mesh, matrices, options, body), ""};
  } catch (const InputError& e) {
    return {0, e.what()};
  }
}

/// Numbers of the second-order displacements of all vertices.
Eigen::Index second_order_numbers(const OuterFaces& outer, const Reduction& body) {
  const Eigen::Index n = body.modes.cols();
  return 3 * static_cast<Eigen::Index>(outer.rows.size()) * (n * (n + 1) / 2);
}

Drawn drawn_as(const Mesh& mesh, const Matrices& matrices, const ReductionOptions& options, const Reduction& body) {
  Drawn drawn;
  std::vector<std::string> lacking;
  try {
    OuterFaces outer = outer_faces(mesh, matrices);
    const bool large =
        outer.triangles() > most_drawn_triangles || second_order_numbers(outer, body) > most_second_order;
    if (large && outer.polygons.size() > outer.faces) {
      outer = outer_faces(mesh, matrices, FaceEdges::straight);
      lacking.emplace_back("edges straight, for with the nodes in their middles the file would be too large");
    }
    if (!outer.left_out.empty()) lacking.push_back(fmt::format("without its elements of type {}", outer.left_out));
    Eigen::MatrixXd second;
    if (body.second_order.empty())
      lacking.emplace_back("without the second order, for the geometric stiffness is not known");
    else if (second_order_numbers(outer, body) > most_second_order)
      lacking.emplace_back("without the second order, which would make the file too large");
    else
      second = second_order_displacements(mesh, matrices, options, body);
    drawn.text = surface_text(body, outer, second);
    drawn.vertices = outer.rows.size();
    drawn.faces = outer.faces;
  } catch (const InputError& e) {
    lacking = {e.what()};
  }
  drawn.lacking = fmt::format("{}", fmt::join(lacking, ", "));
  return drawn;
}

}  // namespace

std::vector<std::filesystem::path> files_read(const ImportJob& job) {
  const Files files = files_of(job);
  return {files.mesh, files.stiffness, files.mass, freedoms_of(job)};
}

Imported import(const ImportJob& job) {
  const Files files = files_of(job);
  const Mesh mesh = read_mesh(files.mesh);
  const Matrices matrices = matrices_of(job, files, mesh);
  ReductionOptions options;
  options.root = nodes_of(mesh, job.root);
  options.modes = job.modes;
  options.highest = job.highest;
  for (const std::string& text : job.interfaces) options.interfaces.push_back(interface_of(mesh, text));
  for (const std::string& text : job.stations) options.stations.push_back(interface_of(mesh, text));
  Imported result;
  result.body = reduce(matrices, options);
  result.second_order = second_order_of(mesh, matrices, options, result.body);
  result.data = sid_of(result.body);
  static_cast<void>(body_of(result.data, {}, result.as_body));
  result.summary = summary_of(matrices, result.body, result.data);
  result.drawn = drawn_as(mesh, matrices, options, result.body);
  return result;
}

}  // namespace withy::fem
