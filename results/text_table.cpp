#include "withy/results/text_table.hpp"

#include <algorithm>

namespace withy {
namespace {

/// Characters, not bytes: those of UTF-8 that continue a character are not counted.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

}  // namespace

TextTable::TextTable(std::vector<std::string> head) : head_(std::move(head)) {
  for (std::string& h : head_) {
    flush_left_.push_back(h.starts_with('<'));
    if (flush_left_.back()) h.erase(0, 1);
    const std::size_t divide = h.find('\n');
    lower_.push_back(divide == std::string::npos ? h : h.substr(divide + 1));
    h.resize(divide == std::string::npos ? 0 : divide);
  }
}

std::string TextTable::str() const {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < head_.size(); ++c) {
    widths.push_back(std::max(width_of(head_[c]), width_of(lower_[c])));
    for (const auto& row : rows_) widths[c] = std::max(widths[c], width_of(row[c]));
  }
  std::string out;
  const auto add_line = [&](const std::vector<std::string>& cells) {
    std::string line;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const std::string space(widths[c] - width_of(cells[c]), ' ');
      if (c > 0) line += "  ";
      line += flush_left_[c] ? cells[c] + space : space + cells[c];
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + '\n';
  };
  if (std::any_of(head_.begin(), head_.end(), [](const std::string& h) { return !h.empty(); })) add_line(head_);
  add_line(lower_);
  std::size_t total = 0;
  for (const std::size_t w : widths) total += w + 2;
  out += std::string(total - 2, '-') + '\n';
  for (const auto& row : rows_) add_line(row);
  return out;
}

}  // namespace withy
