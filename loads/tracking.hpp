/// \file
/// What a load tells that keeps coordinates of hinges on trajectories: its efforts, tracking errors, and how far it is
/// from its limits.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "withy/core/plugin/load_numbers.hpp"
#include "withy/loads/followed_hinges.hpp"

namespace withy {

/// A load that follows trajectories. Its numbers are, one a coordinate that it follows: `command`, the effort; `error`,
/// x_r − x; and `margin` where the effort is limited. Of several they have the hinge's name: `error.elbow`.
class TrackingLoad : public BoundLoad, public LoadNumbers, public CourseOfTime {
 public:
  /// \param names of the rates along `axes`
  TrackingLoad(const Model& model, const std::vector<RateName>& names, std::vector<FollowedAxis> axes);

  std::vector<SensorColumn> numbers() const override { return numbers_; }
  void show(const LoadView& view, std::span<double> values) const noexcept override;
  std::vector<double> discontinuities() const override { return jumps_of(axes_); }
  double end() const override { return end_of(axes_); }
  std::size_t courses() const override {
    std::size_t count = 0;
    for (const FollowedAxis& axis : axes_) count += courses_of(axis.trajectory);
    return count;
  }
  void course(double t, std::span<double> values) const noexcept override {
    for (const FollowedAxis& axis : axes_) {
      const std::size_t count = courses_of(axis.trajectory);
      course_of(axis.trajectory, t, values.first(count));
      values = values.subspan(count);
    }
  }

  /// Sets the effort on each followed coordinate [N m, N]. \param scratch as of `add`
  virtual void commands(double t, std::span<const double> positions, std::span<const double> speeds,
                        std::span<double> values, std::span<double> scratch) const noexcept = 0;
  [[nodiscard]] const std::vector<FollowedAxis>& axes() const { return axes_; }
  /// Sets the tracking error of each axis, then what is asked for on each that has a limit: smooth in the state. Of
  /// these `finish` makes the numbers that stand behind the commands.
  void tell(double t, std::span<const double> positions, std::span<const double> speeds,
            std::span<double> values) const noexcept;
  /// Makes margins of what is asked for.
  void finish(std::span<double> values) const noexcept;

 protected:
  /// Adds `margin` to the numbers of the axes whose effort has a limit [N m, N]; infinite: none.
  void add_limits(std::vector<double> limits);
  /// The effort that would be without limit [N m, N], of an axis that has one.
  [[nodiscard]] virtual double demand(std::size_t /*axis*/, double /*t*/, std::span<const double> /*positions*/,
                                      std::span<const double> /*speeds*/) const noexcept {
    return 0;
  }

 private:
  std::vector<FollowedAxis> axes_;
  std::vector<std::string> suffixes_;  ///< of the names of numbers, one an axis
  std::vector<std::string> units_;     ///< of the efforts
  std::vector<double> limits_;         ///< empty: none
  std::vector<SensorColumn> numbers_;
};

inline TrackingLoad::TrackingLoad(const Model& model, const std::vector<RateName>& names,
                                  std::vector<FollowedAxis> axes)
    : axes_(std::move(axes)) {
  for (const RateName& name : names) {
    const auto of_hinge = [&](const RateName& other) { return other.hinge == name.hinge; };
    const bool several = std::count_if(names.begin(), names.end(), of_hinge) > 1;
    suffixes_.push_back(names.size() == 1 ? ""
                                          : '.' + name.hinge + (several ? '.' + std::to_string(name.component) : ""));
    const HingeNode& hinge = model.hinges()[static_cast<std::size_t>(model.hinge(name.hinge))];
    units_.emplace_back(hinge_rates(*hinge.hinge)[name.component].angular ? "N m" : "N");
  }
  for (std::size_t i = 0; i < names.size(); ++i) numbers_.push_back({"command" + suffixes_[i], units_[i]});
  for (std::size_t i = 0; i < names.size(); ++i)
    numbers_.push_back({"error" + suffixes_[i], units_[i] == "N" ? "m" : "rad"});
}

inline void TrackingLoad::add_limits(std::vector<double> limits) {
  limits_ = std::move(limits);
  for (std::size_t i = 0; i < limits_.size(); ++i)
    if (limits_[i] < std::numeric_limits<double>::infinity()) numbers_.push_back({"margin" + suffixes_[i], units_[i]});
}

inline void TrackingLoad::show(const LoadView& view, std::span<double> values) const noexcept {
  const std::size_t count = axes_.size();
  commands(view.t, view.positions(), view.speeds(), values.first(count), view.scratch);
  tell(view.t, view.positions(), view.speeds(), values.subspan(count));
  finish(values.subspan(count));
}

inline void TrackingLoad::tell(double t, std::span<const double> positions, std::span<const double> speeds,
                               std::span<double> values) const noexcept {
  std::size_t next = 0;
  for (const FollowedAxis& axis : axes_) values[next++] = at(axis.trajectory, t).position - positions[axis.position];
  for (std::size_t i = 0; i < limits_.size(); ++i)
    if (limits_[i] < std::numeric_limits<double>::infinity()) values[next++] = demand(i, t, positions, speeds);
}

inline void TrackingLoad::finish(std::span<double> values) const noexcept {
  std::size_t next = axes_.size();
  for (const double limit : limits_) {
    if (!(limit < std::numeric_limits<double>::infinity())) continue;
    values[next] = limit - std::abs(values[next]);
    ++next;
  }
}

}  // namespace withy
