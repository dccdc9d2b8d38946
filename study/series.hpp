/// \file
/// Where a series of runs leads to, each with a mode more than the one before, and how well that is known.
#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "withy/study/measures.hpp"
#include "withy/study/walk.hpp"

namespace withy::study {

/// Outputs of a run, with the difference between two others on top: a + (b − c); of orientations b c⁻¹ a. Over the
/// outputs that all have.
Readings corrected(const Outputs& outputs, const Readings& a, const Readings& b, const Readings& c);

/// What a series still has to go after a step d from n − 1 to n modes, over d, where each step is `ratio` times the one
/// before.
struct Tail {
  double geometric = 0;  ///< the steps go on shrinking so: ρ/(1 − ρ)
  /// They are those of C n⁻ᵖ, with the p that two of them tell: 1/((n/(n − 1))ᵖ − 1).
  double algebraic = 0;
};
/// The tails of a series whose last two steps are those from n − 2 to n − 1 and on to n modes. A series is taken to
/// converge like 1/n at least, as functions do that cannot carry the moment at a beam's tip, and as these do after the
/// first few: a greater ratio than that counts as (n − 2)/n, one below zero as zero, and there both are zero.
/// \param n at least 3; of steps of s modes each, modes over s
Tail tail(double n, double ratio);

/// How many modes more the next run of a series is to have: a mode, late in it a quarter of those that it has or less,
/// a power of two. Runs two and three such steps before the last are then there too. Each mode in turn would cost more
/// than twice as much, and say little: what steps of one mode differ by is lost in all else.
int next_step(int modes);

/// A series of runs whose number of modes grows from each to the next, by one or by next_step(): where their outputs
/// lead to, by Aitken's extrapolation of each output's whole history at once (Aitken 1926; of vectors: Irons & Tuck
/// 1969).
///
/// Of the steps d_n = u_n − u_(n−1) of an output, ρ is the least-squares ratio d_n ≈ ρ d_(n−1) over all times and
/// components; of an orientation, d is the rotation vector of u_n u_(n−1)⁻¹. Two laws fit two steps: a geometric series
/// and one like n⁻ᵖ, which has more to go. The limit is half-way between what the two lead to, and may be off by what
/// they are apart; on top comes what is left over, d_n − ρ d_(n−1), with the tail that its own size tells. Limits of a
/// row are not known better than what is left of their changes. Of a series of one law this is at least twice what the
/// limit is off. Late in a slow series two steps of a mode each are nearly equal, and what tells them apart is lost in
/// what else they differ by: the same is done with steps of a quarter of the modes, and of each output what is known
/// better counts. A slow part that a fast one hides is not seen: of beams with loaded tips in functions without a
/// moment there, at worst a third of the true distance was told, and too little in a quarter of the levels.
class ModeSeries {
 public:
  /// \param outputs must outlive it
  /// \param kinds of modes that come in turn (kinds_of_modes): of several no limit is told, and the last step of each
  /// kind counts as error. So too of runs without modes, that differ by their tolerance.
  ModeSeries(const Outputs& outputs, int kinds) : outputs_(outputs), kinds_(kinds) {}

  /// Adds the next run.
  /// \param modes of each family that a body has; 0: none has a number of them
  void add(int modes, Readings run);
  /// Runs so far.
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Where the series leads to: the last run, moved; as it is where nothing more is known.
  [[nodiscard]] const Readings& limit() const { return limit_; }
  /// That of the run before; of one run its own.
  [[nodiscard]] const Readings& limit_before() const { return limit_before_; }
  /// What the limit may be off by; empty: one run tells nothing.
  [[nodiscard]] const Distances& own() const { return own_; }
  /// Whether an output of the limit is not the last run's.
  [[nodiscard]] bool extrapolated() const { return extrapolated_; }

 private:
  /// An output's steps, a column a time; of numbers the first row alone.
  using Steps = Eigen::Matrix3Xd;
  /// Where steps of so many modes each lead to.
  struct Lead {
    Readings limit;
    Distances own;
    std::vector<bool> moved;  ///< of each output, whether its limit is not that of the last run
  };
  [[nodiscard]] bool has(int modes) const { return runs_.contains(modes); }
  [[nodiscard]] Steps steps(const Output& output, const Readings& to, const Readings& from) const;
  [[nodiscard]] double goes_on(int modes, int step, std::size_t output) const;
  [[nodiscard]] Lead lead(int modes, int step, std::map<int, Readings>& limits) const;
  void take(std::size_t output, const Lead& from, Lead& to) const;
  void extrapolate(int modes, int step, std::size_t output, Lead& lead) const;
  void add_changes_of_limits(int modes, int step, const std::map<int, Readings>& limits, Lead& lead) const;

  const Outputs& outputs_;
  int kinds_;
  std::size_t size_ = 0;
  std::map<int, Readings> runs_;  ///< by modes
  Readings last_;
  std::vector<Distances> changes_;                  ///< from run to run
  std::map<int, Readings> limits_, limits_of_far_;  ///< of the last steps and of steps of a quarter of the modes
  Readings limit_, limit_before_;
  Distances own_;
  bool extrapolated_ = false;
};

}  // namespace withy::study
