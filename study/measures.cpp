#include "withy/study/measures.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "withy/core/model/columns.hpp"
#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

Eigen::Quaterniond quaternion(std::span<const double> v) {
  return Eigen::Quaterniond(v[0], v[1], v[2], v[3]).normalized();
}

std::string tip_name(const Tip& tip, bool deflection) { return tip.body + (deflection ? ".tip.deflection" : ".tip"); }

std::size_t numbers_of(Output::Shape shape) {
  constexpr std::array<std::size_t, 3> numbers = {1, 3, 4};
  return numbers.at(static_cast<std::size_t>(shape));
}

/// q and −q are the same orientation.
double distance(Output::Shape shape, std::span<const double> a, std::span<const double> b) {
  switch (shape) {
    case Output::Shape::number:
      return std::abs(a[0] - b[0]);
    case Output::Shape::vector:
      return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    case Output::Shape::orientation:
      return quaternion(a).angularDistance(quaternion(b));
  }
  return 0;
}

/// The names that outputs may be asked for by.
std::string known_names(const Model& model, const std::vector<Tip>& tips) {
  std::string list;
  const auto add = [&](const std::string& name) { list += (list.empty() ? "" : ", ") + name; };
  for (std::size_t h = 0; h < model.hinges().size(); ++h)
    if (model.layout().hinges[h].positions > 0) add(model.hinges()[h].name);
  for (const Tip& tip : tips) {
    add(tip_name(tip, false));
    if (tip.flexible) add(tip_name(tip, true));
  }
  return list;
}

double greatest(const std::map<std::string, double>& values) {
  double most = 0;
  for (const auto& [name, value] : values) most = std::max(most, value);
  return most;
}

}  // namespace

const char* measure_name(std::size_t measure) {
  constexpr std::array<const char*, measures> names = {"angle", "slide", "place", "deflection"};
  return names.at(measure);
}

const char* measure_unit(std::size_t measure) { return measure == 0 ? "rad" : "m"; }

Outputs::Outputs(const Model& model, const std::vector<std::string>& names) {
  const std::vector<Tip> all_tips = tips(model);
  if (names.empty()) {
    for (std::size_t h = 0; h < model.hinges().size(); ++h)
      if (!model.driven(h)) add_hinge(model, h);
    for (std::size_t i = 0; i < all_tips.size(); ++i) add_tip(all_tips[i], i, false);
  }
  for (const std::string& name : names) add_named(model, all_tips, name);
  if (outputs_.empty())
    throw InputError("no hinge of the scene moves freely and no body has a tip: nothing to measure");
}

Outputs Outputs::all(const Model& model) {
  Outputs outputs;
  for (std::size_t h = 0; h < model.hinges().size(); ++h) outputs.add_hinge(model, h);
  const std::vector<Tip> all_tips = tips(model);
  for (std::size_t i = 0; i < all_tips.size(); ++i) outputs.add_tip(all_tips[i], i, false);
  return outputs;
}

void Outputs::add_named(const Model& model, const std::vector<Tip>& tips, const std::string& name) {
  const std::size_t before = outputs_.size();
  if (const int h = model.hinge(name); h >= 0) add_hinge(model, static_cast<std::size_t>(h));
  for (std::size_t i = 0; i < tips.size(); ++i) {
    if (name == tip_name(tips[i], false)) add_tip(tips[i], i, false);
    if (name == tip_name(tips[i], true) && tips[i].flexible) add_tip(tips[i], i, true);
  }
  if (outputs_.size() == before)
    throw InputError("outputs: got '" + name + "'; need one of: " + known_names(model, tips));
}

void Outputs::add(Output output) {
  output.at = size_;
  size_ += numbers_of(output.shape);
  outputs_.push_back(std::move(output));
}

void Outputs::add_tip(const Tip& tip, std::size_t index, bool deflection) {
  add({tip_name(tip, deflection), deflection ? Measure::deflection : Measure::place, Output::Shape::vector, index});
}

void Outputs::add_hinge(const Model& model, std::size_t hinge) {
  const HingeNode& node = model.hinges()[hinge];
  const auto kernel = node.hinge->kernel();
  const bool free = kernel && kernel->kind == HingeKernel::Kind::free;
  if (free || (kernel && kernel->kind == HingeKernel::Kind::spherical)) {
    add({node.name, Measure::angle, Output::Shape::orientation, hinge});
    if (free) add({node.name, Measure::slide, Output::Shape::vector, hinge, 4});
    return;
  }
  const auto columns = coordinate_columns(node);
  for (std::size_t c = 0; c < columns.size(); ++c)
    add({node.name, columns[c].unit == "m" ? Measure::slide : Measure::angle, Output::Shape::number, hinge, c});
}

std::vector<std::string> Outputs::names() const {
  std::vector<std::string> all;
  for (const Output& o : outputs_)
    if (all.empty() || all.back() != o.name) all.push_back(o.name);
  return all;
}

bool Outputs::has(Measure measure) const {
  return std::any_of(outputs_.begin(), outputs_.end(), [&](const Output& o) { return o.measure == measure; });
}

void Outputs::raise(std::span<const double> a, std::span<const double> b, Distances& greatest) const {
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    double d = distance(outputs_[i].shape, a.subspan(outputs_[i].at), b.subspan(outputs_[i].at));
    // A comparison with what is no number would pass.
    if (!std::isfinite(d)) d = std::numeric_limits<double>::infinity();
    greatest[i] = std::max(greatest[i], d);
  }
}

PerMeasure Outputs::per_measure(const Distances& distances) const {
  PerMeasure most{};
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    double& m = most.at(static_cast<std::size_t>(outputs_[i].measure));
    m = std::max(m, distances[i]);
  }
  return most;
}

OutputReader::OutputReader(const Outputs& outputs, const Model& model, const EquationsOfMotion& equations)
    : outputs_(outputs), model_(model), seen_(equations.make_observation()), tips_(tips(model)) {}

std::vector<double> OutputReader::read(std::span<const double> y) {
  std::vector<double> values;
  values.reserve(outputs_.size());
  seen_->observe(y);
  for (const Output& o : outputs_.list()) {
    if (o.measure == Measure::place) {
      const auto p = seen_->frame_pose(tips_[o.index].tip.body, tips_[o.index].tip.frame).position;
      values.insert(values.end(), p.begin(), p.end());
    } else if (o.measure == Measure::deflection) {
      const auto d = deflection(*seen_, tips_[o.index]);
      values.insert(values.end(), d.begin(), d.end());
    } else {
      const auto x = y.subspan(model_.layout().hinges[o.index].position + o.coordinate, numbers_of(o.shape));
      values.insert(values.end(), x.begin(), x.end());
    }
  }
  return values;
}

double NamedDistances::greatest_hinge() const { return greatest(hinges); }
double NamedDistances::greatest_tip() const { return greatest(tips); }

NamedDistances named(const Outputs& outputs, const Distances& distances, double until) {
  NamedDistances d;
  d.until = until;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const Output& o = outputs.list()[i];
    const bool hinge = o.measure == Measure::angle || o.measure == Measure::slide;
    double& most = (hinge ? d.hinges : d.tips)[o.name];
    most = std::max(most, distances[i]);
  }
  return d;
}

}  // namespace withy::study
