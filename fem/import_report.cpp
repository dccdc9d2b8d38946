#include "withy/fem/import_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace withy::fem {
namespace {

using Json = nlohmann::ordered_json;

Json vector_json(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

Json import_json(const Imported& imported, const std::string& file) {
  const auto& [body, s, data, sid, second_order, drawn] = imported;
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
    j["modes"].push_back(
        {{"frequency", body.frequency(k)}, {"frequency_error", body.frequency_errors[k]}, {"effective_mass", shares}});
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
  j["surface"] = Json::object();
  if (!drawn.text.empty())
    j["surface"] = {{"file", surface_file(file)}, {"vertices", drawn.vertices}, {"faces", drawn.faces}};
  if (!drawn.lacking.empty()) j["surface"]["lacking"] = drawn.lacking;
  return j;
}

std::string surface_file(const std::string& file) {
  return std::filesystem::path(file).replace_extension(".vtk").string();
}

std::string scene_snippet(const std::string& file, const Imported& imported) {
  const sid::Data& data = imported.data;
  const std::string base = data.nodes.front().id;
  const auto name = [](const std::string& path) { return std::filesystem::path(path).filename().string(); };
  const std::string visual =
      imported.drawn.text.empty() ? "" : fmt::format("    visual: {{mesh: {}}}\n", name(surface_file(file)));
  std::string text = fmt::format(
      "bodies:\n  part:\n    type: modal\n    file: {}   # relative to the scene\n    damping_ratio: 0.01\n{}hinges:\n"
      "  mount: {{type: weld, parent: world, child: part}}   # holds the nodes of the root\n",
      name(file), visual);
  for (const sid::Node& node : data.nodes) {
    if (node.id != base) text += fmt::format("  # parent: part.{} attaches there\n", node.id);
  }
  return text;
}

std::string import_text(const Json& j) {
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
  out += fmt::format("rigid motions meet                {:.1g} of the greatest stiffness\n",
                     m["stiffness_of_rigid_motions"].get<double>());
  double error = 0;
  for (const Json& mode : j["modes"]) error = std::max(error, mode["frequency_error"].get<double>());
  out += fmt::format("its rounding moves frequencies by {:.1g} of themselves\n\n", error);
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
  const Json& surface = j["surface"];
  const std::string lacking = surface.value("lacking", "");
  if (surface.contains("file"))
    out +=
        fmt::format("drawn by                           {} outer faces with {} vertices{}\n",
                    surface["faces"].get<int>(), surface["vertices"].get<int>(), lacking.empty() ? "" : ", " + lacking);
  else
    out += fmt::format("drawn by the hull of its nodes: {}\n", lacking);
  return out;
}

}  // namespace withy::fem
