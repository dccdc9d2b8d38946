#include "withy/core/simulation/carried_frequency.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "withy/core/simulation/elastic_modes.hpp"

namespace withy {
namespace {

// From the bodies' own first modes the first quotient is within a few per cent; errors fall by (ω₁/ω₂)⁴ each time.
constexpr int first_iterations = 8, iterations = 2;

}  // namespace

CarriedFrequency::Stiffness CarriedFrequency::stiffness_of(const ModalShape& shape) {
  const ElasticModes own = elastic_modes(shape);
  const Eigen::LLT<Eigen::MatrixXd> factors(shape.stiffness);
  Stiffness s;
  s.stiff = own.frequencies.size() == shape.modes() && factors.info() == Eigen::Success;
  if (own.frequencies.size() > 0) s.frequency = own.frequencies[0];
  if (!s.stiff) return s;
  s.stiffness = shape.stiffness;
  s.flexibility = factors.solve(Eigen::MatrixXd::Identity(shape.modes(), shape.modes()));
  s.first_mode = own.vectors.col(0);
  return s;
}

CarriedFrequency::CarriedFrequency(const Model& model, const EquationsOfMotion& equations)
    : equations_(equations),
      group_of_(model.bodies().size(), -1),
      shape_(model.layout().speeds, 0.0),
      product_(model.layout().speeds) {
  Eigen::Index most = 0;
  std::vector<int> inherited(model.bodies().size(), -1);  // group of the nearest flexible body inboard
  std::unordered_map<const Body*, std::shared_ptr<const Stiffness>> known;
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const int parent = model.hinges()[b].parent;
    inherited[b] = parent < 0 ? -1 : inherited[static_cast<std::size_t>(parent)];
    const ModalShape& shape = model.bodies()[b].body->shape();
    if (shape.modes() == 0) continue;
    if (inherited[b] < 0) {
      inherited[b] = static_cast<int>(groups_.size());
      groups_.emplace_back();
    }
    group_of_[b] = inherited[b];
    Group& group = groups_[static_cast<std::size_t>(group_of_[b])];
    std::shared_ptr<const Stiffness>& own = known[model.bodies()[b].body.get()];
    if (own == nullptr) own = std::make_shared<const Stiffness>(stiffness_of(shape));
    group.stiff = group.stiff && own->stiff;
    if (own->frequency > 0)
      group.frequency = group.frequency > 0 ? std::min(group.frequency, own->frequency) : own->frequency;
    const std::size_t at = model.layout().modes(b)->speed;
    if (group.stiff) {
      group.parts.push_back({at, own});
      for (Eigen::Index i = 0; i < shape.modes(); ++i) shape_[at + static_cast<std::size_t>(i)] = own->first_mode[i];
      most = std::max(most, shape.modes());
    }
  }
  q_.resize(most);
}

void CarriedFrequency::update(std::span<const double> y, Work& work) {
  // Strict formulations assemble M for a product: there the configuration at the start has to do.
  if (begun_ && equations_.linearly_implicit() == nullptr) return;
  for (int i = begun_ ? iterations : first_iterations; i > 0; --i) iterate(y, work);
  begun_ = true;
}

/// Rayleigh's quotient of the present shape, then the next shape, of unit strain energy ½ in each group.
void CarriedFrequency::iterate(std::span<const double> y, Work& work) {
  equations_.mass_times(y, shape_, product_, work);
  for (Group& group : groups_) {
    if (!group.stiff) continue;
    double strain = 0, mass = 0, next_strain = 0;
    for (const Part& p : group.parts) {
      const Stiffness& modal = *p.modal;
      const Eigen::Index n = modal.stiffness.rows();
      const Eigen::Map<Eigen::VectorXd> x(shape_.data() + p.speed, n);
      const Eigen::Map<const Eigen::VectorXd> Mx(product_.data() + p.speed, n);
      for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j) strain += x[i] * modal.stiffness(i, j) * x[j];
      mass += x.dot(Mx);
      q_.head(n).noalias() = modal.flexibility * Mx;
      next_strain += q_.head(n).dot(Mx);
    }
    if (!(mass > 0) || !(next_strain > 0)) continue;  // a truncated mass matrix need not be positive
    group.frequency = std::sqrt(strain / mass);
    for (const Part& p : group.parts) {
      const Stiffness& modal = *p.modal;
      const Eigen::Index n = modal.stiffness.rows();
      const Eigen::Map<const Eigen::VectorXd> Mx(product_.data() + p.speed, n);
      Eigen::Map<Eigen::VectorXd> x(shape_.data() + p.speed, n);
      x.noalias() = modal.flexibility * Mx;
      x /= std::sqrt(next_strain);
    }
  }
}

}  // namespace withy
