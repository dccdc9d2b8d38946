#include "withy/core/simulation/motion_stiffness.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <limits>
#include <utility>

#include "withy/core/model/closing.hpp"
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

/// f·(θ × Φq) = θᵀ D q, and f·(θ × (θ × X)) = θᵀ E θ.
Matrix3X by_modes(const Vector3& force, const Matrix3X& phi) { return -skew<double>(force) * phi; }
Matrix3 by_turn(const Vector3& force, const Vector3& X) {
  const Matrix3 both = force * X.transpose();
  return 0.5 * (both + both.transpose()) - force.dot(X) * Matrix3::Identity();
}

/// Orthonormal columns z with bound · z = 0; rows that rounding leaves bind nothing.
Eigen::MatrixXd left_by(const Eigen::MatrixXd& bound) {
  constexpr double rounding = 1e-9;
  const Eigen::Index n = bound.cols();
  if (bound.rows() == 0 || bound.isZero(0)) return Eigen::MatrixXd::Identity(n, n);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(bound, Eigen::ComputeFullV);
  const Eigen::Index rank = (svd.singularValues().array() > rounding * svd.singularValues()[0]).count();
  return svd.matrixV().rightCols(n - rank);
}

/// Calls act(frame) for the frames of all loads, then for those of bodies that loops act on, in ClosedLoops' order.
template <class Act>
void each_loaded_frame(const Model& model, Act&& act) {
  for (const LoadNode& node : model.loads())
    for (const FrameIndex& at : node.load->frames()) act(at);
  for (const LoopClosure* loop : loops_of(model))
    for (const FrameIndex& at : {loop->a(), loop->b()})
      if (at.body >= 0) act(at);
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
    Matrix3X D = Matrix3X::Zero(3, shape.modes());
    Matrix3 E = Matrix3::Zero();
    for (std::size_t k = 0; k < shape.particles.size(); ++k) {
      const Particle& p = shape.particles[k];
      const PointExpansion& at = root != nullptr ? seen[k] : p.at;
      const Vector3 force = unit_force(term, p.mass, p.mass * p.at.X);
      K += along(at.gamma, force);
      D += by_modes(force, at.phi);
      E += by_turn(force, at.X);
    }
    motion[term] = reduced(K, S);
    turned[term] = D * S;
    twice[term] = E;
  }
  total.setZero(S.cols(), S.cols());
  buckled.setZero(S.cols());
  solver = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(S.cols());
}

/// The section from which fields are seen. In a loop LoopFollowing tells the turns of all hinges, along what they leave
/// free too: what modes turn the section by is no turn of a hinge.
std::optional<HeldSection> MotionStiffness::root_of(const Model& model, std::size_t body) {
  if (!in_loop(model, body)) return held_root(model, body);
  const auto frame = static_cast<std::size_t>(model.hinges()[body].child_frame);
  HeldSection root{model.bodies()[body].frames[frame].section};
  if (root.leaves_all()) return {};
  return root;
}

MotionStiffness::MotionStiffness(const Model& model, std::size_t body, const MotionStiffness* twin)
    : body_(body), root_(root_of(model, body)) {
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
  each_loaded_frame(model, [&](FrameIndex at) {
    if (at.body == static_cast<int>(body) && at.frame >= 0)
      loaded_.push_back({index, section_of(model, at.frame, twin)});
    ++index;
  });
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
  const PointExpansion from_root = seen(at);
  const auto stiffness = [&](std::size_t axis) { return reduced(from_root.gamma[axis], own_->S); };
  return std::make_shared<const Section>(
      Section{at, {stiffness(0), stiffness(1), stiffness(2)}, from_root.phi * own_->S});
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
  each_loaded_frame(model, [&](FrameIndex at) {
    const auto x = at.body >= 0 && at.frame >= 0 ? place_of(at) : std::nullopt;
    if (x)
      if (auto loaded = section(*x)) loaded_.push_back({index, std::move(loaded)});
    ++index;
  });
}

PointExpansion MotionStiffness::seen(const PointExpansion& at) const { return root_ ? root_->seen(at) : at; }

template <class Act>
void MotionStiffness::each_force(const std::vector<BodyMotion>& bodies, std::span<const Wrench> loads,
                                 Act&& act) const {
  const Matrix3 to_body = bodies[body_].R.transpose();
  for (const Station& s : stations_) {
    const BodyMotion& carried = bodies[s.carried];
    act(s.sign * (to_body * (carried.force - carried.load)), *s.section);
  }
  if (loads.empty()) return;
  for (const Loaded& l : loaded_) act(-(to_body * loads[l.load].force), *l.section);
}

void MotionStiffness::add_turning(const std::vector<BodyMotion>& bodies, std::span<const Wrench> loads,
                                  const Matrix3X& T) {
  const auto values = term_values(bodies[body_]);
  Matrix3X D = Matrix3X::Zero(3, T.cols());
  Matrix3 E = Matrix3::Zero();
  for (std::size_t k = 0; k < values.size(); ++k) {
    D += values[k] * own_->turned[k];
    E += values[k] * own_->twice[k];
  }
  each_force(bodies, loads, [&](const Vector3& force, const Section& section) {
    D += by_modes(force, section.phi);
    E += by_turn(force, section.at.X);
  });
  own_->total += T.transpose() * D + D.transpose() * T + T.transpose() * E * T;
}

