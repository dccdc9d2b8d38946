#include "withy/core/simulation/motion_stiffness.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "withy/core/shape/section_fields.hpp"
#include "withy/core/simulation/elastic_modes.hpp"

namespace withy {
namespace {

constexpr std::size_t relative_motion = motion_terms - 2, of_loads = motion_terms - 1;

/// Σ m (a − g) of mass m with first moment s about the body frame's origin, under a unit of one of the twelve terms.
Vector3 unit_force(std::size_t term, double m, const Vector3& s) {
  switch (term) {
    case 0:
      return {0, -s.y(), -s.z()};
    case 1:
      return {-s.x(), 0, -s.z()};
    case 2:
      return {-s.x(), -s.y(), 0};
    case 3:
      return {s.y(), s.x(), 0};
    case 4:
      return {0, s.z(), s.y()};
    case 5:
      return {s.z(), 0, s.x()};
    case 6:
    case 7:
    case 8:
      return Vector3::Unit(static_cast<Eigen::Index>(term - 6)).cross(s);
    default:
      return m * Vector3::Unit(static_cast<Eigen::Index>(term - 9));
  }
}

/// The gradient of a field acts as products of rates do, which make any symmetric matrix, and as ω̇, which makes the
/// antisymmetric ones.
std::array<double, 12> term_values(const BodyMotion& B) {
  const Vector3 w = B.R.transpose() * B.rate, a = B.R.transpose() * B.acceleration;
  const Matrix3 G = B.R.transpose() * B.gradient * B.R;
  const Vector3 turn(G(2, 1) - G(1, 2), G(0, 2) - G(2, 0), G(1, 0) - G(0, 1));
  const Vector3 e = B.R.transpose() * B.spin_up - 0.5 * turn, d = 0.5 * G.diagonal();
  const Vector3 squares(d.y() + d.z() - d.x(), d.z() + d.x() - d.y(), d.x() + d.y() - d.z());
  const auto mixed = [&G](Eigen::Index i, Eigen::Index j) { return 0.5 * (G(i, j) + G(j, i)); };
  return {w.x() * w.x() + squares.x(),
          w.y() * w.y() + squares.y(),
          w.z() * w.z() + squares.z(),
          w.x() * w.y() - mixed(0, 1),
          w.y() * w.z() - mixed(1, 2),
          w.z() * w.x() - mixed(2, 0),
          e.x(),
          e.y(),
          e.z(),
          a.x(),
          a.y(),
          a.z()};
}

Eigen::MatrixXd along(const std::array<Eigen::MatrixXd, 3>& gamma, const Vector3& force) {
  return force.x() * gamma[0] + force.y() * gamma[1] + force.z() * gamma[2];
}

Eigen::MatrixXd reduced(const Eigen::MatrixXd& K, const Eigen::MatrixXd& S) { return S.transpose() * K * S; }

/// The rotations that a hinge does not leave free in its reference pose, in the axes of its frame M; all where a motion
/// drives it.
Matrix3 held_rotations(const Model& model, std::size_t hinge) {
  const Hinge& h = *model.hinges()[hinge].hinge;
  if (h.speeds() == 0 || model.driven(hinge)) return Matrix3::Identity();
  std::vector<double> x(h.coordinates()), rates(h.speeds());
  h.reference(x);
  HingeMotion motion;
  motion.H.resize(6, static_cast<Eigen::Index>(h.speeds()));
  h.motion(x, rates, motion);
  constexpr double least = 1e-9;  // of an axis that is none beside those before it
  Matrix3 held = Matrix3::Identity();
  for (Eigen::Index k = 0; k < motion.H.cols(); ++k) {
    const Vector3 axis = motion.H.col(k).head<3>();
    const Vector3 rest = held * axis;
    if (rest.norm() > least * axis.norm()) held -= rest * rest.transpose() / rest.squaredNorm();
  }
  return held;
}

bool same_root(const std::optional<HeldSection>& a, const std::optional<HeldSection>& b) {
  if (!a || !b) return !a && !b;
  return a->held == b->held && same_section(a->at, b->at);
}

}  // namespace

std::optional<HeldSection> held_root(const Model& model, std::size_t body) {
  const HingeNode& hinge = model.hinges()[body];
  const Frame& frame = model.bodies()[body].frames[static_cast<std::size_t>(hinge.child_frame)];
  HeldSection root{frame.section, frame.pose.R * held_rotations(model, body) * frame.pose.R.transpose()};
  if (root.leaves_all()) return {};
  return root;
}

std::string motion_term_name(std::size_t term) {
  static constexpr std::array<const char*, motion_terms> names = {"wx wx",
                                                                  "wy wy",
                                                                  "wz wz",
                                                                  "wx wy",
                                                                  "wy wz",
                                                                  "wz wx",
                                                                  "dwx/dt",
                                                                  "dwy/dt",
                                                                  "dwz/dt",
                                                                  "dvx/dt - gx",
                                                                  "dvy/dt - gy",
                                                                  "dvz/dt - gz",
                                                                  "motion of outboard bodies",
                                                                  "loads at frames"};
  return names.at(term);
}

MotionStiffness::Own::Own(const ModalShape& shape, const HeldSection* root) {
  const ElasticModes modes = elastic_modes(shape);
  if (modes.frequencies.size() == 0) return;
  S = modes.vectors * modes.frequencies.cwiseInverse().asDiagonal();
  std::vector<PointExpansion> seen;
  for (std::size_t k = 0; root != nullptr && k < shape.particles.size(); ++k)
    seen.push_back(root->seen(shape.particles[k].at));
  for (std::size_t term = 0; term < motion.size(); ++term) {
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(shape.modes(), shape.modes());
    for (std::size_t k = 0; k < shape.particles.size(); ++k) {
      const Particle& p = shape.particles[k];
      K += along(root != nullptr ? seen[k].gamma : p.at.gamma, unit_force(term, p.mass, p.mass * p.at.X));
    }
    motion[term] = reduced(K, S);
  }
  total.setZero(S.cols(), S.cols());
  solver = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(S.cols());
}

MotionStiffness::MotionStiffness(const Model& model, std::size_t body, const MotionStiffness* twin)
    : body_(body), root_(held_root(model, body)) {
  if (twin != nullptr && !same_root(root_, twin->root_)) twin = nullptr;
  own_ = twin != nullptr ? twin->own_
                         : std::make_shared<Own>(model.bodies()[body].body->shape(), root_ ? &*root_ : nullptr);
  if (own_->S.size() == 0) return;
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const HingeNode& hinge = model.hinges()[h];
    if (hinge.parent == static_cast<int>(body))
      stations_.push_back({h, 1, section_of(model, hinge.parent_frame, twin)});
    if (h == body) stations_.push_back({h, -1, section_of(model, hinge.child_frame, twin)});
  }
  std::size_t index = 0;
  for (const LoadNode& node : model.loads()) {
    for (const FrameIndex& at : node.load->frames()) {
      if (at.body == static_cast<int>(body) && at.frame >= 0)
        loaded_.push_back({index, section_of(model, at.frame, twin)});
      ++index;
    }
  }
}

