/// \file
/// Formulations that a scene's model cannot be in.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "withy/study/prepared.hpp"

namespace withy::study {

struct Unfit {
  std::string formulation, reason;
};

/// Takes from the list the formulations that cannot treat the model (strict ones of closed loops), and says why;
/// nothing where none would be left. \throws InputError where there is no such formulation; PluginError
std::vector<Unfit> take_out_unfit(const std::shared_ptr<const Model>& model, Registry& registry,
                                  std::vector<std::string>& formulations);

/// What a comparison is of where nobody says it: of ruthless, inconsistent, consistent and quadratic those that can
/// treat the scene's model and that its integrator can treat. \param left_out gets the others
std::vector<std::string> usual_formulations(const Scene& scene, Registry& registry, std::vector<Unfit>& left_out);

}  // namespace withy::study
