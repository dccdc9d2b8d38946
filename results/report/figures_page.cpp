#include "withy/results/report/figures_page.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "withy/results/report/report_page.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_of_curve = 700;

/// Indices of the points that are drawn, in their order.
std::vector<std::size_t> drawn(const Curve& curve) {
  const std::size_t n = std::min(curve.x.size(), curve.y.size());
  std::vector<std::size_t> kept;
  if (curve.points || n <= 2 * most_of_curve) {
    for (std::size_t i = 0; i < n; ++i) kept.push_back(i);
    return kept;
  }
  for (std::size_t s = 0; s < most_of_curve; ++s) {
    const auto first = static_cast<std::ptrdiff_t>(s * n / most_of_curve);
    const auto last = static_cast<std::ptrdiff_t>((s + 1) * n / most_of_curve);
    const auto [low, high] = std::minmax_element(curve.y.begin() + first, curve.y.begin() + last);
    const auto a = static_cast<std::size_t>(low - curve.y.begin());
    const auto b = static_cast<std::size_t>(high - curve.y.begin());
    kept.push_back(std::min(a, b));
    if (a != b) kept.push_back(std::max(a, b));
  }
  return kept;
}

Json curve_json(const Curve& curve, std::size_t place, const std::vector<std::string>& legend) {
  const std::size_t pen = curve.pen.value_or(place);
  Json j{{"pen", pen}, {"x", Json::array()}, {"y", Json::array()}};
  if (pen < legend.size()) {
    j["name"] = legend[pen];
  } else if (!curve.name.empty()) {
    j["name"] = curve.name;
  }
  if (curve.points) j["points"] = true;
  if (curve.ends_early) j["ends_early"] = true;
  auto gap = curve.behind_gaps.begin();
  for (const std::size_t i : drawn(curve)) {
    if (gap != curve.behind_gaps.end() && *gap <= i) {
      j["x"].push_back(curve.x[i]);
      j["y"].push_back(nullptr);
      if (i < curve.notes.size()) j["notes"].push_back("");
      while (gap != curve.behind_gaps.end() && *gap <= i) ++gap;
    }
    j["x"].push_back(curve.x[i]);
    j["y"].push_back(curve.y[i]);
    if (i < curve.notes.size()) j["notes"].push_back(curve.notes[i]);
  }
  return j;
}

Json panel_json(const Panel& panel, const std::vector<std::string>& legend) {
  Json j{{"x", panel.x_label},     {"y", panel.y_label},   {"range", {panel.y_range.first, panel.y_range.second}},
         {"log_x", panel.log_x},   {"log_y", panel.log_y}, {"height", panel.height},
         {"curves", Json::array()}};
  for (std::size_t c = 0; c < panel.curves.size(); ++c) j["curves"].push_back(curve_json(panel.curves[c], c, legend));
  return j;
}

}  // namespace

Json figures_json(const std::string& words, const std::vector<Picture>& pictures) {
  Json j{{"words", words}, {"pictures", Json::array()}};
  for (const Picture& picture : pictures) {
    Json one{{"title", picture.title}, {"panels", Json::array()}};
    for (const Panel& panel : picture.panels) one["panels"].push_back(panel_json(panel, picture.legend));
    j["pictures"].push_back(std::move(one));
  }
  return j;
}

void write_figures_page(const std::filesystem::path& file, const std::string& title, const std::string& words,
                        const std::vector<Picture>& pictures) {
  if (has_report_page()) write_study_page(file, "figures", title, figures_json(words, pictures));
}

}  // namespace withy