std::shared_ptr<const MotionStiffness::Section> MotionStiffness::section_of(const Model& model, int frame,
                                                                            const MotionStiffness* twin) const {
  const PointExpansion& at = model.bodies()[body_].frames[static_cast<std::size_t>(frame)].section;
  for (const MotionStiffness* const known : {this, twin}) {
    if (known == nullptr) continue;
    for (const Station& s : known->stations_)
      if (same_section(s.section->at, at)) return s.section;
    for (const Loaded& l : known->loaded_)
      if (same_section(l.section->at, at)) return l.section;
  }
  return made(at);
}

std::shared_ptr<const MotionStiffness::Section> MotionStiffness::made(const PointExpansion& at) const {
  const std::array<Eigen::MatrixXd, 3> gamma = seen(at).gamma;
  const auto stiffness = [&](std::size_t axis) { return reduced(gamma[axis], own_->S); };
  return std::make_shared<const Section>(Section{at, {stiffness(0), stiffness(1), stiffness(2)}});
}

MotionStiffness::MotionStiffness(const Model& model, const Body& whole, const std::vector<int>& segments)
    : body_(static_cast<std::size_t>(segments.front())), own_(std::make_shared<Own>(whole.shape(), nullptr)) {
  if (own_->S.size() == 0) return;
  const auto place_of = [&](FrameIndex at) -> std::optional<double> {
    double x = 0;
    for (const int b : segments) {
      const BodyNode& node = model.bodies()[static_cast<std::size_t>(b)];
      if (b == at.body) return x + node.frames[static_cast<std::size_t>(at.frame)].section.X.x();
      x += node.body->shape().length;
    }
    return {};
  };
  const auto section = [&](double x) {
    const auto at = whole.station(std::min(x, whole.shape().length));  // lengths of segments add up but for rounding
    return at ? made(*at) : nullptr;
  };
  for (std::size_t h = 0; h < model.hinges().size(); ++h) {
    const HingeNode& hinge = model.hinges()[h];
    const bool inside = std::find(segments.begin(), segments.end(), static_cast<int>(h)) != segments.end();
    const auto outboard = inside || hinge.parent < 0 ? std::nullopt : place_of({hinge.parent, hinge.parent_frame});
    if (outboard)
      if (auto at = section(*outboard)) stations_.push_back({h, 1, std::move(at)});
  }
  std::size_t index = 0;
  for (const LoadNode& node : model.loads()) {
    for (const FrameIndex& at : node.load->frames()) {
      const auto x = at.body >= 0 && at.frame >= 0 ? place_of(at) : std::nullopt;
      if (x)
        if (auto loaded = section(*x)) loaded_.push_back({index, std::move(loaded)});
      ++index;
    }
  }
}

