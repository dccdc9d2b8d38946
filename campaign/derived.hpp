/// \file
/// Values that follow from others of a case.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "withy/campaign/plan_reader.hpp"
#include "withy/campaign/trials.hpp"

namespace withy::campaign {

/// Reads `derived` of a plan whose axes are known, in its order: formulas may name what is derived before them. What is
/// wrong goes to the reader's diagnostics.
void read_derived(const Value& given, const PlanReader& reader, Plan& plan);
/// Whether every name is a number.
void check_derived(const Plan& plan, Problems& problems);

/// Nothing where a name is no number, which check_derived tells.
/// \param source checked values of the scene without what varies
/// \param values of the axes, and of what is derived before it
std::optional<double> value_of(const Derived& derived, const Value& source, const CaseValues& values);

/// The number at a path of the checked values of a scene, in SI units; nothing where there is none.
std::optional<double> number_at(const Value& source, const std::string& path);

/// Of the axes, then of what is derived: what a case has values for.
std::vector<std::string> varied_paths(const Plan& plan);

}  // namespace withy::campaign
