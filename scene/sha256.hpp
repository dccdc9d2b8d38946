/// \file
/// SHA-256 (FIPS 180-4): what tells whether two files, scenes or results are the same.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace withy {

/// Takes bytes piece by piece. A copy goes on by itself.
class Sha256 {
 public:
  Sha256();
  void add(std::string_view bytes);
  /// Of everything added so far: 64 hexadecimal digits.
  [[nodiscard]] std::string digest() const;

 private:
  void add_block(const unsigned char* block);

  std::array<std::uint32_t, 8> state_;
  std::array<unsigned char, 64> block_;  ///< the first `size_ % 64` are taken
  std::uint64_t size_ = 0;               ///< bytes added
};

/// Of one text: 64 hexadecimal digits.
std::string sha256(std::string_view bytes);

}  // namespace withy
