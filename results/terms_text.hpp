/// \file
/// The sizes of terms along a run in words.
#pragma once

#include <string>

#include "withy/study/term_study.hpp"

namespace withy {

/// A row a term, in per cent of the greatest on the same coordinates; then what each formulation leaves out.
std::string terms_text(const std::string& title, const Scene& scene, const RunSummary& summary,
                       const study::TermSizes& sizes);

/// The tables alone.
std::string terms_tables(const study::TermSizes& sizes);

}  // namespace withy
