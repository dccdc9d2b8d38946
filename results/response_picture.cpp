#include <algorithm>
#include <cmath>
#include <numbers>

#include "withy/results/response_files.hpp"

namespace withy {
namespace {

using Complex = std::complex<double>;

double decibels(Complex value) { return 20 * std::log10(std::max(std::abs(value), 1e-300)); }

/// Widens a range to hold a value.
void reach(std::pair<double, double>& range, double value) {
  range.first = std::min(range.first, value);
  range.second = std::max(range.second, value);
}

struct GainAndPhase {
  Curve gain, phase;
};

GainAndPhase curves_of(const std::vector<ResponseAt>& values, std::size_t pen) {
  GainAndPhase curves;
  curves.gain.pen = curves.phase.pen = pen;
  const std::vector<double> degrees = unwrapped_degrees(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    curves.gain.x.push_back(values[i].omega / (2 * std::numbers::pi));
    curves.gain.y.push_back(decibels(values[i].value));
    curves.phase.y.push_back(degrees[i]);
  }
  curves.phase.x = curves.gain.x;
  return curves;
}

/// G of G/(1 + G) = M e^{iφ} as φ goes round: a curve of equal closed loop, phases within (−360°, 0°).
Curve equal_closed_loop(double closed_decibels, std::size_t pen) {
  Curve curve;
  curve.pen = pen;
  const double M = std::pow(10.0, closed_decibels / 20);
  for (int k = 0; k <= 720; ++k) {
    const Complex closed = std::polar(M, -2 * std::numbers::pi * (k + 0.5) / 721);
    const Complex open = closed / (1.0 - closed);
    double angle = std::arg(open) * 180 / std::numbers::pi;
    if (angle > 0) angle -= 360;
    if (!curve.x.empty() && std::abs(angle - curve.x.back()) > 180) continue;
    curve.x.push_back(angle);
    curve.y.push_back(decibels(open));
  }
  if (M > 1) curve.x.push_back(curve.x.front()), curve.y.push_back(curve.y.front());
  return curve;
}

constexpr std::size_t curve_pen = 6, closed_pen = 7, point_pen = 1;

}  // namespace

Picture bode_picture(const study::Response& r, const std::string& title) {
  Panel gain{"frequency [Hz]", "gain [dB]", {1e300, -1e300}, {}, 260};
  Panel phase{"frequency [Hz]", "phase [deg]", {1e300, -1e300}, {}, 200};
  gain.log_x = phase.log_x = true;
  const auto add = [&](const std::vector<ResponseAt>& values, std::size_t pen) {
    GainAndPhase curves = curves_of(values, pen);
    for (const double y : curves.gain.y) reach(gain.y_range, y);
    for (const double y : curves.phase.y) reach(phase.y_range, y);
    gain.curves.push_back(std::move(curves.gain));
    phase.curves.push_back(std::move(curves.phase));
  };
  std::vector<std::string> legend;
  add(r.values, 0);
  if (r.reduction) {
    const TransferFunction smaller(r.reduction->system);
    std::vector<ResponseAt> values = r.values;
    for (ResponseAt& at : values) at.value = smaller.at_frequency(at.omega);
    add(values, 1);
    legend = {"all states", std::to_string(r.reduction->system.A.rows()) + " states"};
  }
  // What is far below the greatest gain is rounding, and hides the rest.
  gain.y_range.first = std::max(gain.y_range.first, gain.y_range.second - 200);
  return {title, legend, {gain, phase}};
}

Picture nichols_picture(const study::Response& r, const std::string& title) {
  Panel panel{"phase [deg]", "gain [dB]", {-40, 40}, {}, 480};
  panel.free_x = true;
  for (const double closed : {-12.0, -6.0, -3.0, 3.0, 6.0})
    panel.curves.push_back(equal_closed_loop(closed, closed_pen));
  for (Curve& curve : panel.curves) curve.name = "closed loops of equal gain: -12, -6, -3, 3, 6 dB";
  GainAndPhase curves = curves_of(r.values, curve_pen);
  // The turn of the phase that lies nearest to the critical point.
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < curves.gain.y.size(); ++i)
    if (std::abs(curves.gain.y[i]) < std::abs(curves.gain.y[nearest])) nearest = i;
  const double turn = curves.phase.y.empty() ? 0 : 360 * std::round((-180 - curves.phase.y[nearest]) / 360);
  Curve loop;
  loop.pen = curve_pen;
  loop.name = "the loop";
  for (std::size_t i = 0; i < curves.gain.y.size(); ++i) {
    loop.x.push_back(curves.phase.y[i] + turn);
    loop.y.push_back(curves.gain.y[i]);
  }
  panel.curves.push_back(std::move(loop));
  Curve critical;
  critical.x = {-180}, critical.y = {0};
  critical.points = true;
  critical.name = "the point it must not pass";
  critical.pen = point_pen;
  panel.curves.push_back(std::move(critical));
  return {title, {}, {panel}};
}

}  // namespace withy
