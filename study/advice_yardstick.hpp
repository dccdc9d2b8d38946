/// \file
/// What the models of an advice are measured against. The numbers of that search are in advice_yardstick.cpp, with what
/// they mean.
#pragma once

#include "withy/study/advice.hpp"

namespace withy::study {

/// Looks for a reference that is exact enough for that accuracy, in its share of the evaluator's time. Sets the
/// advice's yardstick, or else its trouble and nearest; all of them where only runs that are near the reference can
/// hold the accuracy; and whether the user ended the search. \param finding may be empty
std::vector<Reference> find_yardstick(Evaluator& evaluator, const Candidates& candidates, const Accuracy& accuracy,
                                      Advice& advice, const Finding& finding);

/// Goes on with that search until the reference is known so well, for as long as all has taken so far at most and no
/// longer than its share of the time. \param own as a share of the accuracy \param runs made so far \return whether
/// the advice's yardstick is now one that is better known
bool refine_yardstick(Evaluator& evaluator, const Candidates& candidates, const Accuracy& accuracy, Advice& advice,
                      const Finding& finding, double own, const std::vector<Reference>& runs);

}  // namespace withy::study
