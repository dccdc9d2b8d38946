#include "withy/core/plugin/segments.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "withy/core/plugin/turned_sections.hpp"
#include "withy/core/shape/modal_mass.hpp"
#include "withy/core/shape/vibrations.hpp"

namespace withy {
namespace {

const ParameterSpec* spec_of(const std::vector<ParameterSpec>& specs, std::string_view key) {
  const auto it = std::find_if(specs.begin(), specs.end(), [&](const ParameterSpec& s) { return s.key == key; });
  return it == specs.end() ? nullptr : &*it;
}

/// The rows of a table from x0 to x1 [m], linear between its rows, with x counted from x0. A row that is at an end but
/// for rounding is that end; of a jump there, two rows close together, the part has the side that it lies on.
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
  const double rounding = 1e-9 * (x1 - x0);
  const auto is_at = [&](double x) { return [=](const auto& row) { return std::abs(row.front() - x) <= rounding; }; };
  const auto last = std::find_if(rows.rbegin(), rows.rend(), is_at(x0));
  const auto first = std::find_if(rows.begin(), rows.end(), is_at(x1));
  Value result = Value::list({}, table.place());
  const auto add = [&](std::vector<double> row, double x) {
    row.front() = x;
    Value items = Value::list({}, table.place());
    for (const double number : row) items.items().emplace_back(number, table.place());
    result.items().push_back(std::move(items));
  };
  add(last != rows.rend() ? *last : at(x0), 0);
  for (const auto& row : rows) {
    const bool inside = row.front() > x0 && row.front() < x1;
    if (inside && !is_at(x0)(row) && !is_at(x1)(row)) add(row, row.front() - x0);
  }
  add(first != rows.end() ? *first : at(x1), x1 - x0);
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

/// What the strains of a body hold: all of K where it tells of none.
std::vector<Eigen::MatrixXd> stiffness_by_strain(const Body& body) {
  const auto* sections = dynamic_cast<const TurnedSections*>(&body);
  return sections != nullptr ? sections->stiffness_by_strain() : std::vector{body.shape().stiffness};
}

class DampedSegment final : public Body, public TurnedSections {
 public:
  DampedSegment(std::shared_ptr<const Body> segment, ModalShape shape)
      : segment_(std::move(segment)), shape_(std::move(shape)) {}
  const ModalShape& shape() const override { return shape_; }
  std::optional<PointExpansion> station(const StationName& name) const override { return segment_->station(name); }
  std::string stations() const override { return segment_->stations(); }
  std::string measured_station() const override { return segment_->measured_station(); }
  std::vector<std::string> measured_beside() const override { return segment_->measured_beside(); }
  /// Kinematics are of the second order, which leaves K, and D with it.
  std::shared_ptr<const Body> expanded(const StrainKinematics& kinematics) const override {
    const std::shared_ptr<const Body> segment = segment_->expanded(kinematics);
    if (segment == nullptr) return nullptr;
    ModalShape shape = segment->shape();
    shape.damping = shape_.damping;
    return std::make_shared<const DampedSegment>(segment, std::move(shape));
  }
  const Rod* rod() const override { return segment_->rod(); }
  std::optional<BodyCut> cut(double x) const override { return segment_->cut(x); }
  Matrix3 section_axes(double x) const override {
    const auto* sections = dynamic_cast<const TurnedSections*>(segment_.get());
    return sections != nullptr ? sections->section_axes(x) : Matrix3::Identity();
  }
  std::vector<Eigen::MatrixXd> stiffness_by_strain() const override { return withy::stiffness_by_strain(*segment_); }
  std::vector<std::string> remarks() const override { return segment_->remarks(); }

