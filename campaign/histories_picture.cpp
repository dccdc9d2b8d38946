#include "withy/campaign/histories_picture.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace withy::campaign {
namespace {

constexpr std::size_t most_panels = 12;
/// Of the shares: one for each pair around the median.
constexpr std::array<std::size_t, 7> pens = {3, 2, 1, 0, 1, 2, 3};

/// Of curves in the order of the shares.
Panel about_median(const Panel& panel) {
  Panel about = panel;
  about.y_label += " − median";
  about.y_range = {0, 0};
  for (std::size_t k = 0; k < pens.size(); ++k)
    for (std::size_t i = 0; i < about.curves[k].y.size(); ++i) {
      double& y = about.curves[k].y[i];
      y -= panel.curves[pens.size() / 2].y[i];
      about.y_range = {std::min(about.y_range.first, y), std::max(about.y_range.second, y)};
    }
  return about;
}

bool narrow(const Panel& panel) {
  const std::vector<double>& median = panel.curves[pens.size() / 2].y;
  const auto [low, high] = std::minmax_element(median.begin(), median.end());
  double widest = 0;
  for (std::size_t i = 0; i < median.size(); ++i)
    widest = std::max(widest, panel.curves.back().y[i] - panel.curves.front().y[i]);
  return widest > 0 && widest < 0.1 * (*high - *low);
}

}  // namespace

std::string title_of_point(const std::vector<std::string>& paths, const CaseValues& values) {
  std::string title;
  for (std::size_t a = 0; a < paths.size(); ++a) {
    if (!values[a]) continue;
    const Value& value = *values[a];
    title += fmt::format("{}{} = ", title.empty() ? "" : ", ", paths[a]);
    title += value.kind() == Value::Kind::number ? fmt::format("{:.6g}", value.number())
             : value.kind() == Value::Kind::null ? "null"
                                                 : value.text();
  }
  return title;
}

HistoriesPicture::HistoriesPicture(std::string title)
    : picture_{std::move(title), {"median", "25 and 75 %", "5 and 95 %", "least and greatest"}, {}} {}

void HistoriesPicture::add(std::uint64_t point, const std::string& at, const std::string& name, double t,
                           std::span<const double> numbers) {
  if (const std::string place = fmt::format("{} {}", point, name); place != last_) {
    last_ = place;
    ++asked_;
    full_ = picture_.panels.size() == most_panels;
    if (full_) return;
    Panel panel{"t [s]", name + (at.empty() ? "" : " at " + at), {numbers[0], numbers[0]}, {}};
    panel.x_range = {t, t};
    for (const std::size_t pen : pens) panel.curves.emplace_back().pen = pen;
    picture_.panels.push_back(std::move(panel));
  }
  if (full_) return;
  Panel& panel = picture_.panels.back();
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    panel.curves[k].x.push_back(t);
    panel.curves[k].y.push_back(numbers[k]);
  }
  panel.y_range = {std::min(panel.y_range.first, numbers.front()), std::max(panel.y_range.second, numbers.back())};
}

std::string HistoriesPicture::svg() const {
  Picture whole{picture_.title, picture_.legend, {}};
  if (asked_ > picture_.panels.size())
    whole.title += fmt::format(": the first {} of {}, histories.csv has all", picture_.panels.size(), asked_);
  for (const Panel& panel : picture_.panels) {
    whole.panels.push_back(panel);
    if (narrow(panel)) whole.panels.push_back(about_median(panel));
  }
  return svg_plot(whole);
}

}  // namespace withy::campaign
