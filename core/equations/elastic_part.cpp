#include "withy/core/equations/elastic_part.hpp"

namespace withy::equations {

ElasticPart::ElasticPart(const Model& model) : positions_(model.layout().positions) {
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const Slot* slot = model.layout().modes(b);
    if (slot == nullptr) continue;
    const ModalShape& shape = model.bodies()[b].body->shape();
    for (std::size_t i = 0; i < slot->speeds; ++i) {
      for (std::size_t j = 0; j < slot->speeds; ++j) {
        const auto row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(j);
        if (const double k = shape.stiffness(row, column); k != 0)
          springs_.push_back({slot->speed + i, slot->speed + j, slot->position + j, k});
        if (const double d = shape.damping(row, column); d != 0)
          dampers_.push_back({slot->speed + i, slot->speed + j, d});
      }
    }
  }
}

void ElasticPart::add_damping(std::span<const double> speeds, std::span<double> efforts, double sign) const noexcept {
  for (const Damper& d : dampers_) efforts[d.i] -= sign * d.value * speeds[d.j];
}

void ElasticPart::add_implicit(std::span<const double> y, std::span<const double> base, double delta, bool change,
                               std::span<double> forces) const noexcept {
  const double* u = base.data() + positions_;
  const double* speeds = y.data() + positions_;
  for (const Spring& k : springs_) forces[k.i] += k.value * (y[k.position] - base[k.position] - delta * u[k.j]);
  for (const Damper& d : dampers_) forces[d.i] -= d.value * (change ? u[d.j] - speeds[d.j] : u[d.j]);
}

void ElasticPart::add_coupling(std::span<const double> r, double delta, std::span<double> forces) const noexcept {
  const double* u = r.data() + positions_;
  for (const Spring& k : springs_) forces[k.i] += delta * k.value * (r[k.position] + delta * u[k.j]);
  for (const Damper& d : dampers_) forces[d.i] += delta * d.value * u[d.j];
}

}  // namespace withy::equations
