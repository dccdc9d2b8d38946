#include <fmt/format.h>

#include <algorithm>
#include <boost/crc.hpp>
#include <cstdint>
#include <cstring>

#include "withy/results/array_files.hpp"
#include "withy/results/utf8.hpp"

namespace withy {
namespace {

template <class T>
void append_bytes(std::string& out, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}

/// An array in NumPy's own format, version 1.0: a description in the form of a Python literal, then the numbers.
std::string npy(const std::string& type, const std::string& shape, const std::string& numbers) {
  std::string head = fmt::format("{{'descr': '{}', 'fortran_order': True, 'shape': {}, }}", type, shape);
  // What is before the numbers, its ten bytes of magic, version and length with it, is a multiple of 64.
  head.append(63 - (10 + head.size()) % 64, ' ');
  head += '\n';
  std::string out = "\x93NUMPY";
  out += '\1';
  out += '\0';
  append_bytes(out, static_cast<std::uint16_t>(head.size()));
  return out + head + numbers;
}

std::string npy(const NamedArray& a) {
  std::string numbers;
  if (const auto* matrix = std::get_if<Eigen::MatrixXd>(&a.content)) {
    for (Eigen::Index j = 0; j < matrix->cols(); ++j)
      for (Eigen::Index i = 0; i < matrix->rows(); ++i) append_bytes(numbers, (*matrix)(i, j));
    return npy("<f8", fmt::format("({}, {})", matrix->rows(), matrix->cols()), numbers);
  }
  std::vector<std::u32string> texts;
  std::size_t longest = 1;
  for (const std::string& t : std::get<std::vector<std::string>>(a.content)) {
    texts.push_back(code_points(t));
    longest = std::max(longest, texts.back().size());
  }
  for (std::u32string& t : texts) {
    t.resize(longest);
    for (const char32_t c : t) append_bytes(numbers, static_cast<std::uint32_t>(c));
  }
  return npy(fmt::format("<U{}", longest), fmt::format("({},)", texts.size()), numbers);
}

/// What the archive says of a file, in its own place and in the list at the end alike. The date is the first there is:
/// the same arrays give the same bytes.
std::string entry(const std::string& content, const std::string& name) {
  boost::crc_32_type crc;
  crc.process_bytes(content.data(), content.size());
  std::string out;
  append_bytes(out, std::uint16_t{20});  // version
  append_bytes(out, std::uint16_t{0});   // flags
  append_bytes(out, std::uint16_t{0});   // stored as it is
  append_bytes(out, std::uint16_t{0});
  append_bytes(out, std::uint16_t{0x21});  // 1 January 1980
  append_bytes(out, static_cast<std::uint32_t>(crc.checksum()));
  append_bytes(out, static_cast<std::uint32_t>(content.size()));
  append_bytes(out, static_cast<std::uint32_t>(content.size()));
  append_bytes(out, static_cast<std::uint16_t>(name.size()));
  append_bytes(out, std::uint16_t{0});
  return out;
}

}  // namespace

std::string npz_file(const std::vector<NamedArray>& arrays) {
  std::string out, list;
  for (const NamedArray& a : arrays) {
    const std::string content = npy(a), name = a.name + ".npy", said = entry(content, name);
    const auto at = static_cast<std::uint32_t>(out.size());
    out += "PK\3\4" + said + name + content;
    list += std::string("PK\1\2") + '\24' + '\0' + said;
    list.append(10, '\0');  // no comment, first disk, attributes
    append_bytes(list, at);
    list += name;
  }
  const auto at = static_cast<std::uint32_t>(out.size());
  out += list + "PK\5\6";
  append_bytes(out, std::uint32_t{0});
  append_bytes(out, static_cast<std::uint16_t>(arrays.size()));
  append_bytes(out, static_cast<std::uint16_t>(arrays.size()));
  append_bytes(out, static_cast<std::uint32_t>(list.size()));
  append_bytes(out, at);
  append_bytes(out, std::uint16_t{0});
  return out;
}

}  // namespace withy
