#include "withy/study/unfit.hpp"

#include <stdexcept>

#include "withy/core/model/compiled_model.hpp"

namespace withy::study {

std::vector<Unfit> take_out_unfit(const std::shared_ptr<const Model>& model, Registry& registry,
                                  std::vector<std::string>& formulations) {
  std::vector<std::string> fit;
  std::vector<Unfit> unfit;
  for (const std::string& formulation : formulations) {
    try {
      static_cast<void>(compile_model(*make_formulation(registry, formulation), model));
      fit.push_back(formulation);
    } catch (const std::invalid_argument& e) {
      unfit.push_back({formulation, e.what()});
    }
  }
  if (fit.empty()) return {};
  formulations = std::move(fit);
  return unfit;
}

std::vector<std::string> usual_formulations(const std::shared_ptr<const Model>& model, Registry& registry,
                                            std::vector<Unfit>& left_out) {
  std::vector<std::string> usual = {"ruthless", "inconsistent", "consistent", "quadratic"};
  left_out = take_out_unfit(model, registry, usual);
  return usual;
}

}  // namespace withy::study
