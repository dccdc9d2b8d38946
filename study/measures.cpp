#include "withy/study/measures.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "withy/core/model/columns.hpp"
#include "withy/scene/names.hpp"
#include "withy/study/input_error.hpp"

namespace withy::study {
namespace {

/// Of its own unit of length or of a radian: what moves less hardly moves.
constexpr double hardly = 1e-3;

Eigen::Quaterniond quaternion(std::span<const double> v) {
  return Eigen::Quaterniond(v[0], v[1], v[2], v[3]).normalized();
}

std::string tip_name(const Tip& tip, bool deflection) {
  return tip.body + '.' + tip.station + (deflection ? ".deflection" : "");
}

/// Whether the place of an end in the world is looked at beside its deflection.
bool has_place(const Tip& tip) { return tip.station == "tip"; }

std::string effort_name(const HingeNode& hinge) { return hinge.name + ".motion_effort"; }

double longest_body(const Model& model) {
  double longest = 0;
  for (const BodyNode& body : model.bodies()) longest = std::max(longest, body.body->shape().length);
  for (const Tip& tip : measured_ends(model)) longest = std::max(longest, tip.length);
  return longest;
}

using Shape = Output::Shape;

/// q and −q are the same orientation.
double distance(Output::Shape shape, std::span<const double> a, std::span<const double> b) {
  switch (shape) {
    case Output::Shape::vector:
      return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    case Output::Shape::orientation:
      return quaternion(a).angularDistance(quaternion(b));
    default:
      return std::abs(a[0] - b[0]);
  }
}

/// Behind the name of a number: what it has been over the run.
constexpr std::array<std::pair<const char*, Shape>, 5> over_time = {{{".min", Shape::least},
                                                                     {".max", Shape::greatest},
                                                                     {".mean", Shape::mean},
                                                                     {".rms", Shape::rms},
                                                                     {".integral", Shape::integral}}};

/// The names that outputs may be asked for by.
std::vector<std::string> known_names(const Model& model, const std::vector<Tip>& tips,
                                     std::span<const SensorNode> sensors) {
  std::vector<std::string> list;
  const auto add = [&](const std::string& name) { list.push_back(name); };
  for (std::size_t h = 0; h < model.hinges().size(); ++h)
    if (model.layout().hinges[h].positions > 0) add(model.hinges()[h].name);
  for (const HingeNode& hinge : model.hinges())
    for (const Column& rate : rate_columns(hinge)) add(rate.name);
  for (const Tip& tip : tips) {
    if (has_place(tip)) add(tip_name(tip, false));
    if (tip.flexible) add(tip_name(tip, true));
  }
  for (std::size_t h = 0; h < model.hinges().size(); ++h)
    if (model.driven(h)) add(effort_name(model.hinges()[h]));
  for (const SensorNode& sensor : sensors)
    for (const Column& column : columns_of(sensor)) add(column.name);
  return list;
}

/// What stands where a name is none of an output: the nearest, or all.
std::string unknown_outputs(const std::vector<std::string>& names, const std::vector<std::string>& known) {
  std::string text, all;
  for (const std::string& name : names) {
    const std::string guess = nearest(name, known);
    text += (text.empty() ? "got '" : ", '") + name + '\'';
    if (guess.empty())
      all = "; need one of: " + listed(known) +
            "; or what it is, as HINGE.rate, HINGE.effort, FRAME.acceleration; behind the name of an output .min, "
            ".max, .mean, .rms or .integral";
    else
      text += names.size() == 1 ? "; did you mean '" + guess + "'?" : " (did you mean '" + guess + "'?)";
  }
  return text + all;
}

double greatest(const std::map<std::string, double>& values) {
  double most = 0;
  for (const auto& [name, value] : values) most = std::max(most, value);
  return most;
}

}  // namespace

const char* measure_name(std::size_t measure) {
  constexpr std::array<const char*, measures> names = {"angle",  "slide", "place", "deflection",
                                                       "moment", "force", "sensor"};
  return names.at(measure);
}

const char* measure_unit(std::size_t measure) {
  constexpr std::array<const char*, measures> units = {"rad", "m", "m", "m", "N m", "N", ""};
  return units.at(measure);
}

std::string unit_over_time(const std::string& unit) { return unit.empty() || unit == "1" ? "s" : unit + " s"; }

std::size_t Output::numbers() const {
  constexpr std::array<std::size_t, 8> numbers = {1, 3, 4, 2, 2, 2, 2, 2};
  return numbers.at(static_cast<std::size_t>(shape));
}

Outputs::Outputs(const Model& model, const std::vector<std::string>& names, std::span<const SensorNode> sensors)
    : length_(longest_body(model)) {
  const std::vector<Tip> all_tips = measured_ends(model);
  if (names.empty()) add_all(model, all_tips, false);
  std::vector<std::string> unknown;
  for (const std::string& name : names) {
    const std::size_t before = outputs_.size();
    add_named(model, all_tips, name, sensors);
    if (outputs_.size() == before) unknown.push_back(name);
  }
  if (!unknown.empty()) throw OptionError("outputs", unknown_outputs(unknown, known_names(model, all_tips, sensors)));
  if (outputs_.empty())
    throw InputError("no hinge of the scene moves, no body has a tip and none bends: nothing to measure");
}

Outputs Outputs::all(const Model& model) {
  Outputs outputs(longest_body(model));
  outputs.add_all(model, measured_ends(model), true);
  return outputs;
}

void Outputs::add_all(const Model& model, const std::vector<Tip>& tips, bool driven) {
  for (std::size_t h = 0; h < model.hinges().size(); ++h)
    if (driven || !model.driven(h)) add_hinge(model, h);
  for (std::size_t i = 0; i < tips.size(); ++i) {
    if (has_place(tips[i])) add_tip(tips[i], i, false);
    if (tips[i].flexible) add_tip(tips[i], i, true);
  }
  for (std::size_t h = 0; h < model.hinges().size(); ++h)
    if (model.driven(h)) add_effort(model, h);
}

void Outputs::add_named(const Model& model, const std::vector<Tip>& tips, const std::string& name,
                        std::span<const SensorNode> sensors) {
  const std::size_t before = outputs_.size();
  if (const int h = model.hinge(name); h >= 0) add_hinge(model, static_cast<std::size_t>(h));
  for (std::size_t i = 0; i < tips.size(); ++i) {
    if (name == tip_name(tips[i], false) && has_place(tips[i])) add_tip(tips[i], i, false);
    if (name == tip_name(tips[i], true) && tips[i].flexible) add_tip(tips[i], i, true);
  }
  for (std::size_t h = 0; h < model.hinges().size(); ++h)
    if (model.driven(h) && name == effort_name(model.hinges()[h])) add_effort(model, h);
  add_rates(model, name, sensors.size());
  add_sensors(name, sensors);
  for (const auto& [word, over] : over_time) {
    if (!name.ends_with(word) || outputs_.size() > before) continue;
    const std::string number = name.substr(0, name.rfind('.'));
    add_rates(model, number, sensors.size(), over);
    add_sensors(number, sensors, over);
  }
}

/// Of one column of a hinge's rates, or of all those of a name with numbers behind it.
void Outputs::add_rates(const Model& model, const std::string& name, std::size_t sensors, Output::Shape over) {
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const HingeNode& hinge = model.hinges()[h];
    const std::vector<Column> columns = rate_columns(hinge);
    for (std::size_t i = 0; i < columns.size() && name != hinge.name; ++i) {
      const std::string& column = columns[i].name;
      if (name != column && !column.starts_with(name + '.')) continue;
      Output o{.name = column, .measure = Measure::sensor, .index = h};
      o.coordinate = i;
      o.label = column, o.unit = columns[i].unit, o.is_rate = true, o.group = sensors + h;
      add_over(std::move(o), over);
    }
  }
}

