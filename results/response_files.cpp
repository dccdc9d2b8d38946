#include "withy/results/response_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "withy/results/json_text.hpp"
#include "withy/results/linear_files.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/report/figures_page.hpp"
#include "withy/results/report/report_page.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;
using Complex = std::complex<double>;

double in_hertz(double omega) { return omega / (2 * std::numbers::pi); }

/// Null where it is not finite.
Json finite_json(double x) { return std::isfinite(x) ? Json(x) : Json(); }

/// A pole or zero; of a sampled system with the multiplier that it is.
Json root_json(const LinearSystem& system, Complex root) {
  const Complex s = exponent_of(system, root);
  Json j;
  if (system.sampled()) j["multiplier"] = {root.real(), root.imag()};
  j["value"] = {finite_json(s.real()), finite_json(s.imag())};
  j["hertz"] = finite_json(in_hertz(std::abs(s)));
  j["damping_ratio"] = s == 0.0 ? Json() : finite_json(-s.real() / std::abs(s));
  return j;
}

Json roots_json(const LinearSystem& system, const Eigen::VectorXcd& roots) {
  Json list = Json::array();
  for (const Complex root : roots) list.push_back(root_json(system, root));
  return list;
}

Json phase_json(const PhaseMargin& p) {
  return {{"hertz", in_hertz(p.omega)}, {"degrees", p.angle * 180 / std::numbers::pi}, {"delay", p.delay}};
}

Json margins_json(const Margins& m) {
  Json j{{"stable", m.stable}, {"growth", finite_json(m.growth)}, {"gains", Json::array()}, {"phases", Json::array()}};
  for (const GainMargin& g : m.gains)
    j["gains"].push_back(
        {{"hertz", finite_json(in_hertz(g.omega))}, {"factor", g.factor}, {"decibels", 20 * std::log10(g.factor)}});
  for (const PhaseMargin& p : m.phases) j["phases"].push_back(phase_json(p));
  j["lag"] = m.lag() != nullptr ? phase_json(*m.lag()) : Json();
  j["lead"] = m.lead() != nullptr ? phase_json(*m.lead()) : Json();
  j["delay"] = m.delay() != nullptr ? phase_json(*m.delay()) : Json();
  j["samples"] = m.samples() ? Json(*m.samples()) : Json();
  j["hidden_growth"] = m.hidden_growth;
  return j;
}

Json reduction_json(const study::Response& r) {
  const Reduction& reduction = *r.reduction;
  return {{"states", reduction.system.A.rows()},
          {"of", r.model.system.A.rows()},
          {"kept", reduction.kept},
          {"hankel", std::vector<double>(reduction.hankel.begin(), reduction.hankel.end())},
          {"bound", reduction.bound},
          {"error", r.reduction_error},
          {"A", rows_json(reduction.system.A)},
          {"B", rows_json(reduction.system.B)},
          {"C", rows_json(reduction.system.C)},
          {"D", rows_json(reduction.system.D)}};
}

}  // namespace

std::vector<double> unwrapped_degrees(const std::vector<ResponseAt>& values) {
  std::vector<double> degrees;
  for (const ResponseAt& at : values) {
    double angle = std::arg(at.value) * 180 / std::numbers::pi;
    if (!degrees.empty()) angle += 360 * std::round((degrees.back() - angle) / 360);
    degrees.push_back(angle);
  }
  return degrees;
}

Json response_json(const study::Configuration& c, const study::Response& r) {
  const LinearSystem& s = r.model.system;
  Json poles = roots_json(s, r.roots.poles);
  for (std::size_t i = 0; i < r.participation.size() && !s.sampled(); ++i)
    poles[i]["participation"] = r.participation[i];
  Json peaks = Json::array();
  for (const Peak& p : r.peaks)
    peaks.push_back({{"hertz", in_hertz(p.omega)}, {"height", p.height ? Json(*p.height) : Json()}});
  Json values = Json::array();
  for (const ResponseAt& at : r.values) values.push_back({in_hertz(at.omega), at.value.real(), at.value.imag()});
  Json j;
  j["scene"] = c.prepared().scene.file;
  j["formulation"] = c.prepared().scene.formulation_name;
  j["input"] = r.model.inputs[0].name;
  j["input_unit"] = r.model.inputs[0].unit;
  j["output"] = r.model.outputs[0].name;
  j["output_unit"] = r.model.outputs[0].unit;
  if (!c.closing().empty()) j["closing"] = c.closing();
  j["opened"] = r.opened;
  j["follows"] = r.follows;
  j["period"] = s.period;
  j["equilibrium"] = r.model.equilibrium;
  j["frozen"] = r.model.frozen;
  j["shaking"] = r.model.shaking;
  j["turning"] = turning_json(r.model);
  j["changing"] = r.model.changing;
  j["limited"] = r.model.limited;
  j["held"] = c.held_names();
  j["derivatives"] = r.model.derivatives;
  j["output_derivatives"] = r.model.output_derivatives;
  j["integrators"] = r.integrators;
  j["static_gain"] = finite_json(r.static_gain);
  j["poles"] = std::move(poles);
  j["zeros"] = roots_json(s, r.roots.zeros);
  j["hidden"] = roots_json(s, r.roots.hidden);
  j["peaks"] = std::move(peaks);
  j["margins"] = r.margins ? margins_json(*r.margins) : Json();
  j["reduction"] = r.reduction ? reduction_json(r) : Json();
  j["values"] = std::move(values);
  return j;
}

std::string response_csv(const study::Response& r) {
  const std::vector<double> degrees = unwrapped_degrees(r.values);
  std::string text = "frequency[Hz],gain[1],phase[deg],real[1],imaginary[1]\n";
  for (std::size_t i = 0; i < r.values.size(); ++i) {
    const Complex value = r.values[i].value;
    text += fmt::format("{},{},{},{},{}\n", in_hertz(r.values[i].omega), std::abs(value), degrees[i], value.real(),
                        value.imag());
  }
  return text;
}

std::vector<std::string> response_content() {
  return {"response.json", "response.csv", "bode.svg", "nichols.svg", report_name};
}

void write_response(const std::filesystem::path& folder, const study::Configuration& c, const study::Response& r) {
  const std::string title =
      c.prepared().title() + ": " +
      (r.opened ? r.model.inputs[0].name + " opened" : r.model.inputs[0].name + " to " + r.model.outputs[0].name);
  const Picture bode = bode_picture(r, title), nichols = nichols_picture(r, title);
  write_file(folder / "response.json", json_text(response_json(c, r)));
  write_file(folder / "response.csv", response_csv(r));
  write_file(folder / "bode.svg", svg_plot(bode));
  write_file(folder / "nichols.svg", svg_plot(nichols));
  write_figures_page(folder / report_name, title, response_text(c, r),
                     {{"Bode", bode.legend, bode.panels}, {"Nichols", nichols.legend, nichols.panels}});
}

}  // namespace withy
