/// \file
/// The certificate of a run in words.
#pragma once

#include <string>

#include "withy/study/certificate.hpp"

namespace withy {

/// The certificate in plain words, ending its last line.
std::string certificate_text(const Model& model, const RunSummary& summary, const study::Certificate& certificate);
/// "link1: 2 bending_y clamped-free": families are named after the ends they are made for, the root's first.
std::string families_text(const std::vector<study::BodyFamilies>& families);
/// How a run stands against the limits of its formulation: the nearest, or which it has passed; empty where there is
/// none.
std::string limits_text(const std::vector<study::Indicator>& indicators);
/// "limited by accuracy: mean step times fastest mode 0.11, stable to 1.73".
std::string step_limit_text(const study::StepLimit& s);

}  // namespace withy
