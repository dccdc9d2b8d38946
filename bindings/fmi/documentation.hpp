/// \file
/// documentation/index.html of an FMU.
#pragma once

#include <string>

#include "withy/bindings/fmi/model_description.hpp"

namespace withy::fmi {

/// A page with the model, how it is to be used, every variable, and the scene's text.
std::string documentation_page(const Description& description, const study::Prepared& prepared,
                               const Variables& variables);

}  // namespace withy::fmi
