#include "withy/results/report/run_report.hpp"

#include <algorithm>
#include <cmath>
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

/// Arrays of numbers, written as text as they come; what else there is refers to them by their index.
class ArrayTexts {
 public:
  explicit ArrayTexts(const TextSink& write) : write_(write) {}
  template <class Number>
  std::size_t add(const std::vector<Number>& numbers) {
    write_((count_ == 0 ? "\"" : ",\"") + base64_of(numbers) + '"');
    return count_++;
  }

 private:
  const TextSink& write_;
  std::size_t count_ = 0;
};

namespace {

using Json = nlohmann::ordered_json;

/// Stretches of a report's table, about as many as a plot is wide, their numbers in all columns together, and moments
/// of its animation: 2 MB of data are soon opened.
constexpr std::size_t most_stretches = 2000, most_numbers = 80'000, most_moments = 400;

/// Writes `[…]` of what `item` makes, one at a time: a large model's list is larger than the model.
template <class Item>
void write_list(std::size_t count, const Item& item, const TextSink& write) {
  write("[");
  for (std::size_t i = 0; i < count; ++i) write((i > 0 ? "," : "") + page_json(item(i)));
  write("]");
}

/// Up to two rows a stretch the least and the greatest of each are its rows. Where a stretch has more, each column also
/// has its numbers at the moments of the animation: what is computed of several columns, or of several runs, needs
/// numbers of one time.
constexpr std::size_t whole_stretch = 2;

Json column_json(const DecimatedTable& table, std::size_t c, const std::vector<DecimatedTable::Row>& samples,
                 ArrayTexts& data) {
  const Column& column = table.columns()[c];
  Json j{{"name", column_name(column.name)}, {"unit", column.unit}, {"data", data.add(table.column(c))}};
  if (table.stride() > whole_stretch) {
    std::vector<double> own;
    for (const DecimatedTable::Row& row : samples) own.push_back((*row)[c]);
    j["samples"] = data.add(own);
  }
  return j;
}

/// What a page can compute of whole rows it is told where it has none.
void write_table(const ReportTable& table, const std::vector<DecimatedTable::Row>& samples, ArrayTexts& data,
                 const TextSink& write) {
  const DecimatedTable& kept = table.kept();
  write("{\"rows\":" + std::to_string(kept.rows()) + ",\"stride\":" + std::to_string(kept.stride()) + ",\"columns\":");
  write_list(
      table.recorded().size(), [&](std::size_t c) { return column_json(kept, c, samples, data); }, write);
  write(",\"derived\":");
  write_list(
      kept.stride() > whole_stretch ? table.derived().shown() : 0,
      [&](std::size_t d) { return column_json(kept, table.recorded().size() + d, samples, data); }, write);
  write("}");
}

/// What was measured of each row; each series has the limit of the indicator of its name.
Json validity_json(const ReportTable& table, const study::Certificate& certificate, ArrayTexts& data) {
  std::unordered_map<std::string_view, double> limits, fundamentals;
  for (const study::Indicator& i : certificate.indicators) limits.try_emplace(i.text, i.limit);
  for (const BodyValidity& b : certificate.bodies) fundamentals[b.name] = b.fundamental;
  Json all = Json::array();
  const auto add = [&](const DerivedColumns::Measured& measured, const std::string& name, double scale) {
    const auto limit = limits.find(name);
    if (limit == limits.end()) return;
    std::vector<double> numbers = table.kept().column(table.recorded().size() + measured.column);
    for (double& x : numbers) x *= scale;
    all.push_back({{"name", name}, {"limit", limit->second}, {"of", "rows"}, {"data", data.add(numbers)}});
  };
  const DerivedColumns& derived = table.derived();
  for (const DerivedColumns::Measured& m : derived.rates()) {
    const auto fundamental = fundamentals.find(m.body);
    add(m, derived.columns()[m.column].name + " over its fundamental frequency",
        fundamental != fundamentals.end() ? 1 / fundamental->second : 1);
  }
  for (const DerivedColumns::Measured& m : derived.deflections()) add(m, derived.columns()[m.column].name, 1);
  return all;
}

/// Places and vectors moment by moment, six numbers each. \param far whether remainders of the places are told
Json arrows_json(const Arrows& arrows, bool far, ArrayTexts& data) {
  Json list = Json::array();
  for (const Arrows::Arrow& a : arrows.all()) {
    list.push_back({{"name", a.name}, {"unit", a.unit}, {"greatest", a.greatest}, {"numbers", data.add(a.numbers)}});
    if (far) list.back()["remainders"] = data.add(a.remainders);
  }
  return list;
}

/// Of the size of a system, what places may be off by: less than can be seen, also from much nearer.
constexpr double unseen = 1e-6;

/// Whether what is left of places is more than that, as far away from the world's origin.
bool seen(const std::vector<float>& remainders, double size) {
  return std::any_of(remainders.begin(), remainders.end(),
                     [&](float x) { return std::abs(static_cast<double>(x)) > unseen * size; });
}

std::vector<std::uint32_t> flat(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<std::uint32_t> corners;
  for (const auto& t : triangles) corners.insert(corners.end(), t.begin(), t.end());
  return corners;
}

/// Of what is drawn: what stays of a body, with its surface or its sections, if it has these.
Json part_json(const Drawing& drawing, std::size_t b, ArrayTexts& data) {
  Json part = drawing.part(b);
  if (const Surface* surface = drawing.surface(b)) {
    std::vector<float> vertices;
    for (const Vector3& v : surface->vertices)
      for (const double x : v) vertices.push_back(static_cast<float>(x));
    part["surface"] = {data.add(vertices), data.add(flat(surface->triangles))};
  }
  const Eigen::MatrixXf& shapes = drawing.shapes(b).shapes();
  if (shapes.size() > 0) part["shapes"] = data.add(std::vector<float>(shapes.data(), shapes.data() + shapes.size()));
  if (!drawing.triangles(b).empty()) part["triangles"] = data.add(flat(drawing.triangles(b)));
  const std::vector<Outline>& sections = drawing.sections(b);
  if (sections.empty()) return part;
  std::vector<float> widths;
  for (const Outline& o : sections) widths.insert(widths.end(), {static_cast<float>(o.y), static_cast<float>(o.z)});
  part["sections"] = {
      {"rectangle", sections.front().rectangle}, {"turns", drawing.turns(b)}, {"widths", data.add(widths)}};
  return part;
}

}  // namespace

