#include <cstdint>
#include <cstring>

#include "withy/results/array_files.hpp"
#include "withy/results/utf8.hpp"

namespace withy {
namespace {

/// Types of data elements and classes of arrays, by their numbers in the format ("MAT-File Format", MathWorks).
enum : std::uint32_t { mi_int8 = 1, mi_uint16 = 4, mi_int32 = 5, mi_uint32 = 6, mi_double = 9, mi_matrix = 14 };
enum : std::uint32_t { class_cell = 1, class_char = 4, class_double = 6 };

template <class T>
void put(std::string& out, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}

/// A data element: its type, its size without padding, and its bytes up to a multiple of eight.
std::string element(std::uint32_t type, const std::string& bytes) {
  std::string out;
  put(out, type);
  put(out, static_cast<std::uint32_t>(bytes.size()));
  out += bytes;
  out.append((8 - bytes.size() % 8) % 8, '\0');
  return out;
}

std::string array(std::uint32_t kind, Eigen::Index rows, Eigen::Index columns, const std::string& name,
                  const std::string& content) {
  std::string flags, dimensions;
  put(flags, kind);
  put(flags, std::uint32_t{0});
  put(dimensions, static_cast<std::int32_t>(rows));
  put(dimensions, static_cast<std::int32_t>(columns));
  return element(mi_matrix,
                 element(mi_uint32, flags) + element(mi_int32, dimensions) + element(mi_int8, name) + content);
}

std::string text(const std::string& utf8) {
  std::string units;
  Eigen::Index count = 0;
  for (const char32_t c : code_points(utf8)) {
    // Beyond the basic plane a character takes two.
    if (c >= 0x10000) {
      put(units, static_cast<std::uint16_t>(0xd800 + ((c - 0x10000) >> 10)));
      put(units, static_cast<std::uint16_t>(0xdc00 + ((c - 0x10000) & 0x3ff)));
      count += 2;
    } else {
      put(units, static_cast<std::uint16_t>(c));
      ++count;
    }
  }
  return array(class_char, count > 0 ? 1 : 0, count, "", element(mi_uint16, units));
}

std::string array(const NamedArray& a) {
  if (const auto* matrix = std::get_if<Eigen::MatrixXd>(&a.content)) {
    std::string numbers;
    for (Eigen::Index j = 0; j < matrix->cols(); ++j)
      for (Eigen::Index i = 0; i < matrix->rows(); ++i) put(numbers, (*matrix)(i, j));
    return array(class_double, matrix->rows(), matrix->cols(), a.name, element(mi_double, numbers));
  }
  const auto& texts = std::get<std::vector<std::string>>(a.content);
  std::string cells;
  for (const std::string& t : texts) cells += text(t);
  return array(class_cell, static_cast<Eigen::Index>(texts.size()), 1, a.name, cells);
}

}  // namespace

std::string mat_file(const std::vector<NamedArray>& arrays) {
  std::string out = "MATLAB 5.0 MAT-file, written by withy";
  out.resize(124, ' ');  // text, and no data of subsystems
  put(out, std::uint16_t{0x0100});
  put(out, std::uint16_t{0x4d49});  // "IM": the numbers are little-endian
  for (const NamedArray& a : arrays) out += array(a);
  return out;
}

}  // namespace withy
