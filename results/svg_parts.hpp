/// \file
/// What all SVG pictures have in common: pens, a title, a legend.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace withy {

/// How a curve is drawn. Pens are told apart by dashes too, for those who do not see colours.
struct Pen {
  const char* colour;
  std::string dashes;  ///< lengths drawn and left out, in turn; "none": solid
  double thickness;
};
/// The pen of a curve, or a run, counted from 0. No two are alike; from the thirteenth on colours come again, with a
/// dash and as many dots as tell them apart.
Pen pen(std::size_t i);
/// Attributes of a line drawn with it.
std::string stroke(const Pen& p);

/// Text with `&`, `<` and `>` as SVG has them.
std::string escaped(const std::string& text);

/// Opens a picture: its size, a white ground, a title at x = `left`. To be closed by "</svg>\n".
std::string svg_begin(double width, double height, double left, const std::string& title);

/// A legend in rows.
struct SvgLegend {
  std::string text;
  double bottom = 0;  ///< y of the last row's middle
};
/// One entry a pen, from (left, top) on to `width`.
SvgLegend svg_legend(const std::vector<std::string>& names, double left, double width, double top);

}  // namespace withy
