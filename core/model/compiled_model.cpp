#include "withy/core/model/compiled_model.hpp"

#include <stdexcept>
#include <utility>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/plugin_call.hpp"

namespace withy {

std::unique_ptr<EquationsOfMotion> compile_model(const Formulation& formulation, std::shared_ptr<const Model> model) {
  std::unique_ptr<EquationsOfMotion> equations =
      plugin_call("it cannot compile the model", [&] { return formulation.compile(std::move(model)); });
  if (equations == nullptr) throw std::invalid_argument("it compiles no equations and does not say why");
  return equations;
}

}  // namespace withy
