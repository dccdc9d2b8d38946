#include "surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>

#include "element_faces.hpp"

namespace withy::fem {
namespace {

constexpr std::string_view head_of_surfaces =
    "# vtk DataFile Version 3.0\nouter faces and shapes of modes, written by withy import\n";

/// Numbers of nodes, in the order of an element's face.
struct NodedFace {
  std::vector<long> corners, middles;
  std::optional<long> centre;
};

NodedFace face_of(const Element& element, const ElementFace& face) {
  NodedFace noded;
  for (const std::size_t i : face.corners) noded.corners.push_back(element.nodes.at(i));
  for (const std::size_t i : face.middles) noded.middles.push_back(element.nodes.at(i));
  if (face.centre) noded.centre = element.nodes.at(*face.centre);
  return noded;
}

std::vector<long> sorted_corners(const NodedFace& face) {
  std::vector<long> corners = face.corners;
  std::sort(corners.begin(), corners.end());
  return corners;
}

/// Of elements that are solid or that are not, in the order of their numbers.
std::vector<NodedFace> faces_of(const Mesh& mesh, bool solid) {
  std::vector<NodedFace> all;
  for (const auto* elements : {&mesh.elements, &mesh.drawn_only})
    for (const auto& [number, element] : *elements) {
      const ElementFaces& known = *element_faces(element.type);
      if (element.nodes.size() < known.nodes) throw InputError(fmt::format("element {} lacks nodes", number));
      if (known.solid != solid) continue;
      for (const ElementFace& face : known.faces) all.push_back(face_of(element, face));
    }
  return all;
}

/// Faces of one solid alone, then those of sheets: a skin that lies on a solid, or on a sheet of the same nodes, is
/// drawn with it.
std::vector<NodedFace> faces_seen(const Mesh& mesh) {
  std::vector<NodedFace> seen;
  std::map<std::vector<long>, int> times;
  std::vector<NodedFace> solids = faces_of(mesh, true);
  for (const NodedFace& face : solids) ++times[sorted_corners(face)];
  for (NodedFace& face : solids)
    if (times.at(sorted_corners(face)) == 1) seen.push_back(std::move(face));
  for (NodedFace& face : faces_of(mesh, false)) {
    int& before = times[sorted_corners(face)];
    if (before != 1) seen.push_back(std::move(face));
    before = 1;
  }
  return seen;
}

/// The polygons of a face by numbers of nodes.
std::vector<std::vector<long>> polygons_of(const NodedFace& face, FaceEdges edges) {
  const std::vector<long>&corners = face.corners, &middles = face.middles;
  if (middles.empty() || edges == FaceEdges::straight) return {corners};
  std::vector<std::vector<long>> polygons;
  const std::size_t n = corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    polygons.push_back({corners[i], middles[i], middles[(i + n - 1) % n]});
    if (face.centre) polygons.back().insert(polygons.back().begin() + 2, *face.centre);
  }
  if (!face.centre) polygons.push_back(middles);
  return polygons;
}

/// \throws InputError where the matrices do not have the node
Eigen::Index row_of(long node, const Matrices& matrices) {
  const auto at = std::lower_bound(matrices.nodes.begin(), matrices.nodes.end(), node);
  if (at == matrices.nodes.end() || *at != node)
    throw InputError(fmt::format("node {} of the deck's elements is not in the matrices", node));
  return at - matrices.nodes.begin();
}

/// Numbers of one vector a line.
template <class Column>
void append_vectors(const Column& column, const OuterFaces& outer, std::string& text) {
  const auto out = std::back_inserter(text);
  for (const Eigen::Index row : outer.rows)
    fmt::format_to(out, "{:.7g} {:.7g} {:.7g}\n", column[3 * row], column[3 * row + 1], column[3 * row + 2]);
}

}  // namespace

std::size_t OuterFaces::triangles() const {
  std::size_t count = 0;
  for (const auto& polygon : polygons) count += polygon.size() - 2;
  return count;
}

OuterFaces outer_faces(const Mesh& mesh, const Matrices& matrices, FaceEdges edges) {
  OuterFaces outer;
  if (!mesh.other_elements.empty()) outer.left_out = *mesh.other_elements.begin();
  const std::vector<NodedFace> faces = faces_seen(mesh);
  if (faces.empty())
    throw InputError(outer.left_out.empty()
                         ? "there are no elements in the mesh's file"
                         : fmt::format("the deck has elements of type {}, whose faces are not known", outer.left_out));
  outer.faces = faces.size();
  std::vector<std::vector<Eigen::Index>> polygons;
  for (const NodedFace& face : faces)
    for (const std::vector<long>& nodes : polygons_of(face, edges)) {
      std::vector<Eigen::Index>& own = polygons.emplace_back();
      for (const long node : nodes) own.push_back(row_of(node, matrices));
      outer.rows.insert(outer.rows.end(), own.begin(), own.end());
    }
  std::sort(outer.rows.begin(), outer.rows.end());
  outer.rows.erase(std::unique(outer.rows.begin(), outer.rows.end()), outer.rows.end());
  for (const std::vector<Eigen::Index>& polygon : polygons) {
    std::vector<std::uint32_t>& own = outer.polygons.emplace_back();
    for (const Eigen::Index row : polygon) {
      const auto at = std::lower_bound(outer.rows.begin(), outer.rows.end(), row);
      own.push_back(static_cast<std::uint32_t>(at - outer.rows.begin()));
    }
  }
  return outer;
}

bool is_surface(const std::filesystem::path& file) {
  std::string head(head_of_surfaces.size(), '\0');
  std::ifstream in(file, std::ios::binary);
  return in.read(head.data(), static_cast<std::streamsize>(head.size())) && head == head_of_surfaces;
}

std::string surface_text(const Reduction& body, const OuterFaces& outer, const Eigen::MatrixXd& second) {
  std::string text = fmt::format("{}ASCII\nDATASET POLYDATA\nPOINTS {} float\n", head_of_surfaces, outer.rows.size());
  append_vectors(body.X.reshaped(), outer, text);
  std::size_t numbers = outer.polygons.size();
  for (const auto& polygon : outer.polygons) numbers += polygon.size();
  text += fmt::format("POLYGONS {} {}\n", outer.polygons.size(), numbers);
  for (const auto& polygon : outer.polygons) text += fmt::format("{} {}\n", polygon.size(), fmt::join(polygon, " "));
  text += fmt::format("POINT_DATA {}\n", outer.rows.size());
  const Eigen::Index n = body.modes.cols();
  for (Eigen::Index k = 0; k < n; ++k) {
    text += fmt::format("VECTORS mode_{} float\n", k + 1);
    append_vectors(body.modes.col(k), outer, text);
  }
  Eigen::Index pair = 0;
  for (Eigen::Index k = 0; k < n && second.cols() > 0; ++k)
    for (Eigen::Index l = k; l < n; ++l) {
      text += fmt::format("VECTORS mode_{}_{} float\n", k + 1, l + 1);
      append_vectors(second.col(pair++), outer, text);
    }
  return text;
}

}  // namespace withy::fem
