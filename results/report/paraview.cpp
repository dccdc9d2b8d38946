#include "withy/results/report/paraview.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "withy/results/output_file.hpp"
#include "withy/results/report/base64.hpp"

namespace withy {
namespace {

namespace fs = std::filesystem;

template <class Number>
constexpr const char* vtk_type = nullptr;
template <>
constexpr const char* vtk_type<float> = "Float32";
template <>
constexpr const char* vtk_type<double> = "Float64";
template <>
constexpr const char* vtk_type<std::int32_t> = "Int32";
template <>
constexpr const char* vtk_type<std::uint8_t> = "UInt8";

/// An array in the text of a grid: its bytes behind their count.
template <class Number>
std::string array_text(const char* attributes, const std::vector<Number>& numbers) {
  std::vector<std::byte> bytes(sizeof(std::uint64_t) + numbers.size() * sizeof(Number));
  const std::uint64_t size = numbers.size() * sizeof(Number);
  std::memcpy(bytes.data(), &size, sizeof(size));
  if (size > 0) std::memcpy(bytes.data() + sizeof(size), numbers.data(), size);
  return fmt::format("<DataArray type=\"{}\" {} format=\"binary\">{}</DataArray>\n", vtk_type<Number>, attributes,
                     base64(bytes));
}

/// What does not change over a run.
struct Grid {
  std::vector<Surface> surfaces;
  std::size_t points = 0, cells = 0;
  std::string cell_text;  ///< cells, and the body of each
};

Grid grid_of(const Animation& run) {
  Grid grid;
  std::vector<std::int32_t> connectivity, offsets, bodies;
  for (std::size_t b = 0; b < run.bodies(); ++b) {
    grid.surfaces.push_back(run.surface(b));
    for (const auto& triangle : grid.surfaces.back().triangles) {
      for (const std::uint32_t v : triangle) connectivity.push_back(static_cast<std::int32_t>(grid.points + v));
      offsets.push_back(static_cast<std::int32_t>(connectivity.size()));
      bodies.push_back(static_cast<std::int32_t>(b));
    }
    grid.points += grid.surfaces.back().vertices.size();
  }
  grid.cells = offsets.size();
  constexpr std::uint8_t triangle = 5;  // in VTK
  grid.cell_text = "<CellData>\n" + array_text("Name=\"body\"", bodies) + "</CellData>\n<Cells>\n" +
                   array_text("Name=\"connectivity\"", connectivity) + array_text("Name=\"offsets\"", offsets) +
                   array_text("Name=\"types\"", std::vector<std::uint8_t>(grid.cells, triangle)) + "</Cells>\n";
  return grid;
}

template <class Number>
void append(const Vector3& v, std::vector<Number>& numbers) {
  for (const double x : v) numbers.push_back(static_cast<Number>(x));
}

std::string moment_text(const Animation& run, const Grid& grid, std::size_t moment) {
  std::vector<double> points;  // 32 bits would not tell apart the points of a satellite on its orbit
  std::vector<float> displacements;
  for (std::size_t b = 0; b < run.bodies(); ++b) {
    const Pose X = run.pose(b, moment), X_rest = run.undeformed(b, moment);
    const std::vector<Vector3>& rest = grid.surfaces[b].vertices;
    const std::vector<Vector3> now = run.flexible(b) ? run.vertices(b, moment) : rest;
    for (std::size_t v = 0; v < rest.size(); ++v) {
      const Vector3 p = X.p + X.R * now[v];
      append(p, points);
      append(p - (X_rest.p + X_rest.R * rest[v]), displacements);
    }
  }
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n"
      "<PointData Vectors=\"displacement\">\n{}</PointData>\n{}<Points>\n{}</Points>\n</Piece>\n</UnstructuredGrid>\n"
      "</VTKFile>\n",
      grid.points, grid.cells, array_text("Name=\"displacement\" NumberOfComponents=\"3\"", displacements),
      grid.cell_text, array_text("NumberOfComponents=\"3\"", points));
}

/// Whether a file is one that an earlier series may have: RUN_MOMENT.vtu.
bool of_series(const fs::path& file) {
  const std::string name = file.stem().string();
  return file.extension() == ".vtu" && name.find('_') != std::string::npos &&
         name.find_first_not_of("0123456789_") == std::string::npos;
}

}  // namespace

void write_paraview(const fs::path& file, const std::vector<Animation>& runs) {
  const fs::path folder = fs::path(file).replace_extension();
  fs::create_directories(folder);
  for (const fs::directory_entry& old : fs::directory_iterator(folder))
    if (of_series(old.path())) fs::remove(old.path());
  std::string series =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "<Collection>\n";
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const Grid grid = grid_of(runs[r]);
    for (std::size_t m = 0; m < runs[r].times().size(); ++m) {
      const std::string name = fmt::format("{}_{:04}.vtu", r + 1, m);
      write_file(folder / name, moment_text(runs[r], grid, m));
      series += fmt::format("<DataSet timestep=\"{}\" part=\"{}\" file=\"{}/{}\"/>\n", runs[r].times()[m], r,
                            folder.filename().string(), name);
    }
  }
  write_file(file, series + "</Collection>\n</VTKFile>\n");
}

}  // namespace withy
