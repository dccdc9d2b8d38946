// Arrays for MATLAB and NumPy, read back by the rules of the formats.
#include "withy/results/array_files.hpp"

#include <gtest/gtest.h>

#include <boost/crc.hpp>
#include <cstdint>
#include <cstring>
#include <map>

namespace withy::test {
namespace {

template <class T>
T number_at(const std::string& bytes, std::size_t at) {
  T value;
  EXPECT_LE(at + sizeof(T), bytes.size());
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

const Eigen::MatrixXd matrix = (Eigen::MatrixXd(2, 3) << 1, 2.5, -3, 1e300, 0, 7).finished();
const std::vector<std::string> names = {"shoulder.0", "", "größe \xf0\x9d\x84\x9e"};

/// A data element of a MAT-file: its type, where its content begins, its size and where the next one begins.
struct Element {
  std::uint32_t type;
  std::size_t begin, size, next;
};
Element element_at(const std::string& bytes, std::size_t at) {
  const auto size = number_at<std::uint32_t>(bytes, at + 4);
  return {number_at<std::uint32_t>(bytes, at), at + 8, size, at + 8 + (size + 7) / 8 * 8};
}

/// What an array says of itself, and its elements after the name.
struct MatArray {
  std::uint32_t kind;
  std::int32_t rows, columns;
  std::string name;
  std::vector<Element> content;
};
MatArray array_at(const std::string& bytes, const Element& e) {
  EXPECT_EQ(e.type, 14U) << "a matrix";
  const Element flags = element_at(bytes, e.begin), size = element_at(bytes, flags.next),
                name = element_at(bytes, size.next);
  EXPECT_EQ(flags.type, 6U);
  EXPECT_EQ(size.type, 5U);
  EXPECT_EQ(name.type, 1U);
  MatArray a{number_at<std::uint32_t>(bytes, flags.begin) & 0xffU,
             number_at<std::int32_t>(bytes, size.begin),
             number_at<std::int32_t>(bytes, size.begin + 4),
             bytes.substr(name.begin, name.size),
             {}};
  for (std::size_t at = name.next; at < e.begin + e.size; at = a.content.back().next)
    a.content.push_back(element_at(bytes, at));
  return a;
}

TEST(MatFile, ReadsBackByTheRulesOfLevelFive) {
  const std::string bytes = mat_file({{"A", matrix}, {"names", names}, {"none", Eigen::MatrixXd(0, 2)}});
  EXPECT_EQ(bytes.substr(0, 10), "MATLAB 5.0");
  EXPECT_EQ(bytes.substr(124, 4), std::string("\0\1IM", 4));
  const Element first = element_at(bytes, 128), second = element_at(bytes, first.next),
                third = element_at(bytes, second.next);
  EXPECT_EQ(third.next, bytes.size());
  const MatArray a = array_at(bytes, first);
  EXPECT_EQ(a.name, "A");
  EXPECT_EQ(a.kind, 6U);
  ASSERT_EQ(a.rows * a.columns, 6);
  ASSERT_EQ(a.content.size(), 1U);
  for (Eigen::Index i = 0; i < 6; ++i)
    EXPECT_EQ(number_at<double>(bytes, a.content[0].begin + 8 * static_cast<std::size_t>(i)), matrix(i))
        << "by columns";
  const MatArray cells = array_at(bytes, second);
  EXPECT_EQ(cells.kind, 1U);
  ASSERT_EQ(cells.content.size(), names.size());
  const MatArray text = array_at(bytes, cells.content[0]);
  EXPECT_EQ(text.kind, 4U);
  EXPECT_EQ(text.columns, 10);
  for (std::size_t i = 0; i < 10; ++i)
    EXPECT_EQ(number_at<std::uint16_t>(bytes, text.content[0].begin + 2 * i), names[0][i]);
  const MatArray accents = array_at(bytes, cells.content[2]);
  EXPECT_EQ(accents.columns, 8) << "a character beyond the basic plane takes two";
  EXPECT_EQ(number_at<std::uint16_t>(bytes, accents.content[0].begin + 4), 0xf6) << "ö";
  EXPECT_EQ(number_at<std::uint16_t>(bytes, accents.content[0].begin + 12), 0xd834) << "the first of a pair";
  EXPECT_EQ(array_at(bytes, third).columns, 2);
}

TEST(NpzFile, IsAnArchiveOfArraysWithoutPickles) {
  const std::string bytes = npz_file({{"A", matrix}, {"names", names}});
  // From the end, as readers do.
  const std::size_t end = bytes.size() - 22;
  ASSERT_EQ(number_at<std::uint32_t>(bytes, end), 0x06054b50U);
  ASSERT_EQ(number_at<std::uint16_t>(bytes, end + 10), 2);
  std::map<std::string, std::string> files;
  std::size_t at = number_at<std::uint32_t>(bytes, end + 16);
  for (int k = 0; k < 2; ++k) {
    ASSERT_EQ(number_at<std::uint32_t>(bytes, at), 0x02014b50U);
    const auto size = number_at<std::uint32_t>(bytes, at + 24);
    const auto length = number_at<std::uint16_t>(bytes, at + 28);
    const std::string name = bytes.substr(at + 46, length);
    const std::size_t local = number_at<std::uint32_t>(bytes, at + 42);
    EXPECT_EQ(number_at<std::uint32_t>(bytes, local), 0x04034b50U);
    EXPECT_EQ(bytes.substr(local + 30, length), name);
    files[name] = bytes.substr(local + 30 + length, size);
    boost::crc_32_type crc;
    crc.process_bytes(files[name].data(), size);
    EXPECT_EQ(number_at<std::uint32_t>(bytes, at + 16), crc.checksum());
    at += 46U + length;
  }
  EXPECT_EQ(at, end);
  const std::string& a = files.at("A.npy");
  const std::size_t head = 10U + number_at<std::uint16_t>(a, 8);
  EXPECT_EQ(head % 64, 0U);
  EXPECT_EQ(a.substr(0, 8), std::string("\x93NUMPY\1\0", 8));
  EXPECT_NE(a.find("'descr': '<f8', 'fortran_order': True, 'shape': (2, 3)"), std::string::npos);
  ASSERT_EQ(a.size(), head + 6 * sizeof(double));
  for (Eigen::Index i = 0; i < 6; ++i)
    EXPECT_EQ(number_at<double>(a, head + 8 * static_cast<std::size_t>(i)), matrix(i));
  EXPECT_NE(files.at("names.npy").find("'<U10', 'fortran_order': True, 'shape': (3,)"), std::string::npos);
}

}  // namespace
}  // namespace withy::test
