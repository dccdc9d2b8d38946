#include "withy/study/output_reader.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace withy::study {

OutputReader::OutputReader(const Outputs& outputs, const Model& model, const EquationsOfMotion& equations,
                           std::vector<SensorNode> sensors)
    : outputs_(outputs),
      model_(model),
      equations_(equations),
      seen_(equations.make_observation()),
      tips_(measured_ends(model)),
      work_(0) {
  const auto by_sensor = [](const Output& o) { return o.measure == Measure::sensor && !o.is_rate; };
  if (std::any_of(outputs.list().begin(), outputs.list().end(), by_sensor)) {
    sensors_.emplace(std::move(sensors), equations);
    sensed_.resize(sensors_->columns().size());
  }
  if (!outputs.has(Measure::moment) && !outputs.has(Measure::force)) return;
  work_ = equations.make_work();
  efforts_.resize(model.layout().speeds);
}

void OutputReader::Course::note(double t, double value) {
  if (!begun) {
    begun = true;
    from = time = t;
    first = last = least = greatest = value;
    return;
  }
  integral += 0.5 * (t - time) * (last + value);
  square += 0.5 * (t - time) * (last * last + value * value);
  time = t, last = value;
  // What is no number stays: comparisons with it would pass over it.
  least = value < least || std::isnan(value) ? value : least;
  greatest = value > greatest || std::isnan(value) ? value : greatest;
}

double OutputReader::Course::result(Output::Shape over) const {
  const double span = time - from;
  switch (over) {
    case Output::Shape::least:
      return least;
    case Output::Shape::greatest:
      return greatest;
    case Output::Shape::mean:
      return span > 0 ? integral / span : last;
    case Output::Shape::rms:
      return span > 0 ? std::sqrt(square / span) : std::abs(last);
    case Output::Shape::integral:
      return integral;
    default:
      return last;
  }
}

double OutputReader::Course::range(Output::Shape over) const {
  return std::max(greatest - first, first - least) * (over == Output::Shape::integral ? time - from : 1);
}

std::span<const double> OutputReader::rates_of(std::span<const double> y, std::size_t hinge) const {
  const Slot& slot = model_.layout().hinges[hinge];
  return y.subspan(model_.layout().positions + slot.speed, slot.speeds);
}

std::vector<double> OutputReader::read(const State& state) {
  const std::span<const double> y(state.y);
  std::vector<double> values;
  values.reserve(outputs_.size());
  seen_->observe(y);
  if (!efforts_.empty() && !equations_.motion_efforts(state.time, y, efforts_, work_).ok())
    std::fill(efforts_.begin(), efforts_.end(), std::numeric_limits<double>::quiet_NaN());
  if (sensors_ && !sensors_->read(state, sensed_))
    std::fill(sensed_.begin(), sensed_.end(), std::numeric_limits<double>::quiet_NaN());
  courses_.resize(outputs_.list().size());
  for (std::size_t i = 0; i < outputs_.list().size(); ++i) {
    const Output& o = outputs_.list()[i];
    switch (o.measure) {
      case Measure::sensor: {
        const std::span<const double> shown = o.is_rate ? rates_of(y, o.index) : std::span<const double>(sensed_);
        if (o.over_a_run()) {
          courses_[i].note(state.time, shown[o.coordinate]);
          values.insert(values.end(), {courses_[i].result(o.shape), courses_[i].range(o.shape)});
          break;
        }
        const auto numbers = shown.subspan(o.coordinate, o.numbers());
        values.insert(values.end(), numbers.begin(), numbers.end());
        break;
      }
      case Measure::place: {
        const auto p = seen_->frame_pose(tips_[o.index].tip.body, tips_[o.index].tip.frame).position;
        values.insert(values.end(), p.begin(), p.end());
        break;
      }
      case Measure::deflection: {
        const auto d = deflection(*seen_, tips_[o.index]);
        values.insert(values.end(), d.begin(), d.end());
        break;
      }
      case Measure::moment:
      case Measure::force:
        values.push_back(efforts_[model_.layout().hinges[o.index].speed + o.coordinate]);
        break;
      case Measure::angle:
      case Measure::slide: {
        const auto x = y.subspan(model_.layout().hinges[o.index].position + o.coordinate, o.numbers());
        values.insert(values.end(), x.begin(), x.end());
        break;
      }
    }
  }
  return values;
}

}  // namespace withy::study
