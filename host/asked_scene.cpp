#include "withy/host/asked_scene.hpp"

#include <utility>

#include "withy/scene/asked_outputs.hpp"

namespace withy::host {

std::shared_ptr<const study::Prepared> with_outputs(const Scene& scene, const std::vector<std::string>& names) {
  std::shared_ptr<const study::Prepared> base = scene.prepare();
  if (names.empty()) return base;
  SceneValues values = base->values;
  ask_outputs(values, names);
  return std::make_shared<const study::Prepared>(study::prepare(std::move(values), scene.library().registry()));
}

}  // namespace withy::host
