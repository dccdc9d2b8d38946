#include "withy/results/report/run_report.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>
#include <unordered_map>

#include "withy/results/certificate_text.hpp"
#include "withy/results/csv.hpp"
#include "withy/results/report/arrows.hpp"
#include "withy/results/report/base64.hpp"
#include "withy/results/report/drawing.hpp"
#include "withy/results/result_columns.hpp"
#include "withy/results/table_picture.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

/// Stretches of a report's table, about as many as a plot is wide, their numbers in all columns together, and moments
/// of its animation: 2 MB of data are soon opened.
constexpr std::size_t most_stretches = 2000, most_numbers = 80'000, most_moments = 400;

/// Arrays of numbers, which stand as text at the end of what refers to them by their index.
class Arrays {
 public:
  template <class Number>
  std::size_t add(const std::vector<Number>& numbers) {
    text_ += (count_ == 0 ? "\"" : ",\"") + base64_of(numbers) + '"';
    return count_++;
  }
  /// An object's text with the run and the arrays as its last members.
  [[nodiscard]] std::string behind(std::string object, const std::string& run) const {
    object.pop_back();
    object.reserve(object.size() + run.size() + text_.size() + 30);
    object += ",\"run\":" + run;
    object += ",\"arrays\":[";
    object += text_;
    object += "]}";
    return object;
  }

 private:
  std::size_t count_ = 0;
  std::string text_;
};

/// Where rows are drawn together each column also has its numbers at the moments of the animation: what is computed of
/// several columns needs numbers of one time.
Json table_json(const DecimatedTable& table, const std::vector<std::vector<double>>& samples, Arrays& data) {
  Json columns = Json::array();
  for (std::size_t c = 0; c < table.columns().size(); ++c) {
    const Column& column = table.columns()[c];
    Json j{{"name", column_name(column.name)}, {"unit", column.unit}, {"data", data.add(table.column(c))}};
    if (table.stride() > 1) {
      std::vector<double> own;
      for (const std::vector<double>& row : samples) own.push_back(row[c]);
      j["samples"] = data.add(own);
    }
    columns.push_back(std::move(j));
  }
  return {{"rows", table.rows()}, {"stride", table.stride()}, {"columns", std::move(columns)}};
}

/// What was measured of one kind, moment by moment; each series has the limit of the indicator of its name.
void add_validity(const std::vector<std::string>& bodies, const std::vector<double>& values, const char* before,
                  const char* after, const study::Certificate& certificate, Json& series, Arrays& data) {
  std::unordered_map<std::string_view, const study::Indicator*> indicators;
  for (const study::Indicator& i : certificate.indicators) indicators.try_emplace(i.text, &i);
  std::unordered_map<std::string_view, double> fundamentals;
  for (const BodyValidity& b : certificate.bodies) fundamentals[b.name] = b.fundamental;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const std::string name = before + bodies[k] + after;
    const auto found = indicators.find(name);
    if (found == indicators.end()) continue;
    const study::Indicator* indicator = found->second;
    const auto fundamental = fundamentals.find(bodies[k]);
    const bool of_rate = indicator->text.starts_with("rate") && fundamental != fundamentals.end();
    const double scale = of_rate ? 1 / fundamental->second : 1;
    std::vector<double> own;
    for (std::size_t i = k; i < values.size(); i += bodies.size()) own.push_back(scale * values[i]);
    series.push_back({{"name", name}, {"limit", indicator->limit}, {"data", data.add(own)}});
  }
}

std::string dumped_page(const Json& json) { return json.dump(-1, ' ', true, Json::error_handler_t::replace); }

/// Places and vectors moment by moment, six numbers each.
Json arrows_json(const Arrows& arrows, Arrays& data) {
  Json list = Json::array();
  for (const Arrows::Arrow& a : arrows.all())
    list.push_back({{"name", a.name}, {"unit", a.unit}, {"greatest", a.greatest}, {"numbers", data.add(a.numbers)}});
  return list;
}