RunReport::RunReport(const study::Prepared& prepared)
    : prepared_(prepared), looks_(prepared.scene), table_(prepared, most_stretches, most_moments, most_numbers) {}

std::string RunReport::picture() const {
  const std::string& formulation = prepared_.scene.formulation_name;
  const DecimatedTable recorded(table_.kept(), table_.recorded().size());
  return svg_plot(prepared_.title(), {formulation}, table_panels({{formulation, &recorded}}, {}));
}

void RunReport::write(const study::CertifiedRun& ended, std::string_view run, const TextSink& write) const {
  const Model& model = prepared_.model();
  const auto member = [&](const char* name, const Json& value) { write(std::string(name) + page_json(value)); };
  member("{\"title\":", prepared_.title());
  member(",\"outcome\":", study::outcome_text(ended.summary));
  member(",\"scene\":", prepared_.values.text());
  member(",\"certificate\":", certificate_text(model, ended.summary, ended.certificate));
  // The arrays first: they are most of a page, and what refers to them can wait in memory until they are written.
  write(",\"arrays\":[");
  ArrayTexts data(write);
  std::vector<std::string> waiting;
  const TextSink later = [&](std::string_view text) {
    constexpr std::size_t block = 1 << 16;
    if (waiting.empty() || waiting.back().size() + text.size() > waiting.back().capacity())
      waiting.emplace_back().reserve(std::max(block, text.size()));
    waiting.back() += text;
  };
  {
    const std::vector<DecimatedTable::Row> samples = table_.kept().samples();
    later("],\"table\":");
    write_table(table_, samples, data, later);
    write_motion(samples, ended, data, later);
  }
  for (const std::string& text : waiting) write(text);
  write(",\"run\":");
  write(run);
  write("}");
}

void RunReport::write_motion(const std::vector<DecimatedTable::Row>& samples, const study::CertifiedRun& ended,
                             ArrayTexts& data, const TextSink& write) const {
  Drawing drawing(prepared_.scene.model, prepared_.scene.formulation->terms(), looks_, prepared_.equations.get());
  Arrows arrows(prepared_.scene, prepared_.scene.formulation->terms(), table_.recorded());
  std::vector<double> times;
  std::vector<float> numbers, remainders;
  double size = 0;
  for (const DecimatedTable::Row& row : samples) {
    const State state = state_of_row(prepared_.model().layout(), *row);
    if (times.empty()) size = drawing.extent(state.y);
    times.push_back(state.time);
    drawing.append(state.y, numbers, remainders);
    arrows.append(state.y, *row);
  }
  const Vector3& g = prepared_.model().gravity();
  write(",\"animation\":{\"gravity\":" + page_json({g.x(), g.y(), g.z()}) + ",\"parts\":");
  write_list(
      drawing.parts(), [&](std::size_t b) { return part_json(drawing, b, data); }, write);
  write(",\"size\":" + std::to_string(drawing.size()) + ",\"times\":" + std::to_string(data.add(times)) +
        ",\"numbers\":" + std::to_string(data.add(numbers)));
  const bool far = seen(remainders, size);
  if (far) write(",\"remainders\":" + std::to_string(data.add(remainders)));
  write(",\"arrows\":" + page_json(arrows_json(arrows, far, data)));
  Json validity = validity_json(table_, ended.certificate, data);
  write("},\"validity\":");
  write_list(
      validity.size(), [&](std::size_t i) { return std::move(validity[i]); }, write);
}

}  // namespace withy
