#include "withy/study/third_order.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace withy::study {

ThirdOrder::ThirdOrder(const Prepared& model) {
  for (Tip& end : measured_ends(model.model())) {
    const BodyNode& body = model.model().bodies()[static_cast<std::size_t>(end.tip.body)];
    const Terms terms = body.terms.value_or(model.scene.formulation->terms());
    if (end.flexible && !end.in_segments() && end.length > 0 && terms.strain != StrainOrder::exact)
      ends_.push_back(std::move(end));
  }
  if (!ends_.empty()) seen_ = model.equations->make_observation();
}

void ThirdOrder::look(const State& state) {
  if (ends_.empty()) return;
  seen_->observe(state.y);
  for (const Tip& end : ends_) {
    const auto d = withy::deflection(*seen_, end);
    deflection_ = std::max(deflection_, std::hypot(d[0], d[1], d[2]) / end.length);
  }
}

}  // namespace withy::study
