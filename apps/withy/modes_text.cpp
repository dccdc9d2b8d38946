#include "withy/apps/withy/modes_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "withy/apps/withy/text_table.hpp"

namespace withy::app {
namespace {

double hertz(const Mode& m) { return m.frequency() / (2 * std::numbers::pi); }

std::string component(const std::complex<double>& x) {
  if (std::abs(x) < 5e-5) return "·";
  if (std::abs(x.imag()) < 5e-5) return fmt::format("{:.4f}", x.real());
  return fmt::format("{:.4f}∠{:.0f}°", std::abs(x), std::arg(x) * 180 / std::numbers::pi);
}

}  // namespace

std::string modes_text(const study::ModesOf& run, std::size_t count) {
  const study::ModesAt& at = run.points.front();
  count = std::min(count, at.modes.size());
  TextTable table({"mode", "frequency\n[rad/s]", "\n[Hz]", "damping\nratio", "growth\n[1/s]", "<", "<dominated by"});
  for (std::size_t i = 0; i < count; ++i) {
    const Mode& m = at.modes[i];
    table.add({std::to_string(i + 1), fmt::format("{:.6g}", m.frequency()), fmt::format("{:.6g}", hertz(m)),
               m.rigid ? "-" : fmt::format("{:.3g}", -study::resolved_growth(at, m) / m.frequency() + 0.0),
               fmt::format("{:.3g}", study::resolved_growth(at, m)), study::behaviour(at, m),
               study::dominating(at, m)});
  }
  std::string text = table.str();
  if (count < at.modes.size()) text += fmt::format("{} more: --count {}\n", at.modes.size() - count, at.modes.size());
  std::vector<std::string> head = {"<shape"};
  for (std::size_t i = 0; i < count; ++i) head.push_back(std::to_string(i + 1));
  TextTable shapes(head);
  for (std::size_t s = 0; s < at.names.size(); ++s) {
    std::vector<std::string> cells = {at.names[s]};
    bool moves = false;
    for (std::size_t i = 0; i < count; ++i) {
      const std::complex<double> x = at.modes[i].shape[static_cast<Eigen::Index>(s)];
      moves = moves || x != 0.0;
      cells.push_back(component(x));
    }
    if (moves) shapes.add(std::move(cells));
  }
  return text + '\n' + shapes.str();
}

std::string sweep_text(const study::ModesOf& run, const std::string& label, std::size_t count) {
  std::size_t most = 0;
  const study::ModesAt* named = nullptr;
  for (const study::ModesAt& at : run.points) {
    if (named == nullptr && !at.modes.empty()) named = &at;
    most = std::max(most, at.modes.size());
  }
  count = std::min(count, most);
  std::vector<std::string> head = {label};
  for (std::size_t i = 0; i < count; ++i)
    head.push_back((i < named->modes.size() ? study::dominating(*named, named->modes[i]) : std::string("-")) +
                   "\n[rad/s]");
  TextTable table(head);
  bool any_unstable = false;
  std::string problems;
  for (const study::ModesAt& at : run.points) {
    std::vector<std::string> cells = {fmt::format("{:.6g}", at.value)};
    for (std::size_t i = 0; i < count; ++i) {
      if (i >= at.modes.size()) {
        cells.emplace_back("-");
        continue;
      }
      const Mode& m = at.modes[i];
      const bool grows = study::unstable(at, m);
      any_unstable = any_unstable || grows;
      cells.push_back(grows ? fmt::format("+{:.6g}/s", m.growth()) : fmt::format("{:.6g}", m.frequency()));
    }
    table.add(std::move(cells));
    if (!at.problem.empty()) problems += fmt::format("{} = {:.6g}: {}\n", label, at.value, at.problem);
  }
  std::string text = table.str();
  if (any_unstable) text += "+x/s: unstable, grows as exp(x t)\n";
  return text + problems;
}

}  // namespace withy::app
