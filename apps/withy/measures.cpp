#include "withy/apps/withy/measures.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "withy/apps/withy/engine.hpp"
#include "withy/core/model/columns.hpp"
#include "withy/core/simulation/tips.hpp"
#include "withy/scene/units.hpp"

namespace withy::app {
namespace {

constexpr double least_distance = 1e-9;  // rad or m; what outputs that stand still may move by

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(' ');
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

Eigen::Quaterniond quaternion(std::span<const double> v) {
  return Eigen::Quaterniond(v[0], v[1], v[2], v[3]).normalized();
}

}  // namespace

const char* measure_name(std::size_t measure) {
  constexpr std::array<const char*, measures> names = {"angle", "slide", "place", "deflection"};
  return names.at(measure);
}

const char* measure_unit(std::size_t measure) { return measure == 0 ? "rad" : "m"; }

Accuracy Accuracy::parse(const std::string& text) {
  Accuracy a;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string part = trimmed(text.substr(begin, end - begin));
    begin = end + 1;
    std::optional<double> value = plain_number(part);
    std::optional<double>* kind = &a.share;
    if (!value) {
      value = read_quantity(part, "1").value;
      if (!value && (value = read_quantity(part, "m").value)) kind = &a.length;
      if (!value && (value = read_quantity(part, "rad").value)) kind = &a.angle;
    }
    if (!value)
      throw InputError("--accuracy: got '" + part + "'; need a share as 1%, a length as 2mm or an angle as 0.1deg");
    if (*kind) throw InputError("--accuracy: '" + text + "' says the same twice");
    if (!(*value > 0) || (kind == &a.share && *value > 1))
      throw InputError(
          fmt::format("--accuracy: got '{}'; need above 0{}", part, kind == &a.share ? ", at most 1" : ""));
    *kind = value;
  }
  return a;
}

PerMeasure Accuracy::limits(const PerMeasure& ways) const {
  PerMeasure limits{};
  for (std::size_t m = 0; m < measures; ++m) {
    const std::optional<double>& distance = m == static_cast<std::size_t>(Measure::angle) ? angle : length;
    limits[m] = std::numeric_limits<double>::infinity();
    if (distance) limits[m] = *distance;
    if (share) limits[m] = std::min(limits[m], std::max(*share * ways[m], least_distance));
  }
  return limits;
}

std::string Accuracy::text() const {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (share) add(fmt::format("{:.4g} %", 100 * *share));
  if (length) add(fmt::format("{:.4g} mm", 1e3 * *length));
  if (angle) add(fmt::format("{:.4g} deg", *angle * 180 / std::numbers::pi));
  return text;
}

MeasuredOutputs::MeasuredOutputs(const Model& model, const std::vector<std::string>& names) {
  const std::vector<Tip> all_tips = tips(model);
  const auto add_tip = [&](std::size_t i, bool deflection) {
    add({all_tips[i].body + (deflection ? ".tip.deflection" : ".tip"),
         deflection ? Measure::deflection : Measure::place, Shape::vector, i, 0, 0});
  };
  for (std::size_t h = 0; names.empty() && h < model.hinges().size(); ++h)
    if (!model.driven(h)) add_hinge(model, h);
  for (std::size_t i = 0; names.empty() && i < all_tips.size(); ++i) add_tip(i, false);
  std::vector<std::string> known;
  for (std::size_t h = 0; h < model.hinges().size(); ++h)
    if (model.layout().hinges[h].positions > 0) known.push_back(model.hinges()[h].name);
  for (const Tip& tip : all_tips) {
    known.push_back(tip.body + ".tip");
    if (tip.flexible) known.push_back(tip.body + ".tip.deflection");
  }
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      std::string list;
      for (const std::string& k : known) list += (list.empty() ? "" : ", ") + k;
      throw InputError("--output: got '" + name + "'; need one of: " + list);
    }
    if (const int h = model.hinge(name); h >= 0) add_hinge(model, static_cast<std::size_t>(h));
    for (std::size_t i = 0; i < all_tips.size(); ++i) {
      if (name == all_tips[i].body + ".tip") add_tip(i, false);
      if (name == all_tips[i].body + ".tip.deflection") add_tip(i, true);
    }
  }
  if (outputs_.empty())
    throw InputError("no hinge of the scene moves freely and no body has a tip: nothing to measure");
}

void MeasuredOutputs::add(Output output) {
  constexpr std::array<std::size_t, 3> numbers = {1, 3, 4};
  output.at = size_;
  size_ += numbers.at(static_cast<std::size_t>(output.shape));
  outputs_.push_back(std::move(output));
}

void MeasuredOutputs::add_hinge(const Model& model, std::size_t hinge) {
  const HingeNode& node = model.hinges()[hinge];
  const auto kernel = node.hinge->kernel();
  const bool free = kernel && kernel->kind == HingeKernel::Kind::free;
  if (free || (kernel && kernel->kind == HingeKernel::Kind::spherical)) {
    add({node.name, Measure::angle, Shape::orientation, hinge, 0, 0});
    if (free) add({node.name, Measure::slide, Shape::vector, hinge, 4, 0});
    return;
  }
  const auto columns = coordinate_columns(node);
  for (std::size_t c = 0; c < columns.size(); ++c)
    add({columns[c].name, columns[c].unit == "m" ? Measure::slide : Measure::angle, Shape::number, hinge, c, 0});
}

std::vector<std::string> MeasuredOutputs::names() const {
  std::vector<std::string> all;
  for (const Output& o : outputs_)
    if (all.empty() || all.back() != o.name) all.push_back(o.name);
  return all;
}

bool MeasuredOutputs::has(Measure measure) const {
  return std::any_of(outputs_.begin(), outputs_.end(), [&](const Output& o) { return o.measure == measure; });
}

void MeasuredOutputs::read(const Model& model, const EquationsOfMotion& equations, std::span<const double> y,
                           std::vector<double>& values) const {
  const std::vector<Tip> all_tips = tips(model);
  for (const Output& o : outputs_) {
    std::array<double, 3> v{};
    if (o.measure == Measure::place) {
      v = equations.frame_pose(y, all_tips[o.index].tip.body, all_tips[o.index].tip.frame).position;
    } else if (o.measure == Measure::deflection) {
      v = deflection(equations, y, all_tips[o.index]);
    } else {
      const std::size_t first = model.layout().hinges[o.index].position + o.coordinate;
      const std::size_t count = o.shape == Shape::number ? 1 : (o.shape == Shape::vector ? 3 : 4);
      for (std::size_t i = 0; i < count; ++i) values.push_back(y[first + i]);
      continue;
    }
    values.insert(values.end(), v.begin(), v.end());
  }
}

void MeasuredOutputs::compare(std::span<const double> a, std::span<const double> b, PerMeasure& greatest) const {
  for (const Output& o : outputs_) {
    const auto p = a.subspan(o.at), q = b.subspan(o.at);
    double d = 0;
    if (o.shape == Shape::number) d = std::abs(p[0] - q[0]);
    if (o.shape == Shape::vector) d = std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
    if (o.shape == Shape::orientation) d = quaternion(p).angularDistance(quaternion(q));
    // A comparison with what is no number would pass.
    if (!std::isfinite(d)) d = std::numeric_limits<double>::infinity();
    double& most = greatest[static_cast<std::size_t>(o.measure)];
    most = std::max(most, d);
  }
}

}  // namespace withy::app