PointExpansion MotionStiffness::seen(const PointExpansion& at) const { return root_ ? root_->seen(at) : at; }

LoadRatio MotionStiffness::evaluate(const std::vector<BodyMotion>& bodies, std::span<const Wrench> loads) {
  LoadRatio ratio;
  Eigen::MatrixXd& total = own_->total;
  if (total.size() == 0) return ratio;
  const std::array<Eigen::MatrixXd, 12>& own = own_->motion;
  const BodyMotion& B = bodies[body_];
  const auto values = term_values(B);
  total.setZero();
  for (std::size_t k = 0; k < own.size(); ++k) total += values[k] * own[k];
  const auto add = [&total](const Vector3& force, const Section& section) {
    for (Eigen::Index c = 0; c < 3; ++c) total += force[c] * section.stiffness[static_cast<std::size_t>(c)];
  };
  const auto loaded = loads.empty() ? std::span<const Loaded>() : std::span<const Loaded>(loaded_);
  for (const Station& s : stations_) {
    const BodyMotion& carried = bodies[s.carried];
    add(s.sign * (B.R.transpose() * (carried.force - carried.load)), *s.section);
  }
  for (const Loaded& l : loaded) add(-(B.R.transpose() * loads[l.load].force), *l.section);
  own_->solver.compute(total);
  const Eigen::Index last = total.rows() - 1;
  ratio.least = own_->solver.eigenvalues()[0];
  ratio.greatest = own_->solver.eigenvalues()[last];
  // Eigenvalues are known to rounding of the greatest of them.
  const double rounding = static_cast<double>(total.rows()) * std::numeric_limits<double>::epsilon();
  ratio.stiffens = ratio.greatest * (1 - rounding) > -ratio.least;
  const auto v = own_->solver.eigenvectors().col(ratio.stiffens ? last : 0);
  // vᵀ K v without a temporary.
  const auto work = [&v](const Eigen::MatrixXd& K) {
    double sum = 0;
    for (Eigen::Index i = 0; i < v.size(); ++i) {
      for (Eigen::Index j = 0; j < v.size(); ++j) sum += v[i] * K(i, j) * v[j];
    }
    return sum;
  };
  const auto works_of = [&work](const Section& section) {
    return Vector3(work(section.stiffness[0]), work(section.stiffness[1]), work(section.stiffness[2]));
  };
  for (std::size_t k = 0; k < own.size(); ++k) ratio.shares[k] = values[k] * work(own[k]);
  for (const Station& s : stations_) {
    const BodyMotion& carried = bodies[s.carried];
    const Vector3 force = s.sign * (B.R.transpose() * carried.force);
    const Vector3 moment = B.R.transpose() * (carried.mass_moment - carried.mass * B.p);
    const Vector3 works = works_of(*s.section);
    ratio.shares[relative_motion] += force.dot(works);
    ratio.shares[of_loads] -= s.sign * (B.R.transpose() * carried.load).dot(works);
    for (std::size_t k = 0; k < own.size(); ++k) {
      const double share = s.sign * values[k] * unit_force(k, carried.mass, moment).dot(works);
      ratio.shares[k] += share;
      ratio.shares[relative_motion] -= share;
    }
  }
  for (const Loaded& l : loaded)
    ratio.shares[of_loads] -= (B.R.transpose() * loads[l.load].force).dot(works_of(*l.section));
  return ratio;
}

}  // namespace withy
