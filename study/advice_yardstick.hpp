/// \file
/// What the models of an advice are measured against. The numbers of that search are in advice_yardstick.cpp, with what
/// they mean.
#pragma once

#include "withy/study/advice.hpp"

namespace withy::study {

/// Looks for a reference that is exact enough for that accuracy, in its share of the evaluator's time. Sets the
/// advice's yardstick, or else its trouble and nearest; all of them where only runs that are near the reference can
/// hold the accuracy; and whether the user ended the search. \param finding may be
/// empty
std::vector<Reference> find_yardstick(Evaluator& evaluator, const Candidates& candidates, const Accuracy& accuracy,
                                      Advice& advice, const Finding& finding);

}  // namespace withy::study
