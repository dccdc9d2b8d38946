/// \file
/// What is kept of a case over time: columns at times that all cases share.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace withy::campaign {

/// What a plan asks for.
struct HistoryPlan {
  std::vector<std::string> of;  ///< names, as of `final`
  double every = 0;             ///< [s]; 0: as the scene's outputs
  std::vector<double> times;    ///< [s]
};
/// From the start of a run to its end, which both are among them. \param every above 0 [s]
std::vector<double> history_times(double start, double end, double every);
inline constexpr std::size_t most_history_times = 10'000;
inline constexpr std::size_t most_history_numbers = 1'000'000;  ///< of a case

/// Takes the rows of one run and keeps columns of them at the times, between rows linearly.
class Histories {
 public:
  /// \param columns of a row; the times must outlive it
  Histories(std::vector<std::size_t> columns, const std::vector<double>& times)
      : columns_(std::move(columns)), times_(&times) {}
  [[nodiscard]] bool any() const { return !columns_.empty(); }
  /// A row at a time that is not before that of the last.
  void enter(double t, std::span<const double> row);
  /// Column by column, time by time; not a number at times that the run, which is over, has not come to.
  [[nodiscard]] std::vector<double> numbers() const;

 private:
  std::vector<std::size_t> columns_;
  const std::vector<double>* times_;
  std::vector<double> kept_;  ///< time by time
  std::vector<double> last_;  ///< of the columns
  double last_t_ = 0;
};

}  // namespace withy::campaign