/// What a number is, or has been over the run.
void Outputs::add_over(Output number, Output::Shape over) {
  if (over != Shape::number) {
    number.shape = over;
    for (const auto& [word, shape] : over_time)
      if (shape == over) number.label += word;
    number.name = number.label;
    if (over == Shape::integral) number.unit = unit_over_time(number.unit), number.floor = 0;
  }
  add(std::move(number));
}

void Outputs::add_sensors(const std::string& name, std::span<const SensorNode> sensors, Output::Shape over) {
  std::size_t first = 0;
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    const std::vector<Column> columns = columns_of(sensors[s]);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const bool whole = name == sensors[s].name;
      if (!whole && name != columns[i].name) continue;
      Output o{.name = sensors[s].name, .measure = Measure::sensor, .index = s, .coordinate = first + i};
      o.label = columns[i].name, o.unit = columns[i].unit, o.group = s;
      o.floor = o.unit == "rad" ? hardly : o.unit == "m" ? hardly * length_ : 0;
      if (over != Shape::number) {
        add_over(std::move(o), over);
        continue;
      }
      // Of a whole orientation the four numbers of its quaternion are one angle, and its three angles say the same.
      const std::string component = columns[i].name.substr(columns[i].name.rfind('.') + 1);
      if (whole && component == "qw") {
        o.shape = Output::Shape::orientation;
        o.label = sensors[s].name + ".orientation", o.unit = "rad";
        i += 6;
      }
      add(std::move(o));
    }
    first += columns.size();
  }
}

