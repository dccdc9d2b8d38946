#include "withy/program/fold.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <vector>

namespace withy::program {
namespace {

constexpr std::size_t most_columns = 100, least_columns = 40;
/// Labels are no longer.
constexpr std::size_t most_label = 40;

std::size_t characters(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

bool is_rule(std::string_view line) {
  return line.size() > 2 && line.find_first_not_of("- ") == std::string_view::npos;
}

void add_folded(std::string_view line, std::size_t width, std::string& out) {
  const std::size_t first = std::min(line.find_first_not_of(' '), line.size());
  const std::size_t gap = line.find("  ", first);
  const bool labelled = gap < most_label;
  const std::size_t begin = labelled ? std::min(line.find_first_not_of(' ', gap), line.size()) : first;
  const std::string below = '\n' + std::string(std::min(labelled ? begin : first + 2, width / 2), ' ');
  out += line.substr(0, begin);
  std::size_t used = characters(line.substr(0, begin));
  bool fresh = true;  // whether no word stands on the line yet
  for (std::string_view rest = line.substr(begin); !rest.empty();) {
    const std::string_view word = rest.substr(0, rest.find(' '));
    rest.remove_prefix(std::min(word.size() + 1, rest.size()));
    if (!fresh && used + 1 + characters(word) > width) {
      out += below;
      used = below.size() - 1;
    } else if (!fresh) {
      out += ' ';
      ++used;
    }
    out += word;
    used += characters(word);
    fresh = false;
  }
}

}  // namespace

std::size_t columns_of(int stream) noexcept {
  if (::isatty(stream) != 1) return 0;
  winsize size{};
  if (::ioctl(stream, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return most_columns;
  return std::clamp<std::size_t>(size.ws_col, least_columns, most_columns);
}

std::string folded(std::string_view text, std::size_t width) {
  const bool ended = text.ends_with('\n');
  std::string out;
  while (!text.empty()) {
    // Lines up to an empty one, as they belong together.
    std::vector<std::string_view> lines;
    while (!text.empty() && (lines.empty() || !lines.back().empty())) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      lines.push_back(text.substr(0, end));
      text.remove_prefix(std::min(end + 1, text.size()));
    }
    const bool table = std::any_of(lines.begin(), lines.end(), is_rule);
    for (const std::string_view line : lines) {
      const bool command = line.substr(std::min(line.find_first_not_of(' '), line.size())).starts_with("withy ");
      if (table || command || characters(line) <= width)
        out += line;
      else
        add_folded(line, width, out);
      out += '\n';
    }
  }
  if (!ended && !out.empty()) out.pop_back();
  return out;
}

}  // namespace withy::program
