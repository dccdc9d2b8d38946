/// \file
/// What a sweep keeps over time as a picture: bands that shares of the cases lie in.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "withy/campaign/plan.hpp"
#include "withy/results/svg_plot.hpp"

namespace withy::campaign {

/// Least, 5, 25, 50, 75 and 95 %, greatest.
inline constexpr std::array<double, 7> shares_of_histories = {0, 0.05, 0.25, 0.5, 0.75, 0.95, 1};

/// "bodies.rod.mass = 1.5, integrator.name = rk4": numbers with the digits that people read.
/// \param values of these paths; nothing where the cases of a point differ
std::string title_of_point(const std::vector<std::string>& paths, const CaseValues& values);

/// A panel a result and a point of the grids, of the first dozen, which the title says where there are more; another
/// about the median where the bands are narrow beside its way.
class HistoriesPicture {
 public:
  explicit HistoriesPicture(std::string title);
  /// Numbers at a time, as shares_of_histories; times of a result and a point come one after the other.
  /// \param at what the cases of the point share, as title_of_point() tells it; empty where they share nothing
  void add(std::uint64_t point, const std::string& at, const std::string& name, double t,
           std::span<const double> numbers);
  [[nodiscard]] std::string svg() const;

 private:
  Picture picture_;
  std::string last_;       ///< result and point
  std::size_t asked_ = 0;  ///< pairs of these
  bool full_ = false;
};

}  // namespace withy::campaign
