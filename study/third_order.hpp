/// \file
/// What kinematics of second order leaves out of a motion.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "withy/core/simulation/tips.hpp"
#include "withy/study/prepared.hpp"

namespace withy::study {

/// The share of ranges that terms of third order may have, at the place of a body where it bends most: (deflection over
/// length)² or, where that is more, the square of half the angle that the section there has turned by (Bend). The
/// product of a twist twice and a deflection is of third order as that of three deflections is.
double third_order_share(const Bend& bend);
/// What they may come to over a run: ten times that share. Where `exact` can tell, most motions are off by less and few
/// by more, by what runs apart in long vibrations and near buckling (table in docs/validity.md).
double third_order_over_a_run(const Bend& bend);
/// Where a run bent its bodies most; nothing where none bent.
std::optional<Bend> greatest_bend(const RunSummary& summary);
/// "about 0.14 % of it at an instant where it is 0.037 of a body's length": what terms of third order are of a
/// deflection.
std::string third_order_text(const Bend& bend);
/// "deflections of 0.11 of a body's length", "sections of a bent body that turn by 1.2 rad".
std::string bend_text(const Bend& bend);

/// Bodies with modes that have no exact kinematics: "'panel', 'strip'"; empty where all have.
std::string without_exact_kinematics(const Model& model);

/// The share is that of the body that bends most, of those whose kinematics is not exact; of bodies in segments each
/// segment is looked at by itself, for what lies between them is exact.
class ThirdOrder {
 public:
  /// The model must outlive the object.
  explicit ThirdOrder(const Prepared& model);
  /// At a state of the run.
  void look(const State& state);
  /// Where it was most so far.
  [[nodiscard]] const Bend& bend() const { return bend_; }
  /// The body that it was of, of a segment the whole; empty where none bent.
  [[nodiscard]] const std::string& body() const { return body_; }
  [[nodiscard]] double over_a_run() const { return third_order_over_a_run(bend_); }

 private:
  const Model& model_;
  std::vector<Tip> ends_;
  std::unique_ptr<Observation> seen_;
  Bend bend_;
  std::string body_;
};

}  // namespace withy::study
