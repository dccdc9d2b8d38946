/// \file
/// The JSON Schema of plans, for editors.
#pragma once

#include <string>

namespace withy::campaign {

/// Draft 2020-12.
std::string plan_schema();

}  // namespace withy::campaign
