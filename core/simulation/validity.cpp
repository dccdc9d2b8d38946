#include "withy/core/simulation/validity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "withy/core/plugin/measured_place.hpp"
#include "withy/core/simulation/elastic_modes.hpp"

namespace withy {
namespace {

// Measured (docs/validity.md): what a sample costs in evaluations of `ruthless`, the cheapest to be watched.
constexpr std::size_t motion_cost = 22;
constexpr std::size_t comparison_cost = 20;
constexpr std::size_t look_cost = 3;
constexpr std::size_t samples_per_cost = 50;  ///< 2 %
// Short runs are sampled more often, at intervals that grow with the run: a dozen samples by 1000 evaluations.
constexpr std::size_t growth = 4, least_interval = 20;
/// A state between samples is one too where a body turns this much faster than in any of them; rates below this share
/// of ω₁ matter to nobody.
constexpr double worthwhile = 1.1, least_ratio = 1e-3;
/// A family with less than this of its body's elastic energy does not take part: what rounding leaves of a motion out
/// of its plane has no highest mode.
constexpr double least_energy = 1e-6;
/// States are kept for what is found by assembled mass matrices.
constexpr std::size_t most_speeds_along = 300;
constexpr std::size_t most_along = 64, most_closely = 512;

std::size_t work_size(const EquationsOfMotion* equations) {
  return equations == nullptr ? 0 : equations->make_work().size();
}

}  // namespace

ValidityWatch::ValidityWatch(const Model& model, const EquationsOfMotion& equations, const EquationsOfMotion* beyond,
                             Validity& validity)
    : model_(model),
      equations_(equations),
      beyond_(beyond),
      validity_(validity),
      motion_(model),
      felt_(model, equations),
      frequency_(model, equations),
      spin_(model),
      loops_(model, equations),
      work_(std::max(work_size(&equations), work_size(beyond))),
      rates_(equations.size()),
      beyond_rates_(equations.size()),
      difference_(model.layout().speeds),
      product_(model.layout().speeds),
      cost_(motion_cost + (beyond != nullptr ? comparison_cost : 0) + (loops_.any() ? model.layout().speeds : 0)),
      held_{0, std::vector<double>(equations.size())},
      fastest_(held_),
      excess_(worthwhile),
      along_(model.layout().speeds <= most_speeds_along ? equations.size() : 0, most_along),
      closely_(beyond != nullptr && equations.linearly_implicit() == nullptr ? equations.size() : 0, most_closely),
      busiest_(model.layout().positions, model.layout().speeds, equations.size()),
      look_interval_((look_cost + (loops_.any() ? model.layout().speeds : 0)) * samples_per_cost) {
  std::unordered_map<const Body*, std::size_t> twins;
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const BodyNode& node = model.bodies()[b];
    const ModalShape& shape = node.body->shape();
    if (shape.modes() == 0) continue;
    const auto [known, fresh] = twins.try_emplace(node.body.get(), bodies_.size());
    const Watched* twin = fresh ? nullptr : &bodies_[known->second];
    Watched w{b,
              model.layout().modes(b),
              MotionStiffness(model, b, fresh ? nullptr : &twin->stiffness),
              fresh ? std::make_shared<std::vector<Family>>(families_of(shape)) : twin->families,
              {}};
    BodyValidity v{.name = node.name, .station = "", .beside = {}, .load = {}, .whole = {}, .highest = {}};
    for (const MeasuredPlace& place : measured_places(*node.body)) {
      if (v.station.empty()) {
        v.station = place.name;
      } else {
        v.beside.push_back(place.name);
      }
    }
    for (const Family& family : *w.families)
      v.highest.push_back({family.name, family.highest, 0, family.coordinates.size()});
    w.energies.resize(w.families->size());
    if (node.segment && node.segment->index == 0 && node.segment->body != nullptr)
      w.whole.emplace(model, *node.segment->body, model.segments(node.segment->whole));
    bodies_.push_back(std::move(w));
    validity_.bodies.push_back(std::move(v));
  }
}

