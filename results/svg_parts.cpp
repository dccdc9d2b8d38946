#include "withy/results/svg_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <sstream>

namespace withy {
namespace {

/// A pen that is known when this is compiled.
struct PaletteEntry {
  const char *colour, *dashes;
  double thickness;
};
// Palette of Okabe and Ito. Thick below thin: curves that coincide stay visible.
constexpr std::array<PaletteEntry, 12> palette{{{"#e69f00", "none", 4.5},
                                                {"#d55e00", "7 3", 2.4},
                                                {"#56b4e9", "none", 3.2},
                                                {"#000000", "2 2", 1.4},
                                                {"#009e73", "10 3 2 3", 1.8},
                                                {"#cc79a7", "4 4", 1.6},
                                                {"#0072b2", "none", 2.0},
                                                {"#999999", "none", 2.4},
                                                {"#b8a800", "8 3", 2.0},
                                                {"#7f3c8d", "12 4", 1.6},
                                                {"#5d4037", "3 3", 2.0},
                                                {"#80ba5a", "6 2 2 2", 2.0}}};

/// How long a sample of a line must be to show its dashes: until they begin again.
double sample_length(const Pen& p) {
  constexpr double least = 34;
  std::istringstream dashes(p.dashes);
  double first = 0, all = 0;
  for (double length = 0; dashes >> length; all += length)
    if (all == 0) first = length;
  return std::max(least, all + first);
}

}  // namespace

Pen pen(std::size_t i) {
  const auto& [colour, dashes, thickness] = palette[i % palette.size()];
  const std::size_t round = i / palette.size();
  if (round == 0) return {colour, dashes, thickness};
  // No line of the first round has two dots behind a dash.
  std::string dotted = "12 3";
  for (std::size_t dot = 0; dot <= round; ++dot) dotted += " 2 3";
  return {colour, std::move(dotted), thickness};
}

std::string stroke(const Pen& p) {
  // Mitred corners reach beyond the points of a peak.
  return fmt::format(R"(fill="none" stroke-linejoin="round" stroke="{}" stroke-width="{}" stroke-dasharray="{}")",
                     p.colour, p.thickness, p.dashes);
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

std::string svg_begin(double width, double height, double left, const std::string& title) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"Helvetica, Arial, sans-serif\" font-size=\"13\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
      "<text x=\"{2}\" y=\"26\" font-size=\"17\">{3}</text>\n",
      width, height, left, escaped(title));
}

SvgLegend svg_legend(const std::vector<std::string>& names, double left, double width, double top) {
  SvgLegend legend;
  double x = left, y = top;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Pen p = pen(i);
    const double sample = sample_length(p), text = sample + 7;
    // An average character is 7 wide at this size.
    const double room = text + 7 * static_cast<double>(names[i].size());
    if (x + room > width && x > left) {
      x = left;
      y += 20;
    }
    fmt::format_to(std::back_inserter(legend.text), "<path d=\"M{} {} h{}\" {}/>\n<text x=\"{}\" y=\"{}\">{}</text>\n",
                   x, y, sample, stroke(p), x + text, y + 4.5, escaped(names[i]));
    x += room + 20;
  }
  legend.bottom = y;
  return legend;
}

}  // namespace withy
