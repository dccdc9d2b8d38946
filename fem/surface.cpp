#include "surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <span>

namespace withy::fem {
namespace {

using Face = std::vector<std::size_t>;

// Corners of the faces, counter-clockwise from outside; numbering as in element_shape.cpp.
const std::vector<Face> of_tetrahedron = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
const std::vector<Face> of_wedge = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
const std::vector<Face> of_brick = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

const std::vector<Face>& faces_of(const Element& element) {
  switch (element.nodes.size()) {
    case 4:
    case 10:
      return of_tetrahedron;
    case 6:
    case 15:
      return of_wedge;
    default:
      return of_brick;
  }
}

/// Outer faces by numbers of nodes, in the order of the elements.
std::vector<std::vector<long>> faces_once(const Mesh& mesh) {
  std::map<std::vector<long>, int> times;
  const auto corners_of = [](const Element& element, const Face& face) {
    std::vector<long> corners;
    for (const std::size_t corner : face) corners.push_back(element.nodes.at(corner));
    return corners;
  };
  const auto sorted = [](std::vector<long> corners) {
    std::sort(corners.begin(), corners.end());
    return corners;
  };
  for (const auto& [number, element] : mesh.elements)
    for (const Face& face : faces_of(element)) ++times[sorted(corners_of(element, face))];
  std::vector<std::vector<long>> once;
  for (const auto& [number, element] : mesh.elements)
    for (const Face& face : faces_of(element)) {
      std::vector<long> corners = corners_of(element, face);
      if (times.at(sorted(corners)) == 1) once.push_back(std::move(corners));
    }
  return once;
}

/// Numbers of one vector a line.
template <class Column>
void append_vectors(const Column& column, const OuterFaces& outer, std::string& text) {
  const auto out = std::back_inserter(text);
  for (const Eigen::Index row : outer.rows)
    fmt::format_to(out, "{:.7g} {:.7g} {:.7g}\n", column[3 * row], column[3 * row + 1], column[3 * row + 2]);
}

}  // namespace

OuterFaces outer_faces(const Mesh& mesh, const Matrices& matrices) {
  if (!mesh.other_elements.empty())
    throw InputError(
        fmt::format("the deck has elements of type {}, whose faces are not known", *mesh.other_elements.begin()));
  if (mesh.elements.empty()) throw InputError("there are no elements in the mesh's file");
  for (const auto& [number, element] : mesh.elements)
    if (element.nodes.size() < 4) throw InputError(fmt::format("element {} lacks nodes", number));
  const std::vector<std::vector<long>> faces = faces_once(mesh);
  OuterFaces outer;
  for (const std::vector<long>& face : faces)
    for (const long node : face) {
      const auto at = std::lower_bound(matrices.nodes.begin(), matrices.nodes.end(), node);
      if (at == matrices.nodes.end() || *at != node)
        throw InputError(fmt::format("node {} of the deck's elements is not in the matrices", node));
      outer.rows.push_back(at - matrices.nodes.begin());
    }
  std::vector<Eigen::Index> corners = outer.rows;  // of all faces, one behind the other
  std::sort(outer.rows.begin(), outer.rows.end());
  outer.rows.erase(std::unique(outer.rows.begin(), outer.rows.end()), outer.rows.end());
  std::size_t next = 0;
  for (const std::vector<long>& face : faces) {
    std::vector<std::uint32_t>& own = outer.faces.emplace_back();
    for (std::size_t i = 0; i < face.size(); ++i) {
      const auto at = std::lower_bound(outer.rows.begin(), outer.rows.end(), corners[next++]);
      own.push_back(static_cast<std::uint32_t>(at - outer.rows.begin()));
    }
  }
  return outer;
}

std::string surface_text(const Reduction& body, const OuterFaces& outer, const Eigen::MatrixXd& second) {
  std::string text = fmt::format(
      "# vtk DataFile Version 3.0\nouter faces and shapes of modes, written by withy import\nASCII\nDATASET "
      "POLYDATA\nPOINTS {} float\n",
      outer.rows.size());
  append_vectors(body.X.reshaped(), outer, text);
  std::size_t numbers = outer.faces.size();
  for (const auto& face : outer.faces) numbers += face.size();
  text += fmt::format("POLYGONS {} {}\n", outer.faces.size(), numbers);
  for (const auto& face : outer.faces) text += fmt::format("{} {}\n", face.size(), fmt::join(face, " "));
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
