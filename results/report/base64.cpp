#include "withy/results/report/base64.hpp"

namespace withy {

std::string base64(std::span<const std::byte> bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text((bytes.size() + 2) / 3 * 4, '=');
  const auto byte = [&](std::size_t i) { return std::to_integer<std::uint32_t>(bytes[i]); };
  char* out = text.data();
  std::size_t i = 0;
  for (; i + 3 <= bytes.size(); i += 3, out += 4) {
    const std::uint32_t three = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    for (int k = 0; k < 4; ++k) out[k] = digits[three >> (18 - 6 * k) & 63];
  }
  const std::size_t rest = bytes.size() - i;
  const std::uint32_t last = rest == 0 ? 0 : byte(i) << 16 | (rest == 2 ? byte(i + 1) << 8 : 0);
  for (std::size_t k = 0; rest > 0 && k <= rest; ++k) out[k] = digits[last >> (18 - 6 * k) & 63];
  return text;
}

}  // namespace withy
