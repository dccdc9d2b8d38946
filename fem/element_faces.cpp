#include "element_faces.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <string_view>

namespace withy::fem {
namespace {

using Corners = std::vector<std::size_t>;
using Edge = std::array<std::size_t, 2>;

// Corners of the faces, counter-clockwise from outside, and the edges in the order of the nodes in their middles.
const std::vector<Corners> of_tetrahedron = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
const std::vector<Edge> tetrahedron_edges = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
const std::vector<Corners> of_wedge = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
const std::vector<Edge> wedge_edges = {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}};
const std::vector<Corners> of_brick = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                       {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
const std::vector<Edge> brick_edges = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                       {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};

/// The node between two corners: those of the edges follow on all corners.
std::size_t middle_of(std::size_t a, std::size_t b, const std::vector<Edge>& edges, std::size_t corners) {
  const auto at = std::find_if(edges.begin(), edges.end(),
                               [&](const Edge& e) { return (e[0] == a && e[1] == b) || (e[0] == b && e[1] == a); });
  return corners + static_cast<std::size_t>(at - edges.begin());
}

ElementFaces solid(std::size_t nodes, std::size_t corners, const std::vector<Corners>& faces,
                   const std::vector<Edge>& edges) {
  ElementFaces element{nodes, true, {}};
  for (const Corners& around : faces) {
    ElementFace& face = element.faces.emplace_back(ElementFace{around, {}, {}});
    for (std::size_t i = 0; nodes > corners && i < around.size(); ++i)
      face.middles.push_back(middle_of(around[i], around[(i + 1) % around.size()], edges, corners));
  }
  return element;
}

/// Corners, then middles of the edges, then the centre, as far as there are nodes.
ElementFaces sheet(std::size_t nodes) {
  ElementFace face;
  const std::size_t corners = nodes % 3 == 0 && nodes < 9 ? 3 : 4;
  for (std::size_t i = 0; i < corners; ++i) face.corners.push_back(i);
  for (std::size_t i = corners; i < std::min(nodes, 2 * corners); ++i) face.middles.push_back(i);
  if (nodes > 2 * corners) face.centre = 2 * corners;
  return {nodes, false, {face}};
}

using ByNodes = std::map<std::size_t, ElementFaces>;

ByNodes sheets(std::initializer_list<std::size_t> counts) {
  ByNodes all;
  for (const std::size_t nodes : counts) all.emplace(nodes, sheet(nodes));
  return all;
}

struct FaceKind {
  std::string_view begins;  ///< of the type, before the number of nodes
  ByNodes elements;
};

const std::vector<FaceKind>& kinds() {
  static const ByNodes solids = {{4, solid(4, 4, of_tetrahedron, tetrahedron_edges)},
                                 {10, solid(10, 4, of_tetrahedron, tetrahedron_edges)},
                                 {6, solid(6, 6, of_wedge, wedge_edges)},
                                 {15, solid(15, 6, of_wedge, wedge_edges)},
                                 {8, solid(8, 8, of_brick, brick_edges)},
                                 {20, solid(20, 8, of_brick, brick_edges)}};
  static const std::vector<FaceKind> all = {
      {"C3D", solids},
      {"SC", {{6, solids.at(6)}, {8, solids.at(8)}}},
      {"STRI", {{3, sheet(3)}, {65, sheet(6)}}},  // six nodes of five freedoms
      {"S", sheets({3, 4, 6, 8, 9})},
      {"M3D", sheets({3, 4, 6, 8, 9})},
      {"SFM3D", sheets({3, 4, 6, 8})},
      {"R3D", sheets({3, 4})},
  };
  return all;
}

}  // namespace

const ElementFaces* element_faces(const std::string& type) {
  // Such wedges may have nodes within their faces, as many as they like.
  if (type.starts_with("C3D15V")) return nullptr;
  for (const FaceKind& kind : kinds()) {
    if (!type.starts_with(kind.begins)) continue;
    std::size_t at = kind.begins.size(), nodes = 0;
    constexpr std::size_t most = 100;
    for (; at < type.size() && std::isdigit(static_cast<unsigned char>(type[at])) != 0 && nodes < most; ++at)
      nodes = 10 * nodes + static_cast<std::size_t>(type[at] - '0');
    const bool whole = at == type.size() || std::isalpha(static_cast<unsigned char>(type[at])) != 0;
    if (const auto found = kind.elements.find(nodes); whole && found != kind.elements.end()) return &found->second;
  }
  return nullptr;
}

}  // namespace withy::fem
