#include "withy/core/plugin/segments.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "withy/core/shape/modal_mass.hpp"

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
  std::string measured_station() const override { return segment_->measured_station(); }
  const Rod* rod() const override { return segment_->rod(); }
  std::optional<BodyCut> cut(double x) const override { return segment_->cut(x); }
  std::vector<std::string> remarks() const override { return segment_->remarks(); }

 private:
  std::unique_ptr<Body> segment_;
  ModalShape shape_;
};

/// A body with its pieces.
class SegmentedBody final : public Body {
 public:
  SegmentedBody(std::unique_ptr<Body> whole, std::vector<std::shared_ptr<const Body>> segments)
      : whole_(std::move(whole)), segments_(std::move(segments)) {}
  const ModalShape& shape() const override { return whole_->shape(); }
  std::optional<PointExpansion> station(const StationName& name) const override { return whole_->station(name); }
  std::string stations() const override { return whole_->stations(); }
  std::string measured_station() const override { return whole_->measured_station(); }
  const Rod* rod() const override { return whole_->rod(); }
  std::vector<std::string> remarks() const override { return whole_->remarks(); }
  std::span<const std::shared_ptr<const Body>> segments() const override { return segments_; }

 private:
  std::unique_ptr<Body> whole_;
  std::vector<std::shared_ptr<const Body>> segments_;
};

Value segment_of(const Value& body, const std::vector<ParameterSpec>& specs, std::size_t k, std::size_t n) {
  const double length = body.number_at("length");
  const auto end = [&](std::size_t i) { return length * static_cast<double>(i) / static_cast<double>(n); };
  Value value = body;
  cut_tables(value, specs, end(k), end(k + 1));
  value.set("length", Value(end(k + 1) - end(k), body.at("length").place()));
  return value;
}

/// τ of damping τ K by strain, as the lowest mode v of each has it: vᵀ D v / vᵀ K v, 2 ζ/ω where that has the ratio ζ.
std::map<std::string, double> time_constants(const ModalShape& whole) {
  std::map<std::string, std::vector<Eigen::Index>> strains;
  for (Eigen::Index i = 0; i < whole.modes(); ++i)
    strains[strain_of(whole.mode_names[static_cast<std::size_t>(i)])].push_back(i);
  const Eigen::MatrixXd G = modal_mass(whole);
  std::map<std::string, double> times;
  for (const auto& [strain, at] : strains) {
    const Eigen::MatrixXd K = whole.stiffness(at, at);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(K, G(at, at));
    // Motions without strain come first and are not damped.
    Eigen::Index lowest = 0;
    while (lowest + 1 < K.rows() && solver.eigenvalues()[lowest] <= 1e-10 * solver.eigenvalues()[K.rows() - 1])
      ++lowest;
    const Eigen::VectorXd v = solver.eigenvectors().col(lowest);
    const double stiffness = v.dot(K * v);
    times[strain] = stiffness > 0 ? std::max(0.0, v.dot(whole.damping(at, at) * v)) / stiffness : 0.0;
  }
  return times;
}

std::unique_ptr<Body> damped_as(const ModalShape& whole, std::unique_ptr<Body> segment) {
  const std::map<std::string, double> times = time_constants(whole);
  ModalShape shape = segment->shape();
  Eigen::VectorXd scale(shape.modes());
  for (Eigen::Index i = 0; i < shape.modes(); ++i)
    scale[i] = std::sqrt(times.at(strain_of(shape.mode_names[static_cast<std::size_t>(i)])));
  shape.damping = scale.asDiagonal() * shape.stiffness * scale.asDiagonal();
  return std::make_unique<DampedSegment>(std::move(segment), std::move(shape));
}

}  // namespace

std::unique_ptr<Body> in_segments(std::unique_ptr<Body> whole, const Value& value,
                                  const std::vector<ParameterSpec>& specs,
                                  const std::function<std::unique_ptr<Body>(const Value& segment)>& make) {
  const std::size_t n = value.has("segments") ? value.count_at("segments") : 1;
  if (n == 1) return whole;
  std::vector<std::shared_ptr<const Body>> segments;
  for (std::size_t k = 0; k < n; ++k) {
    auto segment = make(segment_of(value, specs, k, n));
    if (segment == nullptr) return nullptr;
    segments.push_back(damped_as(whole->shape(), std::move(segment)));
  }
  return std::make_unique<SegmentedBody>(std::move(whole), std::move(segments));
}

}  // namespace withy
