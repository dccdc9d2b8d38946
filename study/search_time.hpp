/// \file
/// Where searches take the CPU time from that they share out and compare models by.
#pragma once

#include <cstddef>

namespace withy::study {

struct Prepared;

/// The processor's time is not the same twice, and its ratios differ from machine to machine. A time that counts
/// evaluations in its place makes a search find the same everywhere.
class SearchTime {
 public:
  virtual ~SearchTime() = default;
  /// CPU time of this thread [s].
  [[nodiscard]] virtual double now() const = 0;
  /// CPU time of one evaluation of the equations at the initial state [s].
  [[nodiscard]] virtual double of_evaluation(const Prepared& model) const = 0;
  /// Is told that stepping has evaluated the equations so often since it was last told.
  virtual void evaluated(const Prepared& model, std::size_t count) = 0;
};

/// The one of this thread: the processor's, where no other is in its place.
SearchTime& search_time();

/// While this lives, searches of this thread take another time.
class SearchTimeInPlace {
 public:
  /// \param time must outlive this
  explicit SearchTimeInPlace(SearchTime& time);
  ~SearchTimeInPlace();
  SearchTimeInPlace(const SearchTimeInPlace&) = delete;
  SearchTimeInPlace& operator=(const SearchTimeInPlace&) = delete;

 private:
  SearchTime* before_;
};

}  // namespace withy::study
