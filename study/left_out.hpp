/// \file
/// What a model does not know, in words.
#pragma once

#include <string>

#include "withy/study/walk.hpp"

namespace withy::study {

/// "the third and higher orders of deflection"; with single bodies that know less.
std::string left_out(const ModelAt& model);

}  // namespace withy::study
