#include "withy/results/result_columns.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <limits>

namespace withy {
namespace {

void add(std::vector<Column>& columns, const std::string& name, std::initializer_list<const char*> suffixes,
         const std::string& unit) {
  for (const char* suffix : suffixes) columns.push_back({name + suffix, unit});
}

std::string hinge_frame(const HingeNode& hinge) { return "F of hinge " + hinge.name; }

bool same_columns(const HingeNode& a, const HingeNode& b) {
  if (a.name != b.name) return false;
  const auto kernel = a.hinge->kernel(), other = b.hinge->kernel();
  return kernel && other && kernel->kind == other->kind;
}
bool same_columns(const BodyNode& a, const BodyNode& b) {
  const auto whole = [](const BodyNode& n) { return n.segment ? n.segment->whole : std::string(); };
  return a.name == b.name && a.segment.has_value() == b.segment.has_value() && whole(a) == whole(b) &&
         (a.frame("tip") < 0) == (b.frame("tip") < 0) && a.body->shape().modes() == b.body->shape().modes();
}
bool same_columns(const SensorNode& a, const SensorNode& b) {
  const auto same = [](const Column& m, const Column& n) { return m.name == n.name && m.unit == n.unit; };
  const std::vector<Column> all = columns_of(a), others = columns_of(b);
  return a.name == b.name && std::equal(all.begin(), all.end(), others.begin(), others.end(), same);
}

}  // namespace

bool same_columns(const Model& a, const std::vector<SensorNode>& sensors_of_a, const Model& b,
                  const std::vector<SensorNode>& sensors_of_b) {
  const auto same = [](const auto& all, const auto& others) {
    return std::equal(all.begin(), all.end(), others.begin(), others.end(),
                      [](const auto& x, const auto& y) { return same_columns(x, y); });
  };
  const auto moved = [](const MotionNode& m, const MotionNode& n) { return m.hinge == n.hinge; };
  return same(a.hinges(), b.hinges()) && same(a.bodies(), b.bodies()) && same(sensors_of_a, sensors_of_b) &&
         a.layout().speed_names == b.layout().speed_names &&
         std::equal(a.motions().begin(), a.motions().end(), b.motions().begin(), b.motions().end(), moved);
}

ResultColumns::ResultColumns(const Model& model, const EquationsOfMotion& equations,
                             const std::vector<SensorNode>& sensors)
    : model_(model),
      equations_(equations),
      tips_(tips(model)),
      seen_(equations.make_observation()),
      sensors_(sensors, equations),
      work_(model.motions().empty() ? Work(0) : equations.make_work()),
      efforts_(model.layout().speeds),
      nonfinite_(sensors_.columns().size()) {}

const ResultColumns::Names& ResultColumns::named() const {
  auto& [columns, frames] = names_;
  if (!columns.empty()) return names_;
  const Layout& layout = model_.layout();
  columns.push_back({"t", "s"});
  const auto in = [&](const std::string& frame) { names_.frames.resize(names_.columns.size(), frame); };
  const auto append = [&](const std::vector<Column>& more) {
    names_.columns.insert(names_.columns.end(), more.begin(), more.end());
  };
  in("");
  for (const HingeNode& h : model_.hinges()) {
    append(coordinate_columns(h));
    in(hinge_frame(h));
  }
  const auto add_modes = [&](const char* suffix, const char* unit) {
    for (const Slot& body : layout.bodies)
      for (std::size_t i = 0; i < body.speeds; ++i)
        names_.columns.push_back({layout.speed_names[body.speed + i] + suffix, unit});
  };
  add_modes("", "");
  in("");
  for (const HingeNode& h : model_.hinges()) {
    append(rate_columns(h));
    in(hinge_frame(h));
  }
  add_modes(".rate", "1/s");
  in("");
  for (const Tip& tip : tips_) {
    if (!tip.flexible) continue;
    add(columns, tip.body, {".tip.deflection_x", ".tip.deflection_y", ".tip.deflection_z"}, "m");
    in(tip.body);
  }
  for (const Tip& tip : tips_) add(columns, tip.body, {".tip.x", ".tip.y", ".tip.z"}, "m");
  in("world");
  for (const MotionNode& motion : model_.motions()) {
    const HingeNode& hinge = model_.hinges()[static_cast<std::size_t>(motion.hinge)];
    append(motion_effort_columns(hinge));
    in(hinge_frame(hinge));
  }
  add(columns, "", {"kinetic_energy", "potential_energy", "work"}, "J");
  in("");
  add(columns, "linear_momentum", {".x", ".y", ".z"}, "kg m/s");
  add(columns, "angular_momentum", {".x", ".y", ".z"}, "kg m^2/s");
  in("world, about its origin");
  append(sensors_.columns());
  in("as the scene's outputs say");
  columns.shrink_to_fit();
  frames.shrink_to_fit();
  return names_;
}

const std::vector<double>& ResultColumns::row(const State& state) {
  seen_->observe(state.y);
  return row_of_seen(state);
}

const std::vector<double>& ResultColumns::row_of_seen(const State& state) {
  const Layout& layout = model_.layout();
  row_.assign(1, state.time);
  for (const Slot& s : layout.hinges) append(state, s.position, s.positions);
  for (const Slot& s : layout.bodies) append(state, s.position, s.positions);
  for (const Slot& s : layout.hinges) append(state, layout.positions + s.speed, s.speeds);
  for (const Slot& s : layout.bodies) append(state, layout.positions + s.speed, s.speeds);
  for (const Tip& tip : tips_) {
    if (tip.flexible) append(deflection(*seen_, tip));
  }
  for (const Tip& tip : tips_) append(seen_->frame_pose(tip.tip.body, tip.tip.frame).position);
  if (!model_.motions().empty()) append_motion_efforts(state);
  const Energies e = seen_->energies();
  row_.insert(row_.end(), {e.kinetic, e.potential, state.y.back()});
  append(e.linear_momentum);
  append(e.angular_momentum);
  append_sensors(state);
  return row_;
}

std::vector<ResultColumns> columns_of_rungs(const study::Prepared& prepared) {
  std::vector<ResultColumns> all;
  all.reserve(prepared.rungs.size() + 1);
  if (!prepared.escalates()) all.emplace_back(prepared.model(), *prepared.equations, prepared.scene.outputs);
  for (const Rung& rung : prepared.rungs) all.emplace_back(prepared.model(), *rung.equations, prepared.scene.outputs);
  return all;
}

State state_of_row(const Layout& layout, std::span<const double> row) {
  State state;
  state.time = row[0];
  state.y.assign(layout.size(), 0.0);
  std::size_t next = 1;
  const auto take = [&](std::size_t first, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) state.y[first + i] = row[next++];
  };
  for (const Slot& s : layout.hinges) take(s.position, s.positions);
  for (const Slot& s : layout.bodies) take(s.position, s.positions);
  for (const Slot& s : layout.hinges) take(layout.positions + s.speed, s.speeds);
  for (const Slot& s : layout.bodies) take(layout.positions + s.speed, s.speeds);
  return state;
}

