#include "withy/scene/segments.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "withy/core/simulation/elastic_modes.hpp"

namespace withy {
namespace {

const ParameterSpec* spec_of(const std::vector<ParameterSpec>& specs, std::string_view key) {
  const auto it = std::find_if(specs.begin(), specs.end(), [&](const ParameterSpec& s) { return s.key == key; });
  return it == specs.end() ? nullptr : &*it;
}

/// The rows of a table from x0 to x1 [m], linear between its rows, with x counted from x0.
Value cut(const Value& table, double x0, double x1) {
  std::vector<std::vector<double>> rows;
  for (const Value& row : table.items()) rows.push_back(row.numbers());
  const auto at = [&](double x) {
    const auto after =
        std::upper_bound(rows.begin(), rows.end(), x, [](double a, const auto& row) { return a < row.front(); });
    if (after == rows.begin()) return rows.front();
    if (after == rows.end()) return rows.back();
    std::vector<double> row = *(after - 1);
    const double share = (x - row.front()) / (after->front() - row.front());
    for (std::size_t c = 1; c < row.size(); ++c) row[c] += share * ((*after)[c] - row[c]);
    return row;
  };
  Value result = Value::list({}, table.place());
  const auto add = [&](std::vector<double> row, double x) {
    row.front() = x;
    Value items = Value::list({}, table.place());
    for (const double number : row) items.items().emplace_back(number, table.place());
    result.items().push_back(std::move(items));
  };
  // A row that is at an end but for rounding is that end.
  const double rounding = 1e-9 * (x1 - x0);
  add(at(x0), 0);
  for (const auto& row : rows) {
    if (row.front() > x0 + rounding && row.front() < x1 - rounding) add(row, row.front() - x0);
  }
  add(at(x1), x1 - x0);
  return result;
}

/// Every table over x in a value, cut.
void cut_tables(Value& value, const std::vector<ParameterSpec>& specs, double x0, double x1) {
  for (auto& [key, member] : value.members()) {
    const ParameterSpec* spec = spec_of(specs, key);
    if (spec == nullptr) continue;
    if (spec->kind == ParameterSpec::Kind::map) cut_tables(member, spec->members, x0, x1);
    const bool over_x = spec->kind == ParameterSpec::Kind::number && !spec->columns.empty() && spec->columns[0] == "m";
    if (over_x && member.kind() == Value::Kind::list) member = cut(member, x0, x1);
  }
}

/// "bending_y" of "bending_y[2]".
std::string strain_of(const std::string& mode) { return mode.substr(0, mode.find('[')); }

class DampedSegment final : public Body {
 public:
  DampedSegment(std::unique_ptr<Body> segment, ModalShape shape)
      : segment_(std::move(segment)), shape_(std::move(shape)) {}
  const ModalShape& shape() const override { return shape_; }
  std::optional<PointExpansion> station(const StationName& name) const override { return segment_->station(name); }
  std::string stations() const override { return segment_->stations(); }
  const Rod* rod() const override { return segment_->rod(); }
  std::vector<std::string> remarks() const override { return segment_->remarks(); }

 private:
  std::unique_ptr<Body> segment_;
  ModalShape shape_;
};

}  // namespace

std::size_t segments_of(const Value& body, const std::vector<ParameterSpec>& specs) {
  const Value* segments = body.find("segments");
  const ParameterSpec* spec = spec_of(specs, "segments");
  if (segments == nullptr || spec == nullptr || spec->kind != ParameterSpec::Kind::integer) return 1;
  return spec_of(specs, "length") == nullptr ? 1 : body.count_at("segments");
}

Value segment_of(const Value& body, const std::vector<ParameterSpec>& specs, std::size_t k, std::size_t n) {
  const double length = body.number_at("length");
  const auto end = [&](std::size_t i) { return length * static_cast<double>(i) / static_cast<double>(n); };
  Value value = body;
  cut_tables(value, specs, end(k), end(k + 1));
  value.set("length", Value(end(k + 1) - end(k), body.at("length").place()));
  return value;
}

std::unique_ptr<Body> damped_as(const ModalShape& whole, std::unique_ptr<Body> segment) {
  std::map<std::string, double> times;  // sqrt(τ) by strain
  for (const ModeGroup& group : mode_groups(whole)) {
    const ElasticModes modes = elastic_modes(whole, group.coordinates);
    if (modes.vectors.cols() == 0) continue;
    // Of the lowest mode: vᵀ D v = 2 ζ ω, vᵀ K v = ω².
    const Eigen::VectorXd v = modes.vectors.col(0);
    const double damping = v.dot(whole.damping(group.coordinates, group.coordinates) * v);
    times.emplace(group.name, std::sqrt(std::max(0.0, damping)) / modes.frequencies[0]);
  }
  ModalShape shape = segment->shape();
  Eigen::VectorXd scale(shape.modes());
  for (Eigen::Index i = 0; i < shape.modes(); ++i)
    scale[i] = times[strain_of(shape.mode_names[static_cast<std::size_t>(i)])];
  shape.damping = scale.asDiagonal() * shape.stiffness * scale.asDiagonal();
  return std::make_unique<DampedSegment>(std::move(segment), std::move(shape));
}

}  // namespace withy
