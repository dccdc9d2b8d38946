#include "matrices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <set>
#include <utility>

#include "text_lines.hpp"

namespace withy::fem {
namespace {

using Triplet = Eigen::Triplet<double>;

/// The whole matrix from triplets, rows from 0: all of it where an element off the diagonal stands there on both sides,
/// and then the sides must agree; else each element on one side of the diagonal, whichever. Programs that number their
/// rows otherwise than the nodes write a triangle of theirs, whose elements are on either side here.
SparseMatrix symmetric(const std::vector<Triplet>& triplets, Eigen::Index size, const std::filesystem::path& file) {
  SparseMatrix given(size, size);
  given.setFromTriplets(triplets.begin(), triplets.end());
  SparseMatrix lower = given.triangularView<Eigen::StrictlyLower>();
  const SparseMatrix upper = SparseMatrix(given.triangularView<Eigen::StrictlyUpper>()).transpose();
  if (SparseMatrix(lower.cwiseProduct(upper)).nonZeros() == 0) {
    lower += upper;
  } else if ((lower - upper).norm() > 1e-9 * lower.norm()) {
    throw InputError(file.string() + ": the matrix is not symmetric; need symmetric matrices");
  }
  SparseMatrix all = lower + SparseMatrix(lower.transpose());
  for (Eigen::Index i = 0; i < size; ++i) {
    if (const double d = given.coeff(i, i); d != 0) all.coeffRef(i, i) = d;
  }
  all.makeCompressed();
  return all;
}

[[noreturn]] void fault(const std::filesystem::path& file, int line, const std::string& message) {
  throw InputError(fmt::format("{}:{}: {}", file.string(), line, message));
}

std::vector<std::string_view> words(std::string_view line) {
  auto fields = split(line, " \t,");
  std::erase_if(fields, [](std::string_view f) { return f.empty(); });
  return fields;
}

double value_of(std::string_view text, const std::filesystem::path& file, int line) {
  const auto value = number_of<double>(text);
  if (!value || !std::isfinite(*value)) fault(file, line, fmt::format("got '{}'; need a finite number", text));
  return *value;
}

std::string in_small_letters(std::string_view text) {
  std::string small(text);
  std::transform(small.begin(), small.end(), small.begin(), [](unsigned char c) { return std::tolower(c); });
  return small;
}

/// In letters of any size, as other readers take it.
bool is_heading(std::string_view line) { return in_small_letters(line).starts_with("%%matrixmarket"); }

/// Refuses a file of Matrix Market that has no real matrix by rows and columns. What it says of symmetry is seen from
/// the elements.
void check_heading(std::string_view line, const std::filesystem::path& file, int number) {
  const std::string heading = in_small_letters(line);
  const auto fields = words(heading);
  const auto is = [&](std::size_t i, std::initializer_list<std::string_view> known) {
    return i < fields.size() && std::find(known.begin(), known.end(), fields[i]) != known.end();
  };
  if (!is(1, {"matrix"}) || !is(2, {"coordinate"}) || !is(3, {"real", "double", "integer"}) ||
      !is(4, {"general", "symmetric"}))
    fault(file, number, fmt::format("got '{}'; need matrix coordinate real (or integer) general (or symmetric)", line));
}

/// The number of elements, of "rows columns elements": the first line below the heading that is no remark.
std::size_t announced_elements(std::string_view line, Eigen::Index size, const std::filesystem::path& file,
                               int number) {
  const auto fields = words(line);
  const auto rows = fields.size() == 3 ? number_of<long>(fields[0]) : std::nullopt,
             columns = fields.size() == 3 ? number_of<long>(fields[1]) : std::nullopt;
  const auto entries = fields.size() == 3 ? number_of<std::size_t>(fields[2]) : std::nullopt;
  if (!rows || !columns || !entries) fault(file, number, "need the numbers of rows, columns and elements");
  if (*rows != size || *columns != size)
    fault(file, number, fmt::format("got a matrix of {} by {}; need {} by {}", *rows, *columns, size, size));
  return *entries;
}

/// Whether a first line without heading is "rows columns elements": its row and column are the last ones, its value is
/// a count, and the elements have that place too.
bool has_sizes_alone(std::string_view first, const std::vector<Triplet>& triplets, Eigen::Index size) {
  const auto is_last = [&](const Triplet& t) { return t.row() == size - 1 && t.col() == size - 1; };
  return number_of<std::size_t>(words(first).back()).has_value() && is_last(triplets.front()) &&
         std::any_of(triplets.begin() + 1, triplets.end(), is_last);
}

/// Lines "row column value", rows from 1, of a matrix of `size` rows; below the heading of Matrix Market, its line of
/// sizes, or both, where they are there.
std::vector<Triplet> read_triplets(std::string_view text, Eigen::Index size, const std::filesystem::path& file) {
  std::vector<Triplet> triplets;
  std::optional<std::size_t> announced;
  bool sizes_follow = false;
  Lines lines(text);
  std::string_view line, first;
  while (lines.next(line)) {
    line = trimmed(line);
    if (triplets.empty() && !announced && is_heading(line)) {
      check_heading(line, file, lines.number());
      sizes_follow = true;
    }
    if (line.empty() || line.front() == '%' || line.front() == '*') continue;
    if (std::exchange(sizes_follow, false)) {
      announced = announced_elements(line, size, file, lines.number());
      continue;
    }
    const auto fields = words(line);
    const auto row = fields.size() == 3 ? number_of<long>(fields[0]) : std::nullopt,
               column = fields.size() == 3 ? number_of<long>(fields[1]) : std::nullopt;
    if (!row || !column || *row < 1 || *column < 1) fault(file, lines.number(), "need a row, a column and a value");
    if (*row > size || *column > size)
      fault(file, lines.number(), fmt::format("got row {}, column {}; there are {} rows", *row, *column, size));
    if (triplets.empty()) first = line;
    triplets.emplace_back(*row - 1, *column - 1, value_of(fields[2], file, lines.number()));
  }
  if (!announced && !triplets.empty() && has_sizes_alone(first, triplets, size)) {
    announced = number_of<std::size_t>(words(first).back());
    triplets.erase(triplets.begin());
  }
  if (announced && *announced != triplets.size())
    throw InputError(
        fmt::format("{}: got {} elements; its line of sizes says {}", file.string(), triplets.size(), *announced));
  return triplets;
}

/// Whether the first line that is no remark has its fields between commas.
bool has_commas(std::string_view text) {
  Lines lines(text);
  std::string_view line;
  while (lines.next(line)) {
    line = trimmed(line);
    if (!line.empty() && line.front() != '*' && line.front() != '%') return line.find(',') != std::string_view::npos;
  }
  return false;
}

/// Lines "node, freedom, node, freedom, value".
NamedMatrix read_matrix_input(const std::string& text, const std::filesystem::path& file) {
  struct Entry {
    Freedom row, column;
    double value;
  };
  std::vector<Entry> entries;
  std::vector<Freedom> rows;
  Lines lines(text);
  std::string_view line;
  while (lines.next(line)) {
    line = trimmed(line);
    if (line.empty() || line.front() == '*') continue;
    const auto fields = split(line, ",");
    std::vector<long> n;
    for (std::size_t i = 0; i < std::min<std::size_t>(4, fields.size()); ++i) {
      if (const auto number = number_of<long>(fields[i])) n.push_back(*number);
    }
    if (n.size() != 4 || fields.size() < 5) fault(file, lines.number(), "need node, freedom, node, freedom, value");
    if (n[1] < 1 || n[1] > 3 || n[3] < 1 || n[3] > 3)
      fault(file, lines.number(), "a rotation or another freedom than 1 to 3; need a mesh of solid elements");
    const Entry e{{n[0], static_cast<int>(n[1]) - 1},
                  {n[2], static_cast<int>(n[3]) - 1},
                  value_of(fields[4], file, lines.number())};
    entries.push_back(e);
    rows.push_back(e.row);
    rows.push_back(e.column);
  }
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  const auto index = [&](const Freedom& f) {
    return static_cast<int>(std::lower_bound(rows.begin(), rows.end(), f) - rows.begin());
  };
  std::vector<Triplet> triplets;
  for (const Entry& e : entries) triplets.emplace_back(index(e.row), index(e.column), e.value);
  const auto size = static_cast<Eigen::Index>(rows.size());
  return {std::move(rows), symmetric(triplets, size, file)};
}

}  // namespace

NamedMatrix read_calculix(const std::filesystem::path& values, const std::filesystem::path& freedoms) {
  NamedMatrix matrix;
  const std::string text = text_of(freedoms);
  std::set<std::pair<long, int>> seen;
  Lines lines(text);
  std::string_view line;
  while (lines.next(line)) {
    line = trimmed(line);
    if (line.empty()) continue;
    const std::size_t dot = line.find('.');
    const auto node = number_of<long>(line.substr(0, dot));
    const auto axis = dot == std::string_view::npos ? std::nullopt : number_of<int>(line.substr(dot + 1));
    if (!node || !axis || *axis < 1 || *axis > 3)
      fault(freedoms, lines.number(), fmt::format("got '{}'; need a node and one of its axes 1 to 3, as 12.3", line));
    if (!seen.emplace(*node, *axis).second)
      fault(freedoms, lines.number(),
            fmt::format("freedom {} stands there twice: CalculiX makes solids of beams and shells and does not name "
                        "their nodes; need a mesh of solid elements",
                        line));
    matrix.rows.push_back({*node, *axis - 1});
  }
  const auto size = static_cast<Eigen::Index>(matrix.rows.size());
  matrix.values = symmetric(read_triplets(text_of(values), size, values), size, values);
  return matrix;
}

NamedMatrix read_abaqus(const std::filesystem::path& file, const Mesh& mesh) {
  const std::string text = text_of(file);
  if (has_commas(text)) return read_matrix_input(text, file);
  NamedMatrix matrix;
  for (const auto& [node, X] : mesh.nodes) {
    for (int axis = 0; axis < 3; ++axis) matrix.rows.push_back({node, axis});
  }
  const auto size = static_cast<Eigen::Index>(matrix.rows.size());
  const std::vector<Triplet> triplets = read_triplets(text, size, file);
  matrix.values = symmetric(triplets, size, file);
  const bool last =
      std::any_of(triplets.begin(), triplets.end(), [&](const Triplet& t) { return t.row() == size - 1; });
  if (!last)
    throw InputError(
        fmt::format("{}: there are fewer rows than 3 for each of the mesh's {} nodes, so that rows have no "
                    "names; write it with FORMAT=MATRIX INPUT",
                    file.string(), mesh.nodes.size()));
  return matrix;
}

SparseMatrix arranged(const NamedMatrix& matrix, const std::vector<long>& nodes) {
  std::vector<int> place;
  for (const Freedom& f : matrix.rows) {
    const auto it = std::lower_bound(nodes.begin(), nodes.end(), f.node);
    if (it == nodes.end() || *it != f.node)
      throw InputError(fmt::format("a matrix has node {}, which the others have not", f.node));
    place.push_back(3 * static_cast<int>(it - nodes.begin()) + f.axis);
  }
  std::vector<Triplet> triplets;
  for (Eigen::Index column = 0; column < matrix.values.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator it(matrix.values, column); it; ++it) {
      triplets.emplace_back(place[static_cast<std::size_t>(it.row())], place[static_cast<std::size_t>(it.col())],
                            it.value());
    }
  }
  const auto size = 3 * static_cast<Eigen::Index>(nodes.size());
  SparseMatrix all(size, size);
  all.setFromTriplets(triplets.begin(), triplets.end());
  return all;
}

