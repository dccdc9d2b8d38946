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
constexpr std::uintmax_t most_bytes = std::uintmax_t{64} << 20;

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
  double coordinate() {
    const std::string_view text = word();
    double x = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(x))
      refuse_line(fmt::format("got '{}'; need a coordinate", text));
    return x;
  }
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

}  // namespace

TriangleMesh read_mesh(const std::filesystem::path& file) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(file, none)) refuse(fmt::format("there is no file '{}'", file.string()));
  if (std::filesystem::file_size(file, none) > most_bytes)
    refuse(fmt::format("need a file of at most {} MiB", most_bytes >> 20));
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  if (!stream) refuse(fmt::format("'{}' cannot be read", file.string()));
  std::string end = file.extension().string();
  std::transform(end.begin(), end.end(), end.begin(), [](unsigned char c) { return std::tolower(c); });
  if (end != ".stl" && end != ".obj") refuse("need a file that ends in .stl or .obj");
  TriangleMesh mesh = end == ".stl" ? stl(bytes) : obj(bytes);
  if (mesh.triangles.empty()) refuse("it has no triangles");
  return mesh;
}

}  // namespace withy
