#include "withy/study/unfit.hpp"

#include <functional>
#include <stdexcept>

#include "withy/core/model/compiled_model.hpp"
#include "withy/core/simulation/integrator_call.hpp"

namespace withy::study {

namespace {

using Equations = std::shared_ptr<const EquationsOfMotion>;

/// Takes out those that cannot be compiled or whose equations `use` throws std::invalid_argument at.
std::vector<Unfit> take_out(const std::shared_ptr<const Model>& model, Registry& registry,
                            std::vector<std::string>& formulations, const std::function<void(const Equations&)>& use) {
  std::vector<std::string> fit;
  std::vector<Unfit> unfit;
  for (const std::string& formulation : formulations) {
    try {
      use(compile_model(*make_formulation(registry, formulation), model));
      fit.push_back(formulation);
    } catch (const std::invalid_argument& e) {
      unfit.push_back({formulation, e.what()});
    }
  }
  if (fit.empty()) return {};
  formulations = std::move(fit);
  return unfit;
}

}  // namespace

std::vector<Unfit> take_out_unfit(const std::shared_ptr<const Model>& model, Registry& registry,
                                  std::vector<std::string>& formulations) {
  return take_out(model, registry, formulations, [](const Equations&) {});
}

std::vector<std::string> usual_formulations(const Scene& scene, Registry& registry, std::vector<Unfit>& left_out) {
  std::vector<std::string> usual = {"ruthless", "inconsistent", "consistent", "quadratic"};
  left_out = take_out(scene.model, registry, usual, [&](const Equations& equations) {
    static_cast<void>(start_stepper(*scene.integrator, *equations, scene.initial));
  });
  return usual;
}

}  // namespace withy::study
