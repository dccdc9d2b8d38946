#include "withy/results/svg_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "withy/results/svg_parts.hpp"
#include "withy/results/utf8.hpp"
#include "withy/scene/units.hpp"

namespace withy {
namespace {

/// To read others between them.
constexpr std::size_t enough_marks = 3;

constexpr double plot_width = 860;
constexpr double least_left = 88;  ///< of the axes: label and marks of y stand there
constexpr double right = 24;
constexpr double foot = 52;     ///< below each panel: marks and label of its axis
constexpr double heading = 20;  ///< above a panel whose label of y is too long to stand beside it

/// From data to the picture, for one panel whose upper edge is at `top`. Ends are logarithms on an axis in decades.
struct Scale {
  double x0, x1, y0, y1, left, top, height;
  bool log_x, log_y;
  [[nodiscard]] double x(double v) const {
    return left + (place(v, log_x) - x0) / (x1 - x0) * (plot_width - left - right);
  }
  [[nodiscard]] double y(double v) const { return top + (y1 - place(v, log_y)) / (y1 - y0) * height; }
  [[nodiscard]] std::vector<double> x_marks() const { return marks(x0, x1, log_x); }
  [[nodiscard]] std::vector<double> y_marks() const { return marks(y0, y1, log_y); }
  static double place(double v, bool log) { return log ? std::log10(v) : v; }