std::vector<ValidityWatch::Family> ValidityWatch::families_of(const ModalShape& shape) {
  std::vector<Family> families;
  for (const ModeGroup& group : mode_groups(shape)) {
    const ElasticModes own = elastic_modes(shape, group.coordinates);
    const Eigen::Index highest = own.frequencies.size() - 1;
    if (highest < 0) continue;
    const auto n = static_cast<Eigen::Index>(group.coordinates.size());
    families.push_back({.name = group.name,
                        .highest = own.frequencies[highest],
                        .coordinates = group.coordinates,
                        .projection = own.mass * own.vectors.col(highest),
                        .stiffness = shape.stiffness(group.coordinates, group.coordinates),
                        .mass = own.mass,
                        .q = Eigen::VectorXd(n),
                        .rate = Eigen::VectorXd(n)});
  }
  return families;
}

void ValidityWatch::hold(const State& state, std::size_t evaluations) {
  next_ = evaluations + std::clamp(evaluations / growth, least_interval, samples_per_cost * cost_);
  held_ = state;
  due_ = true;
}

void ValidityWatch::settle() {
  look_at_busiest(std::numeric_limits<double>::infinity());
  sample_due();
}

void ValidityWatch::sample_due() {
  if (excess_ > worthwhile) look_at_motion(fastest_);
  excess_ = worthwhile;
  if (!due_) return;
  sample(held_);
  due_ = false;
}

/// A rate is known without an evaluation: all are taken, between samples with the frequency of the last.
void ValidityWatch::follow(const State& state, const Observation& seen) {
  double excess = 0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const double rate = seen.turning(static_cast<int>(bodies_[i].body));
    note_rate(i, rate, state.time);
    const double least = least_ratio * fundamental(bodies_[i].body);
    if (const double known = std::max(bodies_[i].sampled, least); known > 0) excess = std::max(excess, rate / known);
  }
  if (excess <= excess_) return;
  excess_ = excess;
  fastest_ = state;
}

void ValidityWatch::note_rate(std::size_t index, double rate, double time) {
  BodyValidity& v = validity_.bodies[index];
  const double lowest = fundamental(bodies_[index].body);
  if (!(lowest > 0)) return;
  const double ratio = rate / lowest;
  if (ratio <= v.rate_ratio && v.fundamental > 0) return;
  v.fundamental = lowest;
  v.rate_ratio = ratio;
  v.rate_time = time;
}

void ValidityWatch::sample(const State& state) {
  if (!look_at_motion(state)) return;
  ++validity_.samples;
  for (Watched& w : bodies_) look_at_energies(state, w);
  if (beyond_ != nullptr) compare_accelerations(state);
}

bool ValidityWatch::look_at_busiest(double trusted) {
  const State* const found = busiest_.found();
  if (found == nullptr || found->time > trusted) return false;
  look_at_loads(*found);
  busiest_.look_taken();
  return true;
}

bool ValidityWatch::look_at_loads(const State& state) {
  if (!equations_.derivatives(state.time, state.y, rates_, work_).ok()) return false;
  const Layout& layout = model_.layout();
  motion_.update(state.y, std::span<const double>(rates_).subspan(layout.positions, layout.speeds));
  felt_.update(state, motion_.bodies());
  loops_.update(state.y);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    BodyValidity& v = validity_.bodies[i];
    const LoadRatio load = bodies_[i].stiffness.evaluate(felt_.bodies(), felt_.at_frames(), loops_.of(bodies_[i].body));
    v.buckling = std::max(v.buckling, -load.least);
    if (bodies_[i].whole) {
      const LoadRatio whole = bodies_[i].whole->evaluate(felt_.bodies(), felt_.at_frames());
      if (whole.size() > v.whole.size()) v.whole = whole;
    }
    if (load.size() > v.load.size()) {
      v.load = load;
      v.load_time = state.time;
    }
  }
  return true;
}

bool ValidityWatch::look_at_motion(const State& state) {
  if (!look_at_loads(state)) return false;
  frequency_.update(state.y, work_);
  loops_.find_frequencies();
  spin_.update(motion_.bodies());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    Watched& w = bodies_[i];
    BodyValidity& v = validity_.bodies[i];
    if (const double spin = spin_.ratio(w.body, motion_.bodies(), fundamental(w.body)); spin > v.spin_ratio)
      v.spin_ratio = spin, v.spin_time = state.time;
    const double rate = felt_.turning(w.body).norm();
    w.sampled = std::max(w.sampled, rate);
    note_rate(i, rate, state.time);
  }
  return true;
}

