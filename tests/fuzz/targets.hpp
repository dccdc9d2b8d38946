/// \file
/// What is fuzzed: readers of files and texts that may come from anywhere, and sequences of calls.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace withy::fuzz {

/// Gives a reader some bytes, or lets them choose calls. An exception that is documented is an answer; any other goes
/// through, and is a finding as a crash is.
using Target = void (*)(std::string_view bytes);

/// By name, which is that of the folder of its corpus too.
const std::map<std::string, Target>& targets();

}  // namespace withy::fuzz
