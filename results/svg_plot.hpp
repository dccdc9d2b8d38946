/// \file
/// Line charts as SVG text, readable in any browser.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace withy {

/// One curve. Its place in Panel::curves, or `pen`, chooses its colour and dashes, the same in every panel and in the
/// legend.
struct Curve {
  std::vector<double> x;
  std::vector<double> y;
  bool ends_early = false;  ///< its last point is marked with a cross
  bool points = false;      ///< dots in place of a line
  std::optional<std::size_t> pen = {};
  std::string name = {};                      ///< on pages, where the legend has none for its pen
  std::vector<std::string> notes = {};        ///< what pages say of each point
  std::vector<std::size_t> behind_gaps = {};  ///< points that no line joins with those before them, rising
};

/// One pair of axes.
struct Panel {
  std::string x_label;
  std::string y_label;
  std::pair<double, double> y_range;  ///< least and greatest value shown; curves are cut there
  std::vector<Curve> curves;
  double height = 200;
  bool log_x = false, log_y = false;  ///< in decades; values, and the range, above 0
  bool free_x = false;                ///< the axis of x begins at the least x, whatever x_range says
  bool equal = false;                 ///< one unit is as long along both axes, and x may begin below 0
  /// What an axis of x that is neither free nor in decades shows at least; of time from the start of the run to its
  /// end, so that panels below each other have one axis, wherever their curves begin.
  std::pair<double, double> x_range = {0, 0};
};

/// A title, a legend with one entry a curve, and the panels below each other.
std::string svg_plot(const std::string& title, const std::vector<std::string>& legend,
                     const std::vector<Panel>& panels);

/// Panels under one title.
struct Picture {
  std::string title;
  std::vector<std::string> legend;  ///< names of pens, from the first
  std::vector<Panel> panels;
};
inline std::string svg_plot(const Picture& p) { return svg_plot(p.title, p.legend, p.panels); }

/// Adds a point to a curve over an axis in decades. What is no more than `least` is zero but for rounding: it has no
/// place there, and a line from it to the next point would tell of courses that nobody knows, so that it leaves a gap.
void append_in_decades(Curve& curve, double x, double y, double least);
/// Of two numbers that are one but for rounding, the difference over the greater at most.
inline constexpr double rounding_in_pictures = 1e-13;

/// Round numbers inside [low, high], five or so, for the marks of an axis.
std::vector<double> axis_marks(double low, double high);

/// The same for an axis in decades: powers of ten in [low, high], and twice and five times them where these are few;
/// where even those are less than three, as axis_marks() has them.
std::vector<double> decade_marks(double low, double high);

/// What stands at the marks of an axis, in their order: numbers of so many digits, or of more where these would not
/// tell neighbours apart, as at 7000000.25 and 7000000.5.
std::vector<std::string> mark_texts(const std::vector<double>& marks, int digits = 6);

}  // namespace withy
