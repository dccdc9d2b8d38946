#include "withy/study/remedy.hpp"

#include "withy/core/simulation/renewal.hpp"

namespace withy::study {
namespace {

bool leaves_something_out(const Terms& terms) {
  return terms.strain == StrainOrder::linear || terms.truncation != Truncation::none || terms.kinematics != nullptr ||
         !terms.products_of_speeds;
}

bool has_modes(const Model& model) { return !model.layout().bodies.empty(); }

}  // namespace

std::string remedy_text(const Prepared& prepared, const RunSummary& summary) {
  const Terms terms = prepared.scene.formulation->terms();
  const bool bends = has_modes(prepared.model());
  switch (summary.status) {
    case RunStatus::completed:
    case RunStatus::interrupted:
      return {};
    case RunStatus::inaccurate:
      return " What to do: take shorter steps (a smaller 'step', or 'rtol' of an integrator that controls its error), "
             "or one that no vibration limits, as radau.";
    default:
      break;
  }
  // A law of its own that has failed has said why: the engine has nothing to add.
  if (!Renewal(prepared.model(), *prepared.equations).failure(summary.final).empty()) return {};
  if (bends && leaves_something_out(terms))
    return " What to do: run it with --formulation quadratic, which leaves out less; if that ends the same way it is "
           "the model and not the formulation.";
  if (summary.status == RunStatus::singular)
    return " What to do: look for a hinge that moves next to no inertia, or hinges that move the same (withy inspect).";
  if (summary.status == RunStatus::step_underflow)
    return " What to do: look at what acts at that time: a load that grows without end, a stop that is too stiff, a "
           "'rtol' below what the numbers hold.";
  return std::string(
             " What to do: run it with a tenth of 'rtol' or of the step. If it ends at the same time the motion "
             "itself grows: look at the loads, gains and stiffness named above (withy check") +
         (bends && terms.strain != StrainOrder::exact ? "; --formulation exact for large deflections)." : ").");
}

}  // namespace withy::study