Matrices combined(const NamedMatrix& K, const NamedMatrix& M, const Mesh& mesh) {
  Matrices m;
  std::map<long, int> axes;
  for (const Freedom& f : K.rows) axes[f.node] += 1 << f.axis;
  std::vector<long> nowhere;
  for (const auto& [node, which] : axes) {
    if (which != 7)
      throw InputError(
          fmt::format("node {} has not all of its freedoms 1 to 3: a boundary condition, or no solid "
                      "element; need the stiffness of the free mesh",
                      node));
    if (!mesh.nodes.contains(node)) nowhere.push_back(node);
    m.nodes.push_back(node);
  }
  if (!nowhere.empty())
    throw InputError(
        fmt::format("the matrices have {} nodes that the mesh file has not, the first is {}: nodes inside "
                    "elements, as of C3D8I? Mesh with others, as C3D20R",
                    nowhere.size(), nowhere.front()));
  if (m.nodes.empty()) throw InputError("the stiffness matrix has no rows");
  m.X.resize(3, static_cast<Eigen::Index>(m.nodes.size()));
  for (std::size_t a = 0; a < m.nodes.size(); ++a) m.X.col(static_cast<Eigen::Index>(a)) = mesh.nodes.at(m.nodes[a]);
  m.K = arranged(K, m.nodes);
  m.M = arranged(M, m.nodes);
  return m;
}

}  // namespace withy::fem