void Outputs::add(Output output) {
  if (output.label.empty()) output.label = output.name;
  if (output.unit.empty()) output.unit = measure_unit(static_cast<std::size_t>(output.measure));
  output.at = size_;
  size_ += output.numbers();
  outputs_.push_back(std::move(output));
}

void Outputs::add_tip(const Tip& tip, std::size_t index, bool deflection) {
  add({.name = tip_name(tip, deflection),
       .measure = deflection ? Measure::deflection : Measure::place,
       .shape = Output::Shape::vector,
       .index = index,
       .floor = hardly * (deflection ? tip.length : length_)});
}

void Outputs::add_hinge(const Model& model, std::size_t hinge) {
  const HingeNode& node = model.hinges()[hinge];
  const auto kernel = node.hinge->kernel();
  const bool free = kernel && kernel->kind == HingeKernel::Kind::free;
  if (free || (kernel && kernel->kind == HingeKernel::Kind::spherical)) {
    add({.name = node.name,
         .measure = Measure::angle,
         .shape = Output::Shape::orientation,
         .index = hinge,
         .floor = hardly,
         .label = node.name + (free ? ".angle" : "")});
    if (free)
      add({.name = node.name,
           .measure = Measure::slide,
           .shape = Output::Shape::vector,
           .index = hinge,
           .coordinate = 4,
           .floor = hardly * length_,
           .label = node.name + ".slide"});
    return;
  }
  const auto columns = coordinate_columns(node);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const bool slides = columns[c].unit == "m";
    add({.name = node.name,
         .measure = slides ? Measure::slide : Measure::angle,
         .index = hinge,
         .coordinate = c,
         .floor = hardly * (slides ? length_ : 1),
         .label = columns[c].name});
  }
}

void Outputs::add_effort(const Model& model, std::size_t hinge) {
  const HingeNode& node = model.hinges()[hinge];
  const std::vector<Column> columns = motion_effort_columns(node);
  for (std::size_t i = 0; i < columns.size(); ++i)
    add({.name = effort_name(node),
         .measure = columns[i].unit == "N m" ? Measure::moment : Measure::force,
         .index = hinge,
         .coordinate = i,
         .label = columns[i].name});
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
    greatest[i] = outputs_[i].over_a_run() ? d : std::max(greatest[i], d);
  }
}

void Outputs::raise_ranges(std::span<const double> values, std::span<const double> first, Distances& ranges) const {
  raise(values, first, ranges);
  for (std::size_t i = 0; i < outputs_.size(); ++i)
    if (outputs_[i].over_a_run()) ranges[i] = values[outputs_[i].at + 1];
}

PerMeasure Outputs::per_measure(const Distances& distances) const {
  PerMeasure most{};
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    double& m = most.at(static_cast<std::size_t>(outputs_[i].measure));
    m = std::max(m, distances[i]);
  }
  return most;
}

double NamedDistances::greatest_hinge() const { return greatest(hinges); }
double NamedDistances::greatest_tip() const { return greatest(tips); }

std::map<std::string, double>& NamedDistances::of(Measure measure) {
  switch (measure) {
    case Measure::place:
      return tips;
    case Measure::deflection:
      return deflections;
    case Measure::moment:
      return moments;
    case Measure::force:
      return forces;
    case Measure::sensor:
      return sensors;
    case Measure::angle:
    case Measure::slide:
      break;
  }
  return hinges;
}

NamedDistances named(const Outputs& outputs, const Distances& distances, double until) {
  NamedDistances d;
  d.until = until;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const Output& o = outputs.list()[i];
    double& most = d.of(o.measure)[o.measure == Measure::sensor ? o.label : o.name];
    most = std::max(most, distances[i]);
  }
  return d;
}

}  // namespace withy::study
