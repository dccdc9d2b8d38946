#include "withy/scene/mesh_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

namespace withy {
namespace {

// The format is little-endian, and so is every machine that this program is built for.
static_assert(std::endian::native == std::endian::little);

constexpr std::size_t stl_head = 80, stl_facet = 50;
constexpr std::uintmax_t most_mesh_bytes = std::uintmax_t{64} << 20;

[[noreturn]] void refuse(const std::string& why) { throw std::domain_error(why); }

/// Words of a text, line by line.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  /// False at the end of the text.
  bool next() {
    if (rest_.empty()) return false;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    line_ = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++number_;
    return true;
  }
  /// The next word of the line; empty at its end.
  std::string_view word() {
    constexpr std::string_view blank = " \t\r";
    line_.remove_prefix(std::min(line_.find_first_not_of(blank), line_.size()));
    const std::string_view found = line_.substr(0, line_.find_first_of(blank));
    line_.remove_prefix(found.size());
    return found;
  }
  [[noreturn]] void refuse_line(const std::string& why) const { refuse(fmt::format("line {}: {}", number_, why)); }
  [[nodiscard]] double number_in(std::string_view text) const {
    double x = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(x))
      refuse_line(fmt::format("got '{}'; need a coordinate", text));
    return x;
  }
  double coordinate() { return number_in(word()); }
  Vector3 point() {
    const double x = coordinate(), y = coordinate(), z = coordinate();
    return {x, y, z};
  }

 private:
  std::string_view rest_, line_;
  int number_ = 0;
};

/// A mesh as it is read, in which equal vertices are one.
class Welded {
 public:
  void add(const std::array<Vector3, 3>& corners) {
    check_count();
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3& v = corners[i];
      const auto [at, fresh] = known_.try_emplace({v.x(), v.y(), v.z()}, mesh.vertices.size());
      if (fresh) mesh.vertices.push_back(v);
      triangle[i] = static_cast<std::uint32_t>(at->second);
    }
    mesh.triangles.push_back(triangle);
  }
  void check_count() const {
    if (mesh.triangles.size() >= most_triangles)
      refuse(fmt::format("need at most {} triangles; make a coarser mesh of it for the picture", most_triangles));
  }
  TriangleMesh mesh;

 private:
  std::map<std::array<double, 3>, std::size_t> known_;
};

TriangleMesh binary_stl(std::string_view bytes, std::uint32_t count) {
  Welded welded;
  for (std::uint32_t k = 0; k < count; ++k) {
    std::array<float, 12> facet{};  // normal, three corners
    std::memcpy(facet.data(), bytes.data() + stl_head + 4 + k * stl_facet, sizeof facet);
    std::array<Vector3, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = Vector3(facet[3 * i + 3], facet[3 * i + 4], facet[3 * i + 5]);
      if (!corners[i].allFinite()) refuse(fmt::format("facet {} has a coordinate that is no finite number", k + 1));
    }
    welded.add(corners);
  }
  return std::move(welded.mesh);
}

TriangleMesh text_stl(std::string_view text) {
  Welded welded;
  Lines lines(text);
  std::array<Vector3, 3> corners;
  std::size_t count = 0;
  bool ended = false;
  while (lines.next()) {
    const std::string_view word = lines.word();
    ended = ended || word == "endsolid";
    if (word == "vertex") {
      if (count == 3) lines.refuse_line("a facet with more than three vertices");
      corners[count++] = lines.point();
    } else if (word == "endfacet") {
      if (count != 3) lines.refuse_line(fmt::format("a facet with {} vertices; need three", count));
      welded.add(corners);
      count = 0;
    }
  }
  if (!ended)
    refuse("it is no STL, or not all of one: neither text that ends with 'endsolid' nor as long as its facets");
  return std::move(welded.mesh);
}

/// Of "7", "7/1/2" or "-1", counted from the last: the vertex from 0.
std::uint32_t obj_index(std::string_view word, std::size_t vertices, const Lines& lines) {
  long index = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
  const bool read = error == std::errc() && (end == word.data() + word.size() || *end == '/');
  const long at = index < 0 ? static_cast<long>(vertices) + index : index - 1;
  if (!read || index == 0 || at < 0 || at >= static_cast<long>(vertices))
    lines.refuse_line(fmt::format("got '{}'; need one of the {} vertices before it", word, vertices));
  return static_cast<std::uint32_t>(at);
}