void ValidityWatch::look_at_energies(const State& state, Watched& w) const {
  for (std::size_t f = 0; f < w.energies.size(); ++f) {
    Family& family = (*w.families)[f];
    Energy& energy = w.energies[f];
    for (std::size_t k = 0; k < family.coordinates.size(); ++k) {
      const auto c = static_cast<std::size_t>(family.coordinates[k]);
      family.q[static_cast<Eigen::Index>(k)] = state.y[w.slot->position + c];
      family.rate[static_cast<Eigen::Index>(k)] = state.y[model_.layout().positions + w.slot->speed + c];
    }
    const double q = family.highest * family.projection.dot(family.q), rate = family.projection.dot(family.rate);
    energy.highest += q * q + rate * rate;
    for (Eigen::Index i = 0; i < family.q.size(); ++i) {
      for (Eigen::Index j = 0; j < family.q.size(); ++j) {
        energy.whole +=
            family.q[i] * family.stiffness(i, j) * family.q[j] + family.rate[i] * family.mass(i, j) * family.rate[j];
      }
    }
  }
}

void ValidityWatch::compare_accelerations(const State& state) {
  if (!beyond_->derivatives(state.time, state.y, beyond_rates_, work_).ok()) return;
  const Layout& layout = model_.layout();
  const auto square = [&](std::span<const double> a) {
    beyond_->mass_times(state.y, a, product_, work_);
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * product_[i];
    return std::max(sum, 0.0);
  };
  const auto used = std::span<const double>(rates_).subspan(layout.positions, layout.speeds);
  for (std::size_t i = 0; i < used.size(); ++i) difference_[i] = beyond_rates_[layout.positions + i] - used[i];
  const double neglected = square(difference_), size = square(used);
  neglected_squares_ += neglected;
  squares_ += size;
  neglected_greatest_ = std::max(neglected_greatest_, neglected);
  greatest_ = std::max(greatest_, size);
  ++validity_.neglected.samples;
}

void ValidityWatch::remember(Memory& memory) {
  for (BodyValidity& v : validity_.bodies) {
    memory(v.fundamental);
    memory(v.rate_ratio);
    memory(v.rate_time);
    memory(v.spin_ratio);
    memory(v.spin_time);
    for (LoadRatio* load : {&v.load, &v.whole}) {
      memory(load->least);
      memory(load->greatest);
      memory(load->stiffens);
      for (double& share : load->shares) memory(share);
    }
    memory(v.load_time);
    memory(v.buckling);
  }
  for (Watched& w : bodies_) {
    memory(w.sampled);
    for (Energy& energy : w.energies) {
      memory(energy.highest);
      memory(energy.whole);
    }
  }
  frequency_.remember(memory);
  loops_.remember(memory);
  memory(validity_.samples);
  memory(validity_.neglected.samples);
  memory(squares_);
  memory(neglected_squares_);
  memory(greatest_);
  memory(neglected_greatest_);
  memory(next_);
  memory(held_.time);
  memory(held_.y);
  memory(due_);
  memory(fastest_.time);
  memory(fastest_.y);
  memory(excess_);
  along_.remember(memory);
  closely_.remember(memory);
  busiest_.remember(memory);
  memory(next_look_);
}

void ValidityWatch::finish(const State& trusted, bool sampled) {
  if (bodies_.empty()) return;
  due_ = due_ && held_.time <= trusted.time;
  look_at_busiest(trusted.time);
  sample_due();
  if (sampled) sample(trusted);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    double least = 0;
    for (const Energy& energy : bodies_[i].energies) least += least_energy * energy.whole;
    for (std::size_t f = 0; f < bodies_[i].energies.size(); ++f) {
      const Energy& energy = bodies_[i].energies[f];
      const double whole = std::max(energy.whole, least);
      validity_.bodies[i].highest[f].share = whole > 0 ? energy.highest / whole : 0;
    }
  }
  const auto ratio = [](double a, double b) { return b > 0 ? std::sqrt(a / b) : 0; };
  validity_.neglected.rms = ratio(neglected_squares_, squares_);
  validity_.neglected.peak = ratio(neglected_greatest_, greatest_);
  validity_.along = along_.until(trusted, sampled);
  validity_.closely = closely_.until(trusted, sampled);
}

}  // namespace withy
