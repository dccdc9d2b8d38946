/// \file
/// Characters of a text.
#pragma once

#include <string>
#include <string_view>

namespace withy {

/// The characters of a text in UTF-8; a byte that is none of it stands for U+FFFD.
inline std::u32string code_points(std::string_view text) {
  std::u32string points;
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i++]);
    const int more = first < 0x80                    ? 0
                     : first >= 0xf0 && first < 0xf8 ? 3
                     : first >= 0xe0 && first < 0xf0 ? 2
                     : first >= 0xc2 && first < 0xe0 ? 1
                                                     : -1;
    char32_t point = more <= 0 ? first : first & (0x3fU >> more);
    bool good = more >= 0;
    for (int k = 0; good && k < more; ++k) {
      good = i < text.size() && (static_cast<unsigned char>(text[i]) & 0xc0U) == 0x80;
      if (good) point = (point << 6) | (static_cast<unsigned char>(text[i++]) & 0x3fU);
    }
    points += good ? point : U'\xfffd';
  }
  return points;
}

}  // namespace withy