TriangleMesh obj(std::string_view text) {
  Welded welded;
  TriangleMesh& mesh = welded.mesh;
  Lines lines(text);
  std::vector<std::uint32_t> face;
  while (lines.next()) {
    const std::string_view word = lines.word();
    if (word == "v") mesh.vertices.push_back(lines.point());
    if (word != "f") continue;
    face.clear();
    for (std::string_view corner = lines.word(); !corner.empty(); corner = lines.word())
      face.push_back(obj_index(corner, mesh.vertices.size(), lines));
    if (face.size() < 3) lines.refuse_line(fmt::format("a face of {} vertices; need three or more", face.size()));
    for (std::size_t k = 2; k < face.size(); ++k) {
      welded.check_count();
      mesh.triangles.push_back({face[0], face[k - 1], face[k]});
    }
  }
  return std::move(mesh);
}

TriangleMesh stl(std::string_view bytes) {
  // Text begins with "solid", but so do some binary files: their size tells them apart.
  std::uint32_t count = 0;
  if (bytes.size() >= stl_head + 4) std::memcpy(&count, bytes.data() + stl_head, sizeof count);
  if (bytes.size() >= stl_head + 4 && bytes.size() == stl_head + 4 + std::size_t{count} * stl_facet)
    return binary_stl(bytes, count);
  if (bytes.starts_with("solid")) return text_stl(bytes);
  refuse(
      fmt::format("it is no STL, or not all of one: neither text, which begins with 'solid', nor the {} bytes of the "
                  "{} facets that "
                  "its head tells",
                  stl_head + 4 + std::size_t{count} * stl_facet, count));
}