 private:
  static std::vector<double> marks(double low, double high, bool log) {
    return log ? decade_marks(std::pow(10.0, low), std::pow(10.0, high)) : axis_marks(low, high);
  }
};

/// Whether numbers in this range are one but for rounding: no axis is to be read that closely.
bool is_rounding(double low, double high) {
  return !(high - low > rounding_in_pictures * std::max(std::abs(low), std::abs(high)));
}

Scale scale_of(const Panel& panel, double left, double top) {
  const auto y = [&](double v) { return Scale::place(v, panel.log_y); };
  Scale s{panel.x_range.first,
          panel.x_range.second,
          y(panel.y_range.first),
          y(panel.y_range.second),
          left,
          top,
          panel.height,
          panel.log_x,
          panel.log_y};
  // An axis of values begins where it is to, one in decades a little before the least.
  if (panel.log_x || panel.equal || panel.free_x) s.x0 = std::numeric_limits<double>::infinity(), s.x1 = -s.x0;
  for (const Curve& c : panel.curves) {
    for (const double v : c.x) {
      s.x0 = std::min(s.x0, Scale::place(v, panel.log_x));
      s.x1 = std::max(s.x1, Scale::place(v, panel.log_x));
    }
  }
  if (panel.log_x && s.x0 <= s.x1) {
    const double margin = std::max(0.02, 0.04 * (s.x1 - s.x0));
    s.x0 -= margin;
    s.x1 += margin;
  }
  if (!(s.x1 >= s.x0)) s.x0 = s.x1 = 0;
  if (is_rounding(s.x0, s.x1)) s.x1 += std::max(1.0, 0.1 * std::abs(s.x0));
  const double margin = !is_rounding(s.y0, s.y1) ? 0.06 * (s.y1 - s.y0) : std::max(1e-9, 0.06 * std::abs(s.y0));
  s.y0 -= margin;
  s.y1 += margin;
  if (panel.equal) {
    const double x_unit = (s.x1 - s.x0) * 1.08 / (plot_width - left - right), y_unit = (s.y1 - s.y0) / s.height;
    const auto stretch = [unit = std::max(x_unit, y_unit)](double& low, double& high, double pixels) {
      const double middle = (low + high) / 2;
      low = middle - unit * pixels / 2;
      high = middle + unit * pixels / 2;
    };
    stretch(s.x0, s.x1, plot_width - left - right);
    stretch(s.y0, s.y1, s.height);
  }
  return s;
}

/// Where the axes of all panels begin: behind the longest text at a mark of y.
double left_of(const std::vector<Panel>& panels) {
  constexpr double before = 34, character = 7.3;  // label and gaps; a digit is so wide at this size
  double left = least_left;
  for (const Panel& panel : panels)
    for (const std::string& text : mark_texts(scale_of(panel, least_left, 0).y_marks()))
      left = std::max(left, before + character * static_cast<double>(text.size()));
  return left;
}

/// How long a label is [px]: an average character is 7 wide at this size.
double length_of(const std::string& label) { return 7 * static_cast<double>(code_points(label).size()); }

/// Whether a panel's label of y would run into those of the panels beside it.
bool has_heading(const Panel& panel) { return length_of(panel.y_label) > panel.height + foot; }

/// Along the axis, or above the panel in letters that are as small as its width asks for.
void draw_y_label(std::string& out, const Panel& panel, const Scale& s) {
  constexpr double letters = 13;
  if (!has_heading(panel)) {
    fmt::format_to(std::back_inserter(out),
                   "<text transform=\"translate(20 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                   s.top + s.height / 2, escaped(panel.y_label));
    return;
  }
  const double size = letters * std::min(1.0, (plot_width - s.left - right) / length_of(panel.y_label));
  fmt::format_to(std::back_inserter(out), "<text x=\"{}\" y=\"{}\" font-size=\"{:.3g}\">{}</text>\n", s.left, s.top - 7,
                 size, escaped(panel.y_label));
}

/// Nothing is drawn in it: marks of y would tell of an axis that nobody has asked for.
bool is_empty(const Panel& panel) {
  return std::all_of(panel.curves.begin(), panel.curves.end(), [](const Curve& c) { return c.x.empty(); });
}

void draw_axes(std::string& out, const Panel& panel, const Scale& s) {
  const double left = s.left, bottom = s.top + s.height;
  const std::vector<double> x_marks = s.x_marks(), y_marks = is_empty(panel) ? std::vector<double>() : s.y_marks();
  const std::vector<std::string> x_texts = mark_texts(x_marks), y_texts = mark_texts(y_marks);
  for (std::size_t i = 0; i < y_marks.size(); ++i) {
    const double y = s.y(y_marks[i]);
    fmt::format_to(std::back_inserter(out),
                   "<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#ddd\"/>\n"
                   "<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
                   left, plot_width - right, y, y, left - 7, y + 4.5, y_texts[i]);
  }
  for (std::size_t i = 0; i < x_marks.size(); ++i) {
    const double x = s.x(x_marks[i]);
    fmt::format_to(std::back_inserter(out),
                   "<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{}\" y2=\"{}\" stroke=\"#ddd\"/>\n"
                   "<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                   x, x, s.top, bottom, x, bottom + 18, x_texts[i]);
  }
  fmt::format_to(std::back_inserter(out),
                 "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#444\"/>\n"
                 "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                 left, s.top, plot_width - left - right, s.height, (left + plot_width - right) / 2, bottom + 38,
                 escaped(panel.x_label));
  if (is_empty(panel))
    fmt::format_to(std::back_inserter(out), "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                   (left + plot_width - right) / 2, s.top + s.height / 2,
                   panel.log_y ? "zero throughout, but for rounding" : "no values");
  draw_y_label(out, panel, s);
}

void draw_curve(std::string& out, const Curve& curve, const Scale& s, const Pen& p) {
  if (curve.x.empty()) return;
  // Far outside the frame is as good as further outside, and keeps renderers away from huge coordinates.
  const auto y = [&](double v) { return std::clamp(s.y(v), s.top - 5000, s.top + 5000); };
  if (curve.points) {
    for (std::size_t i = 0; i < curve.x.size(); ++i)
      fmt::format_to(std::back_inserter(out), "<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"4.5\" fill=\"{}\"/>\n",
                     s.x(curve.x[i]), y(curve.y[i]), p.colour);
    return;
  }
  out += "<polyline " + stroke(p) + " points=\"";
  auto gap = curve.behind_gaps.begin();
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (gap != curve.behind_gaps.end() && i == *gap) {
      out += "\"/>\n<polyline " + stroke(p) + " points=\"";
      ++gap;
    }
    fmt::format_to(std::back_inserter(out), "{:.2f},{:.2f} ", s.x(curve.x[i]), y(curve.y[i]));
  }
  out += "\"/>\n";
  if (!curve.ends_early) return;
  const double cx = s.x(curve.x.back());
  const double cy = std::clamp(s.y(curve.y.back()), s.top + 7, s.top + s.height - 7);
  fmt::format_to(std::back_inserter(out),
                 "<path d=\"M{0:.2f} {1:.2f} l10 10 m0 -10 l-10 10\" stroke=\"{2}\" stroke-width=\"2.6\"/>\n", cx - 5,
                 cy - 5, p.colour);
}

}  // namespace

void append_in_decades(Curve& curve, double x, double y, double least) {
  if (!(y > least)) {
    if (!curve.x.empty() && (curve.behind_gaps.empty() || curve.behind_gaps.back() < curve.x.size()))
      curve.behind_gaps.push_back(curve.x.size());
    return;
  }
  curve.x.push_back(x);
  curve.y.push_back(y);
}

std::vector<double> axis_marks(double low, double high) {
  // Numbers of marks are counted in doubles: below that the next mark would be the same one.
  const double least = 32 * std::numeric_limits<double>::epsilon() * std::max(std::abs(low), std::abs(high));
  const double wanted = std::max((high - low) / 5, least);
  const double decade = std::pow(10.0, std::floor(std::log10(wanted)));
  std::vector<double> marks;
  for (const double part : {0.5, 1.0, 2.0, 5.0, 10.0}) {
    const double step = part * decade;
    std::vector<double> wider;
    for (double k = std::ceil(low / step); k * step <= high; ++k) wider.push_back(k == 0 ? 0 : k * step);
    if (wider.size() < enough_marks) break;
    marks = std::move(wider);
    if (step >= wanted * 0.99) break;
  }
  return marks;
}

std::vector<double> decade_marks(double low, double high) {
  const bool few = std::log10(high / low) < 3;
  std::vector<double> marks;
  for (double k = std::floor(std::log10(low)); k <= std::log10(high); ++k) {
    for (const double part : {1.0, 2.0, 5.0}) {
      if (part > 1 && !few) break;
      const double mark = part * std::pow(10.0, k);
      if (mark >= low && mark <= high) marks.push_back(mark);
    }
  }
  return marks.size() < enough_marks ? axis_marks(low, high) : marks;
}

std::vector<std::string> mark_texts(const std::vector<double>& marks, int digits) {
  constexpr int most_digits = std::numeric_limits<double>::max_digits10;
  constexpr double worth_seeing = 0.01;  // of the way to the nearest neighbour
  const auto told = [&](std::size_t i) {
    const double off = std::abs(to_digits(marks[i], digits) - marks[i]);
    return (i == 0 || off <= worth_seeing * std::abs(marks[i] - marks[i - 1])) &&
           (i + 1 == marks.size() || off <= worth_seeing * std::abs(marks[i + 1] - marks[i]));
  };
  std::vector<std::string> texts(marks.size());
  for (bool all = false; !all && digits <= most_digits; ++digits) {
    all = true;
    for (std::size_t i = 0; i < marks.size(); ++i) {
      texts[i] = fmt::format("{:.{}g}", marks[i], digits);
      all = all && told(i);
    }
  }
  return texts;
}

std::string svg_plot(const std::string& title, const std::vector<std::string>& legend,
                     const std::vector<Panel>& panels) {
  const double left = left_of(panels);
  const SvgLegend entries = svg_legend(legend, left, plot_width, 47);
  double top = entries.bottom + 25;
  double height = top + 8;
  for (const Panel& panel : panels) height += panel.height + foot + (has_heading(panel) ? heading : 0);
  std::string out = svg_begin(plot_width, height, left, title);
  out += entries.text;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    if (has_heading(panels[i])) top += heading;
    const Scale s = scale_of(panels[i], left, top);
    draw_axes(out, panels[i], s);
    fmt::format_to(std::back_inserter(out),
                   "<clipPath id=\"frame{}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n"
                   "<g clip-path=\"url(#frame{})\">\n",
                   i, left, top, plot_width - left - right, panels[i].height, i);
    for (std::size_t c = 0; c < panels[i].curves.size(); ++c)
      draw_curve(out, panels[i].curves[c], s, pen(panels[i].curves[c].pen.value_or(c)));
    out += "</g>\n";
    top += panels[i].height + foot;
  }
  return out + "</svg>\n";
}

}  // namespace withy
