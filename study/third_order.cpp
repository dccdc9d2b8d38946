#include "withy/study/third_order.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "withy/study/indicators.hpp"

namespace withy::study {

double third_order_share(const Bend& bend) { return bend.size() * bend.size(); }

double third_order_over_a_run(const Bend& bend) {
  constexpr double growth = 10;
  return growth * third_order_share(bend);
}

std::optional<Bend> greatest_bend(const RunSummary& summary) {
  if (summary.peak_deflection_ratio.empty()) return {};
  Bend most;
  for (const BodyValidity& body : summary.validity.bodies)
    if (const auto bend = greatest_bend(body, summary); bend && bend->size() > most.size()) most = *bend;
  return most;
}

std::string third_order_text(const Bend& bend) {
  const double share = 100 * third_order_share(bend);
  return fmt::format("about {} % of it at an instant where {}",
                     share < 99.5 ? fmt::format("{:.2g}", share) : fmt::format("{:.0f}", share),
                     bend.bent() && bend.by_angle()
                         ? fmt::format("a section of a bent body is turned by {:.2g} rad", bend.angle)
                         : fmt::format("it is {:.2g} of a body's length", bend.deflection));
}

std::string bend_text(const Bend& bend) {
  if (bend.bent() && bend.by_angle()) return fmt::format("sections of a bent body that turn by {:.2g} rad", bend.angle);
  return fmt::format("deflections of {:.2g} of a body's length", bend.deflection);
}

std::string without_exact_kinematics(const Model& model) {
  std::vector<std::string> names;
  for (const BodyNode& node : model.bodies()) {
    if (node.body->shape().modes() == 0 || node.body->rod() != nullptr) continue;
    if (node.segment && node.segment->index > 0) continue;
    names.push_back(node.scene_name());
  }
  return names.empty() ? "" : fmt::format("'{}'", fmt::join(names, "', '"));
}

ThirdOrder::ThirdOrder(const Prepared& model) : model_(model.model()) {
  for (Tip& end : measured_ends(model_)) {
    const BodyNode& body = model_.bodies()[static_cast<std::size_t>(end.tip.body)];
    const Terms terms = body.terms.value_or(model.scene.formulation->terms());
    if (!end.flexible || !(end.length > 0) || terms.strain == StrainOrder::exact) continue;
    if (!end.in_segments()) {
      ends_.push_back(std::move(end));
      continue;
    }
    for (const int b : model_.segments(end.body)) {
      const BodyNode& segment = model_.bodies()[static_cast<std::size_t>(b)];
      Tip own = end;
      own.root = {b, 0};
      own.tip = {b, segment.frame("tip")};
      own.length = segment.body->shape().length;
      ends_.push_back(std::move(own));
    }
  }
  if (!ends_.empty()) seen_ = model.equations->make_observation();
}

void ThirdOrder::look(const State& state) {
  if (ends_.empty()) return;
  seen_->observe(state.y);
  for (const Tip& end : ends_) {
    const auto d = withy::deflection(*seen_, end);
    const Bend now{std::hypot(d[0], d[1], d[2]) / end.length, section_angle(model_, state.y, end)};
    if (!(now.size() > bend_.size())) continue;
    bend_ = now;
    body_ = end.body;
  }
}

}  // namespace withy::study