std::string bytes_of(const std::filesystem::path& file) {
  std::error_code none;
  if (!std::filesystem::exists(file, none)) refuse(fmt::format("there is no file '{}'", file.string()));
  if (!std::filesystem::is_regular_file(file, none))
    refuse(fmt::format("'{}' is a folder, pipe or device; need a file", file.string()));
  if (std::filesystem::file_size(file, none) > most_mesh_bytes)
    refuse(fmt::format("need a file of at most {} MiB", most_mesh_bytes >> 20));
  std::ifstream stream(file, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  if (!stream) refuse(fmt::format("'{}' cannot be read", file.string()));
  return bytes;
}

/// Of a file's name, in small letters.
std::string ending(const std::filesystem::path& file) {
  std::string end = file.extension().string();
  std::transform(end.begin(), end.end(), end.begin(), [](unsigned char c) { return std::tolower(c); });
  return end;
}

/// "mode_3" or "mode_3_5" from 1, as 2, or 2 and 4; nothing for other names.
std::vector<Eigen::Index> modes_named(std::string_view name) {
  std::vector<Eigen::Index> modes;
  constexpr std::string_view begin = "mode";
  if (!name.starts_with(begin)) return {};
  for (name.remove_prefix(begin.size()); !name.empty() && modes.size() < 3;) {
    Eigen::Index mode = 0;
    const auto [end, error] = std::from_chars(name.data() + 1, name.data() + name.size(), mode);
    if (name.front() != '_' || name.size() < 2 || error != std::errc() || mode < 1) return {};
    modes.push_back(mode - 1);
    name.remove_prefix(static_cast<std::size_t>(end - name.data()));
  }
  return modes.size() > 2 ? std::vector<Eigen::Index>{} : modes;
}

/// Reads the polygons of a VTK file in text and the vectors of their vertices.
class VtkReader {
 public:
  explicit VtkReader(std::string_view text) : lines_(text) {}

  ModeSurface read() {
    bool ascii = false, polygons = false;
    while (lines_.next()) {
      const std::string_view word = lines_.word();
      if (word == "ASCII") ascii = true;
      if (word == "DATASET" && lines_.word() != "POLYDATA") lines_.refuse_line("need DATASET POLYDATA");
      if ((word == "POINTS" || word == "POLYGONS") && !ascii)
        lines_.refuse_line("need a VTK file in text, which says ASCII before its points");
      if (word == "POINTS") points();
      if (word == "POLYGONS") faces();
      polygons = polygons || word == "POLYGONS";
      if (word == "VECTORS") vectors();
    }
    if (!polygons) refuse("it is no VTK file with POLYGONS, or not all of one");
    return surface();
  }

 private:
  /// The next number, on this line or a later one.
  double number() {
    std::string_view word = lines_.word();
    while (word.empty()) {
      if (!lines_.next()) refuse("the file ends within its numbers");
      word = lines_.word();
    }
    return lines_.number_in(word);
  }
  std::size_t count(double most) {
    const double x = number();
    if (!(x >= 0 && x <= most && x == std::floor(x)))
      lines_.refuse_line(fmt::format("got {}; need a whole number from 0 to {}", x, most));
    return static_cast<std::size_t>(x);
  }

  void points() {
    mesh_.vertices.resize(count(most_triangles));
    lines_.word();  // the type of the numbers
    for (Vector3& v : mesh_.vertices)
      for (double& x : v) x = number();
  }
  void faces() {
    const std::size_t polygons = count(most_triangles);
    count(8.0 * most_triangles);  // numbers, with each polygon's count
    const auto vertices = static_cast<double>(mesh_.vertices.size());
    std::vector<std::uint32_t> face;
    for (std::size_t p = 0; p < polygons; ++p) {
      face.resize(count(1000));
      for (std::uint32_t& v : face) v = static_cast<std::uint32_t>(count(vertices - 1));
      for (std::size_t k = 2; k < face.size(); ++k) mesh_.triangles.push_back({face[0], face[k - 1], face[k]});
      if (mesh_.triangles.size() > most_triangles)
        refuse(fmt::format("need at most {} triangles; import a coarser mesh for the picture", most_triangles));
    }
  }
  void vectors() {
    const std::string_view name = lines_.word();
    const std::vector<Eigen::Index> modes = modes_named(name);
    if (modes.empty()) lines_.refuse_line(fmt::format("got vectors '{}'; need mode_1, or mode_1_2 of a pair", name));
    lines_.word();  // the type of the numbers
    Eigen::VectorXf column(3 * static_cast<Eigen::Index>(mesh_.vertices.size()));
    for (float& x : column) x = static_cast<float>(number());
    if (!shapes_.emplace(modes, std::move(column)).second)
      lines_.refuse_line("the vectors before this line have a name that others have");
  }

  /// Columns in the order of the modes.
  ModeSurface surface() {
    const auto n = std::count_if(shapes_.begin(), shapes_.end(), [](const auto& s) { return s.first.size() == 1; });
    const auto pairs = static_cast<Eigen::Index>(shapes_.size()) - n;
    const auto rows = 3 * static_cast<Eigen::Index>(mesh_.vertices.size());
    ModeSurface surface{std::move(mesh_), Eigen::MatrixXf(rows, n), Eigen::MatrixXf(rows, pairs)};
    const auto take = [&](std::vector<Eigen::Index> modes, auto column) {
      const auto found = shapes_.find(modes);
      std::string name = "mode";
      for (const Eigen::Index k : modes) name += fmt::format("_{}", k + 1);
      if (found == shapes_.end()) refuse(fmt::format("it has no vectors '{}' beside those of other modes", name));
      column = found->second;
    };
    Eigen::Index pair = 0;
    for (Eigen::Index k = 0; k < n; ++k) {
      take({k}, surface.first.col(k));
      for (Eigen::Index l = k; pairs > 0 && l < n; ++l) {
        if (pair == pairs) refuse("it has vectors of some pairs of modes; need those of all, or none");
        take({k, l}, surface.second.col(pair++));
      }
    }
    if (pair != pairs) refuse("it has vectors of pairs of modes that it has not");
    return surface;
  }

  Lines lines_;
  TriangleMesh mesh_;
  std::map<std::vector<Eigen::Index>, Eigen::VectorXf> shapes_;
};

}  // namespace

TriangleMesh read_mesh(const std::filesystem::path& file) {
  const std::string bytes = bytes_of(file);
  const std::string end = ending(file);
  if (end != ".stl" && end != ".obj") refuse("need a file that ends in .stl or .obj");
  TriangleMesh mesh = end == ".stl" ? stl(bytes) : obj(bytes);
  if (mesh.triangles.empty()) refuse("it has no triangles");
  return mesh;
}

ModeSurface read_mode_surface(const std::filesystem::path& file) {
  const std::string bytes = bytes_of(file);
  if (ending(file) != ".vtk") refuse("need a file that ends in .vtk, which withy import writes");
  return VtkReader(bytes).read();
}

}  // namespace withy
