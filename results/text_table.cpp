#include "withy/results/text_table.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace withy {
namespace {

/// Characters, not bytes: those of UTF-8 that continue a character are not counted.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

constexpr std::size_t most_columns = 100;    ///< characters of a line
constexpr std::size_t least_for_words = 24;  ///< characters that words go on below each other in
constexpr std::size_t column_gap = 2;

/// The words of a text in lines of so many characters, one line at least; a word that is longer has one of its own.
std::vector<std::string> lines_of(const std::string& text, std::size_t width) {
  constexpr const char* blank = " \t\n\v\f\r";
  std::vector<std::string> lines(1);
  std::size_t used = 0;
  for (std::size_t begin = text.find_first_not_of(blank), end = 0; begin != std::string::npos;
       begin = text.find_first_not_of(blank, end)) {
    end = std::min(text.find_first_of(blank, begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    const std::size_t more = width_of(word);
    if (!lines.back().empty() && used + 1 + more > width) lines.emplace_back();
    if (lines.back().empty()) {
      used = more;
    } else {
      lines.back() += ' ';
      used += 1 + more;
    }
    lines.back() += word;
  }
  return lines;
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
  const std::vector<std::size_t> widths = this->widths();
  const std::size_t n = widths.size(), named = std::min(n, leading());
  std::vector<std::size_t> columns(n);
  std::iota(columns.begin(), columns.end(), std::size_t{0});
  if (total(columns, widths) <= most_columns) return block(columns, widths);
  // Words of a last column go on below each other; else what does not fit stands below, behind what names the rows.
  std::vector<std::size_t> others(columns.begin(), columns.end() - 1);
  if (flush_left_.back() && total(others, widths) + column_gap + least_for_words <= most_columns) return folded(widths);
  std::string out;
  columns.resize(named);
  for (std::size_t c = named; c < n; ++c) {
    columns.push_back(c);
    if (columns.size() <= named + 1 || total(columns, widths) <= most_columns) continue;
    columns.pop_back();
    out += block(columns, widths) + '\n';
    columns.resize(named);
    columns.push_back(c);
  }
  return out + block(columns, widths);
}

std::vector<std::size_t> TextTable::widths() const {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < head_.size(); ++c) {
    widths.push_back(std::max(width_of(head_[c]), width_of(lower_[c])));
    for (const auto& row : rows_) widths[c] = std::max(widths[c], width_of(row[c]));
  }
  return widths;
}

/// Columns that name a row: those to the left that are flush left, and the first.
std::size_t TextTable::leading() const {
  const auto first = std::find(flush_left_.begin(), flush_left_.end(), false);
  return std::max<std::size_t>(1, static_cast<std::size_t>(first - flush_left_.begin()));
}

std::size_t TextTable::total(const std::vector<std::size_t>& columns, const std::vector<std::size_t>& widths) {
  std::size_t sum = 0;
  for (const std::size_t c : columns) sum += widths[c] + (sum > 0 ? column_gap : 0);
  return sum;
}

std::string TextTable::line(const std::vector<std::string>& cells, const std::vector<std::size_t>& columns,
                            const std::vector<std::size_t>& widths) const {
  std::string line;
  for (const std::size_t c : columns) {
    const std::size_t space = widths[c] - width_of(cells[c]);
    if (c != columns.front()) line.append(column_gap, ' ');
    if (!flush_left_[c]) line.append(space, ' ');
    line += cells[c];
    if (flush_left_[c]) line.append(space, ' ');
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line + '\n';
}

std::string TextTable::block(const std::vector<std::size_t>& columns, const std::vector<std::size_t>& widths) const {
  std::string out;
  if (std::any_of(columns.begin(), columns.end(), [this](std::size_t c) { return !head_[c].empty(); }))
    out += line(head_, columns, widths);
  out += line(lower_, columns, widths) + std::string(total(columns, widths), '-') + '\n';
  for (const auto& row : rows_) out += line(row, columns, widths);
  return out;
}

std::string TextTable::folded(std::vector<std::size_t> widths) const {
  const std::size_t last = widths.size() - 1;
  std::size_t before = 0;
  for (std::size_t c = 0; c < last; ++c) before += widths[c] + column_gap;
  widths[last] = most_columns - before;
  TextTable narrow;
  narrow.head_ = head_;
  narrow.lower_ = lower_;
  narrow.flush_left_ = flush_left_;
  for (const auto& row : rows_) {
    std::vector<std::string> now(row.begin(), row.end() - 1);
    for (std::string& text : lines_of(row[last], widths[last])) {
      now.push_back(std::move(text));
      narrow.rows_.push_back(std::move(now));
      now.assign(last, "");
    }
  }
  std::vector<std::size_t> columns(widths.size());
  std::iota(columns.begin(), columns.end(), std::size_t{0});
  widths[last] = std::max(widths[last], narrow.widths()[last]);  // a word may be longer
  return narrow.block(columns, widths);
}

}  // namespace withy
