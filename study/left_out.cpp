#include "withy/study/left_out.hpp"

#include <fmt/format.h>

#include <vector>

#include "withy/core/plugin/formulation.hpp"

namespace withy::study {
namespace {

/// What a formulation does not know.
std::string left_out(const Terms& terms) {
  switch (terms.truncation) {
    case Truncation::ruthless:
      return "every product of an elastic coordinate or rate with the rigid motion: stiffening and softening by "
             "rotation "
             "and load, foreshortening, change of inertia by deflection";
    case Truncation::strict:
      return terms.strain == StrainOrder::linear
                 ? "second-order kinematics, and all beyond the first order of elastic coordinates and rates"
                 : "all beyond the first order of elastic coordinates and rates, and that order in the columns of the "
                   "mass matrix that belong to modes";
    case Truncation::symmetric:
      return terms.strain == StrainOrder::linear ? "second-order kinematics, and all beyond the first order of the "
                                                   "kinetic energy in the elastic coordinates"
                                                 : "all beyond the first order of the kinetic energy in the elastic "
                                                   "coordinates, stiffening by rotation too: what a hinge lets flap "
                                                   "softens as it spins";
    case Truncation::none:
      break;
  }
  if (terms.strain == StrainOrder::linear)
    return "second-order kinematics: foreshortening, and with it stiffening and buckling by axial load";
  if (terms.strain == StrainOrder::quadratic) return "the third and higher orders of deflection";
  return "extension along beams and shear, where no strain is given for them";
}

}  // namespace

std::string left_out(const ModelAt& model) {
  if (!flexible(model.prepared->model())) return "nothing: no body is flexible";
  const std::string text = left_out(model.prepared->scene.formulation->terms());
  if (model.point.bodies.empty()) return text;
  std::vector<std::string> bodies;
  for (const auto& [body, formulation] : model.point.bodies) bodies.push_back(body);
  const Terms least{StrainOrder::linear, Truncation::ruthless};  // bodies have no other formulation of their own
  return fmt::format("{}; of {} {}", text, fmt::join(bodies, ", "), left_out(least));
}

}  // namespace withy::study