void MotionStiffness::find_extremes(const Eigen::MatrixXd* bound, LoadRatio& ratio) {
  const Eigen::MatrixXd& total = own_->total;
  const auto take = [&](const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>& solver, const auto& to_modes) {
    const Eigen::Index last = solver.eigenvalues().size() - 1;
    ratio.least = solver.eigenvalues()[0];
    ratio.greatest = solver.eigenvalues()[last];
    // Eigenvalues are known to rounding of the greatest of them.
    const double rounding = static_cast<double>(total.rows()) * std::numeric_limits<double>::epsilon();
    ratio.stiffens = ratio.greatest * (1 - rounding) > -ratio.least;
    to_modes(solver.eigenvectors().col(ratio.stiffens ? last : 0));
  };
  const Eigen::MatrixXd free = bound != nullptr ? left_by(*bound * own_->S) : Eigen::MatrixXd();
  own_->buckled.setZero();
  if (bound == nullptr) {
    own_->solver.compute(total);
    take(own_->solver, [this](const auto& v) { own_->buckled = v; });
  } else if (free.cols() > 0) {
    const Eigen::MatrixXd of_free = free.transpose() * total * free;
    take(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(of_free), [&](const auto& v) { own_->buckled = free * v; });
  }
}

void MotionStiffness::find_shares(const std::vector<BodyMotion>& bodies, std::span<const Wrench> loads,
                                  const Vector3& turn, LoadRatio& ratio) const {
  const BodyMotion& B = bodies[body_];
  const auto values = term_values(B);
  const Eigen::VectorXd& v = own_->buckled;
  // vᵀ K v without a temporary.
  const auto work = [&v](const Eigen::MatrixXd& K) {
    double sum = 0;
    for (Eigen::Index i = 0; i < v.size(); ++i) {
      for (Eigen::Index j = 0; j < v.size(); ++j) sum += v[i] * K(i, j) * v[j];
    }
    return sum;
  };
  const auto works_of = [&](const Section& section) {
    Vector3 bent = Vector3::Zero();
    for (Eigen::Index i = 0; i < v.size(); ++i) bent += v[i] * section.phi.col(i);
    return Vector3(Vector3(work(section.stiffness[0]), work(section.stiffness[1]), work(section.stiffness[2])) +
                   2 * turn.cross(bent) + turn.cross(turn.cross(section.at.X)));
  };
  for (std::size_t k = 0; k < values.size(); ++k) {
    double sum = work(own_->motion[k]) + turn.dot(own_->twice[k] * turn);
    for (Eigen::Index i = 0; i < v.size(); ++i) sum += 2 * v[i] * turn.dot(own_->turned[k].col(i));
    ratio.shares[k] = values[k] * sum;
  }
  for (const Station& s : stations_) {
    const BodyMotion& carried = bodies[s.carried];
    const Vector3 force = s.sign * (B.R.transpose() * carried.force);
    const Vector3 moment = B.R.transpose() * (carried.mass_moment - carried.mass * B.p);
    const Vector3 works = works_of(*s.section);
    ratio.shares[relative_motion] += force.dot(works);
    ratio.shares[of_loads] -= s.sign * (B.R.transpose() * carried.load).dot(works);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double share = s.sign * values[k] * unit_force(k, carried.mass, moment).dot(works);
      ratio.shares[k] += share;
      ratio.shares[relative_motion] -= share;
    }
  }
  if (loads.empty()) return;
  for (const Loaded& l : loaded_)
    ratio.shares[of_loads] -= (B.R.transpose() * loads[l.load].force).dot(works_of(*l.section));
}

LoadRatio MotionStiffness::evaluate(const std::vector<BodyMotion>& bodies, std::span<const Wrench> loads,
                                    const LoopBound* loop) {
  LoadRatio ratio;
  Eigen::MatrixXd& total = own_->total;
  if (total.size() == 0) return ratio;
  const auto values = term_values(bodies[body_]);
  total.setZero();
  for (std::size_t k = 0; k < values.size(); ++k) total += values[k] * own_->motion[k];
  each_force(bodies, loads, [&total](const Vector3& force, const Section& section) {
    for (Eigen::Index c = 0; c < 3; ++c) total += force[c] * section.stiffness[static_cast<std::size_t>(c)];
  });
  Vector3 turn = Vector3::Zero();
  if (loop != nullptr) {
    const Matrix3X T = loop->turn * own_->S;
    add_turning(bodies, loads, T);
    find_extremes(&loop->bound, ratio);
    turn = T * own_->buckled;
  } else {
    find_extremes(nullptr, ratio);
  }
  find_shares(bodies, loads, turn, ratio);
  return ratio;
}

}  // namespace withy