 private:
  std::shared_ptr<const Body> segment_;
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
  std::vector<std::string> measured_beside() const override { return whole_->measured_beside(); }
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

/// A mode of the whole that strains it.
struct StrainedMode {
  double square;           ///< ω² [1/s²]
  double time;             ///< τ = vᵀDv/vᵀKv [s]
  Eigen::VectorXd shares;  ///< of its strain energy, by strain
};

/// Modes of some coordinates that no others are coupled with. Where G is singular each coordinate is taken for a mode.
void add_modes_of(const std::vector<Eigen::Index>& group, const Eigen::MatrixXd& K, const Eigen::MatrixXd& G,
                  const Eigen::MatrixXd& D, const std::vector<Eigen::MatrixXd>& strains,
                  std::vector<StrainedMode>& modes) {
  const auto n = static_cast<Eigen::Index>(group.size());
  const Eigen::MatrixXd inertia = G(group, group), stiffness = K(group, group);
  Vibrations found{stiffness.diagonal().cwiseQuotient(inertia.diagonal().cwiseMax(1e-300)),
                   Eigen::MatrixXd::Identity(n, n)};
  if (Eigen::LLT<Eigen::MatrixXd>(inertia).info() == Eigen::Success) found = vibrations(stiffness, inertia);
  const double greatest = found.squares.maxCoeff();
  for (Eigen::Index k = 0; k < n; ++k) {
    if (found.squares[k] <= 0 || is_rounding(found.squares[k], greatest)) continue;  // a motion without strain
    const Eigen::VectorXd v = found.vectors.col(k);
    Eigen::VectorXd energies(static_cast<Eigen::Index>(strains.size()));
    for (std::size_t s = 0; s < strains.size(); ++s)
      energies[static_cast<Eigen::Index>(s)] = std::max(0.0, v.dot(strains[s](group, group) * v));
    if (!(energies.sum() > 0)) continue;
    const double dissipation = std::max(0.0, v.dot(D(group, group) * v));
    modes.push_back({found.squares[k], dissipation / energies.sum(), energies / energies.sum()});
  }
}

/// τ [s] of damping Σ τ_s K_s by strain (in_segments). What a strain takes of a mode is the mode's share in it, until
/// these add to one: a strain that the lowest mode is alone in has all of that mode's τ, whatever other modes are, and
/// a slight coupling of strains changes their τ slightly.
Eigen::VectorXd time_constants(const Body& whole) {
  const ModalShape& shape = whole.shape();
  const std::vector<Eigen::MatrixXd> strains = stiffness_by_strain(whole);
  Eigen::VectorXd times = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(strains.size()));
  if (shape.modes() == 0 || shape.damping.isZero(0)) return times;
  const Eigen::MatrixXd G = modal_mass(shape);
  std::vector<StrainedMode> modes;
  for (const auto& group : coupled_coordinates(shape.stiffness, G))
    add_modes_of(group, shape.stiffness, G, shape.damping, strains, modes);
  std::stable_sort(modes.begin(), modes.end(),
                   [](const StrainedMode& a, const StrainedMode& b) { return a.square < b.square; });
  Eigen::VectorXd left = Eigen::VectorXd::Ones(times.size());
  std::vector<Eigen::VectorXd> taken;
  for (const StrainedMode& mode : modes) {
    taken.push_back(mode.shares.cwiseMin(left));
    left -= taken.back();
    times += mode.time * taken.back();
  }
  for (Eigen::Index s = 0; s < times.size(); ++s)
    if (left[s] < 1) times[s] /= 1 - left[s];
  // Modes whose strains no lower ones have filled, as the first of either plane, exactly by these strains. The weight
  // goes to zero with what is not filled, half of it: a slight coupling changes it slightly. The lowest of all is last,
  // and stays exact.
  for (std::size_t k = modes.size(); k-- > 0;) {
    const double weight = 2 * taken[k].sum() - 1;
    if (weight <= 0) continue;
    const double miss = modes[k].time - modes[k].shares.dot(times);
    times = (times + weight * miss / modes[k].shares.dot(taken[k]) * taken[k]).cwiseMax(0);
  }
  return times;
}

std::unique_ptr<Body> damped_as(const Eigen::VectorXd& times, std::unique_ptr<Body> segment) {
  ModalShape shape = segment->shape();
  const std::vector<Eigen::MatrixXd> strains = stiffness_by_strain(*segment);
  shape.damping.setZero();
  for (Eigen::Index s = 0; s < times.size(); ++s) shape.damping += times[s] * strains.at(static_cast<std::size_t>(s));
  return std::make_unique<DampedSegment>(std::move(segment), std::move(shape));
}

}  // namespace

std::unique_ptr<Body> in_segments(std::unique_ptr<Body> whole, const Value& value,
                                  const std::vector<ParameterSpec>& specs,
                                  const std::function<std::unique_ptr<Body>(const Value& segment)>& make,
                                  const Body* vibrating) {
  const std::size_t n = value.has("segments") ? value.count_at("segments") : 1;
  if (n == 1) return whole;
  const Eigen::VectorXd times = time_constants(vibrating != nullptr ? *vibrating : *whole);
  std::vector<std::shared_ptr<const Body>> segments;
  for (std::size_t k = 0; k < n; ++k) {
    auto segment = make(segment_of(value, specs, k, n));
    if (segment == nullptr) return nullptr;
    segments.push_back(damped_as(times, std::move(segment)));
  }
  return std::make_unique<SegmentedBody>(std::move(whole), std::move(segments));
}

std::optional<SegmentPlace> place_in_segments(std::span<const double> lengths, double x) {
  constexpr double rounding = 1e-9;
  const double whole = std::accumulate(lengths.begin(), lengths.end(), 0.0);
  if (lengths.empty() || !(x >= -rounding * whole && x <= (1 + rounding) * whole)) return {};
  std::size_t k = 0;
  double root = 0;
  while (k + 1 < lengths.size() && x >= root + (1 - rounding) * lengths[k]) root += lengths[k++];
  return SegmentPlace{k, std::clamp(x - root, 0.0, lengths[k])};
}

}  // namespace withy