std::vector<std::uint32_t> flat(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<std::uint32_t> corners;
  for (const auto& t : triangles) corners.insert(corners.end(), t.begin(), t.end());
  return corners;
}

/// Of what is drawn: what stays of each body, with its surface or its sections, if it has these.
Json parts_json(const Drawing& drawing, Arrays& data) {
  Json parts = drawing.parts();
  for (std::size_t b = 0; b < parts.size(); ++b) {
    if (const Surface* surface = drawing.surface(b)) {
      std::vector<float> vertices;
      for (const Vector3& v : surface->vertices)
        for (const double x : v) vertices.push_back(static_cast<float>(x));
      parts[b]["surface"] = {data.add(vertices), data.add(flat(surface->triangles))};
    }
    const Eigen::MatrixXf& shapes = drawing.shapes(b).shapes();
    if (shapes.size() > 0)
      parts[b]["shapes"] = data.add(std::vector<float>(shapes.data(), shapes.data() + shapes.size()));
    if (!drawing.triangles(b).empty()) parts[b]["triangles"] = data.add(flat(drawing.triangles(b)));
    const std::vector<Outline>& sections = drawing.sections(b);
    if (sections.empty()) continue;
    std::vector<float> widths;
    for (const Outline& o : sections) widths.insert(widths.end(), {static_cast<float>(o.y), static_cast<float>(o.z)});
    parts[b]["sections"] = {
        {"rectangle", sections.front().rectangle}, {"turns", drawing.turns(b)}, {"widths", data.add(widths)}};
  }
  return parts;
}

}  // namespace

RunReport::RunReport(const study::Prepared& prepared)
    : prepared_(prepared), looks_(prepared.scene), table_(most_stretches, most_moments, most_numbers) {}

std::string RunReport::picture() const {
  const std::string& formulation = prepared_.scene.formulation_name;
  return svg_plot(prepared_.title(), {formulation}, table_panels({{formulation, &table_}}, {}));
}

std::string RunReport::text(const study::CertifiedRun& ended, const Json& run) const {
  const Model& model = prepared_.model();
  Drawing drawing(prepared_.scene.model, prepared_.scene.formulation->terms(), looks_);
  Arrows arrows(prepared_.scene, prepared_.scene.formulation->terms(), table_.columns());
  std::vector<double> times, rates, deflections;
  std::vector<float> numbers;
  const std::vector<std::vector<double>> samples = table_.samples();
  for (const std::vector<double>& row : samples) {
    const State state = state_of_row(model.layout(), row);
    times.push_back(state.time);
    drawing.append(state.y, numbers);
    arrows.append(state.y, row);
    drawing.append_rates(rates);
    drawing.append_deflections(deflections);
  }
  Arrays data;
  Json validity = Json::array();
  add_validity(drawing.rates(), rates, "rate of '", "' over its fundamental frequency", ended.certificate, validity,
               data);
  add_validity(drawing.deflections(), deflections, "tip deflection of '", "' over its length", ended.certificate,
               validity, data);
  const Vector3& g = model.gravity();
  Json part{{"title", prepared_.title()},
            {"outcome", study::outcome_text(ended.summary)},
            {"scene", prepared_.values.text()},
            {"certificate", certificate_text(model, ended.summary, ended.certificate)},
            {"table", table_json(table_, samples, data)},
            {"animation",
             {{"gravity", {g.x(), g.y(), g.z()}},
              {"parts", parts_json(drawing, data)},
              {"size", drawing.size()},
              {"times", data.add(times)},
              {"numbers", data.add(numbers)},
              {"arrows", arrows_json(arrows, data)}}},
            {"validity", std::move(validity)}};
  std::string text = dumped_page(part);
  part = nullptr;  // it is as large as the page
  return data.behind(std::move(text), dumped_page(run));
}

}  // namespace withy
