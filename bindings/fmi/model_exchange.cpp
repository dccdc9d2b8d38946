#include "withy/bindings/fmi/model_exchange.hpp"

#include "withy/core/model/hosted_motion.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/refusals.hpp"

namespace withy::fmi {

void refuse_model_exchange(const study::Prepared& prepared) {
  study::refuse_loops(prepared, "the solver of a host of model exchange (--kind cs exports the scene with its own)");
  // Inputs of model exchange act at once, or continuously.
  for (const LoadNode& load : prepared.model().loads()) {
    const HostedMotion* motion = hosted_motion(*load.load);
    if (motion == nullptr || motion->jumps()) continue;
    throw study::InputError(prepared.scene.file + ": /motions/" + load.name +
                            ": a host of model exchange cannot prescribe a position or a rate; need 'sets: "
                            "acceleration', or --kind cs");
  }
}

}  // namespace withy::fmi
