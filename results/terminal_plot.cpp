#include "withy/results/terminal_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <tuple>

namespace withy {
namespace {

constexpr int panel_columns = 66, panel_rows = 10;  ///< characters of a panel; each is two by four dots
constexpr int end_digits = 4;                       ///< of the ends of its axes, where these tell them apart
constexpr std::size_t least_room = 10;              ///< characters for them

/// Dots of one panel. A character with dots of one curve is a Braille pattern; with several curves all are letters.
class Canvas {
 public:
  explicit Canvas(bool letters)
      : letters_(letters), patterns_(panel_columns * panel_rows), owners_(panel_columns * panel_rows, ' ') {}
  /// \param x, y dots from the lower left corner
  void dot(int x, int y, char owner) {
    if (x < 0 || x >= 2 * panel_columns || y < 0 || y >= 4 * panel_rows) return;
    static constexpr unsigned bits[4][2] = {{0x40, 0x80}, {0x04, 0x20}, {0x02, 0x10}, {0x01, 0x08}};
    const auto at = static_cast<std::size_t>((panel_rows - 1 - y / 4) * panel_columns + x / 2);
    patterns_[at] |= bits[y % 4][x % 2];
    owners_[at] = owner;
  }
  [[nodiscard]] std::string line(int row) const {
    std::string text;
    for (int c = 0; c < panel_columns; ++c) {
      const auto at = static_cast<std::size_t>(row * panel_columns + c);
      const unsigned code = 0x2800 + patterns_[at];
      if (patterns_[at] == 0)
        text += ' ';
      else if (letters_)
        text += owners_[at];
      else
        text += {static_cast<char>(0xE0 | code >> 12), static_cast<char>(0x80 | (code >> 6 & 0x3F)),
                 static_cast<char>(0x80 | (code & 0x3F))};
    }
    return text;
  }

 private:
  bool letters_;
  std::vector<unsigned> patterns_;
  std::vector<char> owners_;
};

/// What the curves of a pen are drawn with where there are several.
char letter(std::size_t pen) {
  constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
  return letters[pen % letters.size()];
}

/// "s" of "t [s]".
std::string unit_of_label(const std::string& label) {
  const std::size_t begin = label.rfind('[') + 1;  // 0 where there is none
  return begin == 0 ? "" : ' ' + label.substr(begin, label.rfind(']') - begin);
}

void draw(Canvas& canvas, const Curve& curve, char owner, double x0, double x1, double y0, double y1) {
  const auto place = [](double v, double low, double high, int dots) {
    return high > low ? static_cast<int>(std::lround((v - low) / (high - low) * (dots - 1))) : dots / 2;
  };
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    const int x = place(curve.x[i], x0, x1, 2 * panel_columns), y = place(curve.y[i], y0, y1, 4 * panel_rows);
    const bool joined = i > 0 && !std::binary_search(curve.behind_gaps.begin(), curve.behind_gaps.end(), i);
    const std::size_t before = joined ? i - 1 : i;
    const int px = place(curve.x[before], x0, x1, 2 * panel_columns),
              py = place(curve.y[before], y0, y1, 4 * panel_rows);
    const int steps = std::max({std::abs(x - px), std::abs(y - py), 1});
    for (int s = 0; s <= steps; ++s) canvas.dot(px + (x - px) * s / steps, py + (y - py) * s / steps, owner);
  }
}

std::string panel_text(const Panel& panel) {
  double x0 = std::numeric_limits<double>::infinity(), x1 = -x0;
  if (!panel.free_x) std::tie(x0, x1) = panel.x_range;
  for (const Curve& curve : panel.curves) {
    for (const double x : curve.x) {
      x0 = std::min(x0, x);
      x1 = std::max(x1, x);
    }
  }
  const auto [y0, y1] = panel.y_range;
  const auto pen_of = [&](std::size_t c) { return panel.curves[c].pen.value_or(c); };
  bool several = false;
  for (std::size_t c = 1; c < panel.curves.size(); ++c) several = several || pen_of(c) != pen_of(0);
  Canvas canvas(several);
  for (std::size_t c = 0; c < panel.curves.size(); ++c)
    draw(canvas, panel.curves[c], letter(pen_of(c)), x0, x1, y0, y1);
  const std::vector<std::string> y_texts = mark_texts({y0, y1}, end_digits), x_texts = mark_texts({x0, x1}, end_digits);
  const std::size_t room = std::max({least_room, y_texts[0].size(), y_texts[1].size()});
  std::string out = panel.y_label + '\n';
  for (int r = 0; r < panel_rows; ++r) {
    const std::string mark = r == 0 ? y_texts[1] : (r == panel_rows - 1 ? y_texts[0] : std::string());
    out += fmt::format("{:>{}} |{}\n", mark, room, canvas.line(r));
  }
  return out + fmt::format("{:>{}}+{:-<{}}\n{:>{}}{}{:>{}}\n", "", room + 1, "", panel_columns, "", room + 2,
                           x_texts[0], x_texts[1] + unit_of_label(panel.x_label),
                           panel_columns - static_cast<int>(x_texts[0].size()));
}

}  // namespace

std::string terminal_plot(const std::vector<std::string>& legend, const std::vector<Panel>& panels) {
  std::string out;
  for (std::size_t i = 0; legend.size() > 1 && i < legend.size(); ++i)
    out += fmt::format("{} {}\n", letter(i), legend[i]);
  for (const Panel& panel : panels) {
    if (!out.empty()) out += '\n';
    out += panel_text(panel);
  }
  return out;
}

}  // namespace withy
