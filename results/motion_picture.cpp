#include "withy/results/motion_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "withy/core/simulation/diagnosis.hpp"
#include "withy/results/report/drawing.hpp"
#include "withy/results/svg_parts.hpp"

namespace withy {
namespace {

constexpr double stage_width = 860, stage_height = 420, stage_margin = 30;
constexpr std::size_t most_frames = 150;
/// The part of the picture's time after the motion has ended, at rest.
constexpr double rest_share = 0.08;

using TreeLines = std::vector<std::vector<Vector3>>;

/// One run at the times of the frames.
struct Filmed {
  std::vector<TreeLines> frames;  ///< fewer than times where the run stopped early
  bool stopped = false;
};

/// Times of the frames [s], even ones from the first output to the last of the longest run.
std::vector<double> frame_times(const study::Comparison& comparison) {
  const std::vector<State>* longest = &comparison.runs.front().outputs;
  for (std::size_t k = 0; k < comparison.listed; ++k) {
    const auto& outputs = comparison.runs[k].outputs;
    if (outputs.back().time > longest->back().time) longest = &outputs;
  }
  const std::size_t count = std::min(most_frames, longest->size());
  std::vector<double> times;
  for (std::size_t i = 0; i < count; ++i)
    times.push_back((*longest)[count > 1 ? i * (longest->size() - 1) / (count - 1) : 0].time);
  return times;
}

Filmed film(const study::ComparedRun& run, const std::vector<double>& times) {
  const Scene& scene = run.prepared.scene;
  Drawing drawing(scene.model, scene.formulation->terms());
  Filmed filmed;
  filmed.stopped = run.summary.status != RunStatus::completed;
  auto at = run.outputs.begin();
  for (const double t : times) {
    at = std::find_if(at, run.outputs.end(), [t](const State& s) { return s.time >= t; });
    if (at == run.outputs.end()) {
      filmed.frames.push_back(drawing.lines(run.outputs.back().y));
      break;
    }
    filmed.frames.push_back(drawing.lines(at->y));
  }
  return filmed;
}

/// From the world to the picture.
struct Camera {
  std::pair<Eigen::Index, Eigen::Index> plane;
  Vector3 low, high;
  double top = 0;
  [[nodiscard]] std::string at(const Vector3& p) const {
    const auto [i, j] = plane;
    const double across = std::max(high[i] - low[i], 1e-9), up = std::max(high[j] - low[j], 1e-9);
    const double unit = std::min((stage_width - 2 * stage_margin) / across, (stage_height - 2 * stage_margin) / up);
    const double x = stage_width / 2 + unit * (p[i] - (low[i] + high[i]) / 2);
    const double y = top + stage_height / 2 - unit * (p[j] - (low[j] + high[j]) / 2);
    return fmt::format("{:.1f},{:.1f}", x, y);
  }
};

/// It fits the runs that were completed, or all where none was.
Camera camera_for(const std::vector<Filmed>& films) {
  const bool any = std::any_of(films.begin(), films.end(), [](const Filmed& f) { return !f.stopped; });
  Camera camera{{0, 1}, Vector3::Constant(std::numeric_limits<double>::infinity()), {}};
  camera.high = -camera.low;
  for (const Filmed& f : films) {
    if (any && f.stopped) continue;
    for (const TreeLines& lines : f.frames) {
      for (const auto& line : lines) {
        for (const Vector3& p : line) {
          camera.low = camera.low.cwiseMin(p);
          camera.high = camera.high.cwiseMax(p);
        }
      }
    }
  }
  camera.plane = widest_plane(camera.low, camera.high);
  return camera;
}

std::string svg_points(const std::vector<Vector3>& line, const Camera& camera) {
  std::string text;
  for (const Vector3& p : line) text += (text.empty() ? "" : " ") + camera.at(p);
  return text;
}

/// Values of an attribute over the picture's time; the last one stays while the picture rests.
std::string svg_animation(const char* attribute, const std::vector<std::string>& values, double seconds) {
  if (values.size() < 2) return {};
  std::string list, times;
  for (std::size_t i = 0; i < values.size(); ++i) {
    list += values[i] + ';';
    times += fmt::format("{:.5g};", (1 - rest_share) * static_cast<double>(i) / static_cast<double>(values.size() - 1));
  }
  return fmt::format(
      "<animate attributeName=\"{}\" dur=\"{:.4g}s\" repeatCount=\"indefinite\" values=\"{}{}\" keyTimes=\"{}1\"/>",
      attribute, seconds, list, values.back(), times);
}

void draw_run(std::string& out, const Filmed& f, std::size_t count, std::size_t index, const Camera& camera,
              double seconds) {
  const std::size_t last = f.frames.size() - 1;
  std::vector<Vector3> way;
  for (const TreeLines& lines : f.frames)
    if (!lines.empty() && !lines.back().empty()) way.push_back(lines.back().back());
  fmt::format_to(std::back_inserter(out),
                 "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-opacity=\"0.35\"/>\n",
                 svg_points(way, camera), pen(index).colour);
  for (std::size_t line = 0; line < f.frames.front().size(); ++line) {
    std::vector<std::string> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(svg_points(f.frames[std::min(i, last)][line], camera));
    fmt::format_to(std::back_inserter(out), "<polyline {} stroke-linecap=\"round\" points=\"{}\">{}</polyline>\n",
                   stroke(pen(index)), values.back(), svg_animation("points", values, seconds));
  }
  if (!f.stopped || way.empty()) return;
  std::vector<std::string> shown(count, "0");
  std::fill(shown.begin() + static_cast<std::ptrdiff_t>(std::min(last, count - 1)), shown.end(), "1");
  fmt::format_to(std::back_inserter(out),
                 "<g transform=\"translate({})\" stroke=\"{}\" stroke-width=\"2.5\"><path d=\"M-6 -6 L6 6 M-6 6 L6 "
                 "-6\"/>{}</g>\n",
                 camera.at(way.back()), pen(index).colour, svg_animation("opacity", shown, seconds));
}

}  // namespace

std::string motion_picture(const std::string& title, const study::Comparison& comparison) {
  const std::vector<double> times = frame_times(comparison);
  const double lasted = times.back() - times.front();
  const double seconds = std::clamp(lasted / (1 - rest_share), 8.0, 20.0);
  std::vector<Filmed> films;
  std::vector<std::string> names;
  for (std::size_t k = 0; k < comparison.listed; ++k) {
    const study::ComparedRun& run = comparison.runs[k];
    films.push_back(film(run, times));
    const bool stopped = run.summary.status != RunStatus::completed;
    names.push_back(run.formulation() + (stopped ? " (" + study::outcome_text(run.summary) + ")" : ""));
  }
  const SvgLegend legend = svg_legend(names, stage_margin, stage_width, 47);
  Camera camera = camera_for(films);
  camera.top = legend.bottom + 10;
  const double bar = camera.top + stage_height;
  std::string out = svg_begin(stage_width, bar + 40, stage_margin, title) + legend.text;
  fmt::format_to(std::back_inserter(out),
                 "<clipPath id=\"stage\"><rect x=\"0\" y=\"{0:.1f}\" width=\"{1}\" height=\"{2}\"/></clipPath>\n"
                 "<g clip-path=\"url(#stage)\">\n",
                 camera.top, stage_width, stage_height);
  for (std::size_t k = 0; k < films.size(); ++k) draw_run(out, films[k], times.size(), k, camera, seconds);
  const double full = stage_width - 2 * stage_margin;
  fmt::format_to(std::back_inserter(out),
                 "</g>\n<rect x=\"{0}\" y=\"{1:.1f}\" width=\"{2}\" height=\"4\" fill=\"#ddd\"/>\n"
                 "<rect x=\"{0}\" y=\"{1:.1f}\" width=\"{2}\" height=\"4\" fill=\"#555\">{3}</rect>\n"
                 "<text x=\"{0}\" y=\"{4:.1f}\">{5} s of motion, at {6} of its speed</text>\n</svg>\n",
                 stage_margin, bar + 8, full, svg_animation("width", {"0", fmt::format("{}", full)}, seconds), bar + 30,
                 brief(lasted), fmt::format("{:.2g}", lasted / (seconds * (1 - rest_share))));
  return out;
}

}  // namespace withy