// Few numbers each: to copy a range of them takes longer.
void ResultColumns::append(const State& state, std::size_t first, std::size_t count) {
  for (std::size_t i = first; i < first + count; ++i) row_.push_back(state.y[i]);
}

void ResultColumns::append(const std::array<double, 3>& vector) {
  for (const double x : vector) row_.push_back(x);
}

void ResultColumns::append_sensors(const State& state) {
  const std::size_t first = row_.size();
  row_.resize(first + sensors_.columns().size());
  const std::span<double> values = std::span(row_).subspan(first);
  if (!sensors_.read(state, values)) {
    std::fill(values.begin(), values.end(), std::numeric_limits<double>::quiet_NaN());
    return;
  }
  for (std::size_t i = 0; i < values.size(); ++i) nonfinite_[i] += std::isfinite(values[i]) ? 0 : 1;
}

void ResultColumns::append_motion_efforts(const State& state) {
  equations_.motion_efforts(state.time, state.y, efforts_, work_);
  for (const MotionNode& motion : model_.motions()) {
    const Slot& slot = model_.layout().hinges[static_cast<std::size_t>(motion.hinge)];
    for (std::size_t i = 0; i < slot.speeds; ++i) row_.push_back(efforts_[slot.speed + i]);
  }
}

}  // namespace withy
