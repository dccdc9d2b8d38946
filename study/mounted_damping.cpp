#include "withy/study/mounted_damping.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "withy/core/analysis/modes.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/core/shape/vibrations.hpp"
#include "withy/scene/units.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/refusals.hpp"

namespace withy::study {
namespace {

using Eigen::Index;

constexpr const char* damping_origin = "damping of the mounted tree";
/// A ratio twice the common one costs as much as a mode that is 3 % off what is asked.
constexpr double weight_of_spread = 1e-3;

/// A body whose own modes can have ratios.
struct Damped {
  std::size_t body;
  std::string name;
  Index modes;
  std::vector<Eigen::MatrixXd> critical;  ///< damping matrix of ratio one in each own mode
};

std::vector<Damped> damped_bodies(const Prepared& prepared, Registry& registry) {
  std::vector<Damped> found;
  for (std::size_t b = 0; b < prepared.model().bodies().size(); ++b) {
    const BodyNode& node = prepared.model().bodies()[b];
    const Index modes = node.body->shape().modes();
    if (modes == 0) continue;
    if (node.segment)
      throw InputError("damping of the mounted tree: '" + node.segment->whole +
                       "' is in segments, which have no modes of the whole");
    const Value* kind = prepared.values.find("bodies." + node.name + ".type");
    const auto* plugin = kind != nullptr ? registry.find<Body>(kind->text()) : nullptr;
    if (plugin == nullptr) continue;
    const auto damping = std::find_if(plugin->parameters.begin(), plugin->parameters.end(),
                                      [](const ParameterSpec& spec) { return spec.key == "damping"; });
    if (damping != plugin->parameters.end()) found.push_back({b, node.name, modes, {}});
  }
  if (found.empty()) throw InputError("damping of the mounted tree: no body has modes and takes `damping`");
  return found;
}

Change ratios_of(const std::string& body, const std::vector<std::pair<Index, double>>& ratios) {
  std::vector<Value> rows;
  for (const auto& [mode, ratio] : ratios)
    rows.push_back(Value::list({Value(static_cast<double>(mode)), Value(ratio)}));
  return {"bodies." + body + ".damping", Value::map({{"ratios", Value::list(std::move(rows))}})};
}

/// The scene with no damping but that of one mode of each body; of none for mode 0.
Prepared with_one_mode(const Prepared& prepared, Registry& registry, const std::vector<Damped>& bodies, Index mode) {
  SceneValues values = prepared.values;
  for (const Damped& d : bodies) {
    values.set("bodies." + d.name + ".damping_ratio", Value(0.0), damping_origin);
    const bool on = mode > 0 && mode <= d.modes;
    const Change change = ratios_of(d.name, {{on ? mode : 1, on ? 1.0 : 0.0}});
    values.set(change.path, change.value, damping_origin);
  }
  return prepare(std::move(values), registry);
}

/// Undamped vibrations of all speeds, those that are held at rest; φᵀ M φ = 1.
struct MountedVibrations {
  Eigen::VectorXd frequencies;
  Eigen::MatrixXd shapes;
};

MountedVibrations mounted_vibrations(const Tangents& t, const Held& held, Index speeds, std::size_t count) {
  const std::vector<Index> free = free_speeds(held);
  const Eigen::MatrixXd M = t.mass(free, free), K = t.by_position(free, free);
  const Eigen::MatrixXd symmetric_K = 0.5 * (K + K.transpose()), symmetric_M = 0.5 * (M + M.transpose());
  if (Eigen::LLT<Eigen::MatrixXd>(symmetric_M).info() != Eigen::Success)
    throw std::domain_error("the mass matrix of what is free is not positive at this state");
  const Vibrations found = free.empty() ? Vibrations() : vibrations(symmetric_K, symmetric_M);
  const Eigen::VectorXd& squares = found.squares;
  if (squares.size() > 0 && squares.minCoeff() < 0 && !is_rounding(squares.minCoeff(), squares.cwiseAbs().maxCoeff()))
    throw std::domain_error("small motions about this state grow: what grows has no damping ratio");
  const Index rigid = found.rigid(), wanted = static_cast<Index>(count);
  if (squares.size() - rigid < wanted)
    throw InputError(fmt::format("{} ratios are asked, and the tree has {} vibrations", count, squares.size() - rigid));
  MountedVibrations v{squares.segment(rigid, wanted).cwiseSqrt(), Eigen::MatrixXd::Zero(speeds, wanted)};
  v.shapes(free, Eigen::all) = found.vectors.middleCols(rigid, wanted);
  return v;
}

/// The z ≥ 0 of least ½ zᵀ H z − gᵀ z, H positive definite (Lawson & Hanson 1974, their problem NNLS).
Eigen::VectorXd least_not_negative(const Eigen::MatrixXd& H, const Eigen::VectorXd& g) {
  Eigen::VectorXd z = Eigen::VectorXd::Zero(g.size());
  std::vector<Index> used;
  const double small = 1e-12 * g.cwiseAbs().maxCoeff();
  for (Index round = 0; round < 10 * g.size(); ++round) {
    Eigen::VectorXd slope = g - H * z;
    for (const Index i : used) slope[i] = 0;
    Index next = 0;
    if (!(slope.maxCoeff(&next) > small)) break;
    used.push_back(next);
    while (!used.empty()) {
      const Eigen::MatrixXd part = H(used, used);
      const Eigen::VectorXd wanted = part.llt().solve(g(used));
      if (wanted.minCoeff() > 0) {
        z(used) = wanted;
        break;
      }
      double reach = 1;
      for (std::size_t i = 0; i < used.size(); ++i) {
        const double w = wanted[static_cast<Index>(i)], at = z[used[i]];
        if (w <= 0) reach = std::min(reach, at / (at - w));
      }
      z(used) += reach * (wanted - z(used)).eval();
      std::erase_if(used, [&z](Index i) {
        if (z[i] > 0) return false;
        z[i] = 0;
        return true;
      });
    }
  }
  return z;
}

/// Ratios in the order of `bodies` and their modes. Row j of `shares` is what each gives mode j at one.
Eigen::VectorXd own_ratios(Eigen::MatrixXd shares, Eigen::VectorXd missing, const Eigen::VectorXd& asked) {
  for (Index j = 0; j < asked.size(); ++j) {
    shares.row(j) /= asked[j];
    missing[j] /= asked[j];
  }
  // The common ratio is that of the modes that miss something: one that loads brake by more needs none.
  const Eigen::VectorXd together = shares.rowwise().sum();
  const double alike = together.dot(missing.cwiseMax(0.0)) / together.squaredNorm();
  if (!(alike > 0)) return Eigen::VectorXd::Zero(shares.cols());
  Eigen::MatrixXd H = shares.transpose() * shares;
  Eigen::VectorXd g = shares.transpose() * missing;
  H.diagonal().array() += weight_of_spread / (alike * alike);
  g.array() += weight_of_spread / alike;
  return least_not_negative(H, g);
}

/// Of the vibrations of the tree with the changes, in the order of |λ|.
std::vector<double> reached_ratios(const Configuration& c, Registry& registry, const std::vector<Change>& changes,
                                   const Eigen::VectorXd& frequencies) {
  SceneValues values = c.prepared().values;
  for (const Change& change : changes) values.set(change.path, change.value, damping_origin);
  const Prepared damped = prepare(std::move(values), registry);
  const TangentDynamics dynamics(damped.scene.model, damped.scene.formulation->terms());
  const Tangents t = dynamics.tangents(c.state().time, c.state().y, accelerations(dynamics, c.state(), c.held()));
  std::vector<Mode> modes = natural_modes(t, c.held());
  std::erase_if(modes, [&](const Mode& m) {
    return m.rigid || m.single || std::sqrt(std::abs(m.squared_frequency())) < 1e-4 * frequencies[0];
  });
  std::sort(modes.begin(), modes.end(),
            [](const Mode& a, const Mode& b) { return a.squared_frequency() < b.squared_frequency(); });
  std::vector<double> ratios;
  for (Index j = 0; j < frequencies.size(); ++j) {
    const Mode& m = modes.at(static_cast<std::size_t>(j));
    ratios.push_back(-(m.eigenvalue + m.partner).real() / (2 * std::sqrt(std::abs(m.squared_frequency()))));
  }
  return ratios;
}

}  // namespace

MountedDamping mounted_damping(const Configuration& c, Registry& registry, const std::vector<double>& ratios) {
  refuse_loops(c.prepared(), "--damp");
  refuse_states_of_loads(c.prepared(), "--damp");
  std::vector<Damped> bodies = damped_bodies(c.prepared(), registry);
  Index most = 0, all = 0;
  for (const Damped& d : bodies) {
    most = std::max(most, d.modes);
    all += d.modes;
  }
  for (Index mode = 1; mode <= most; ++mode) {
    const Prepared one = with_one_mode(c.prepared(), registry, bodies, mode);
    for (Damped& d : bodies)
      if (mode <= d.modes) d.critical.push_back(one.model().bodies()[d.body].body->shape().damping);
  }
  const Prepared bare = with_one_mode(c.prepared(), registry, bodies, 0);
  const TangentDynamics dynamics(bare.scene.model, bare.scene.formulation->terms());
  const Tangents t = dynamics.tangents(c.state().time, c.state().y, accelerations(dynamics, c.state(), c.held()));
  const MountedVibrations v = mounted_vibrations(t, c.held(), static_cast<Index>(c.layout().speeds), ratios.size());

  const Eigen::VectorXd asked = Eigen::Map<const Eigen::VectorXd>(ratios.data(), static_cast<Index>(ratios.size()));
  Eigen::MatrixXd shares(asked.size(), all);
  Eigen::VectorXd missing = asked;
  MountedDamping result;
  for (Index j = 0; j < asked.size(); ++j) {
    const Eigen::VectorXd shape = v.shapes.col(j);
    const Eigen::VectorXd pushed = t.by_speed * shape;
    missing[j] -= shape.dot(pushed) / (2 * v.frequencies[j]);
    if (missing[j] < 0) result.beyond.push_back(static_cast<std::size_t>(j));
    Index column = 0;
    for (const Damped& d : bodies) {
      const Slot& slot = *c.layout().modes(d.body);
      const Eigen::VectorXd part = shape.segment(static_cast<Index>(slot.speed), d.modes);
      for (const Eigen::MatrixXd& critical : d.critical) {
        const Eigen::VectorXd force = critical * part;
        shares(j, column++) = part.dot(force) / (2 * v.frequencies[j]);
      }
    }
  }
  const Eigen::VectorXd found = own_ratios(shares, missing, asked);
  Index column = 0;
  for (const Damped& d : bodies) {
    std::vector<std::pair<Index, double>> own;
    for (Index mode = 1; mode <= d.modes; ++mode) own.emplace_back(mode, to_digits(found[column++], 4));
    result.changes.push_back(ratios_of(d.name, own));
    result.changes.push_back({"bodies." + d.name + ".damping_ratio", Value(0.0)});
  }
  const std::vector<double> reached = reached_ratios(c, registry, result.changes, v.frequencies);
  for (Index j = 0; j < asked.size(); ++j)
    result.modes.push_back({v.frequencies[j], asked[j], reached[static_cast<std::size_t>(j)]});
  return result;
}

std::vector<double> read_damping_ratios(const std::vector<std::string>& texts) {
  std::vector<double> ratios;
  for (const std::string& text : texts) {
    std::optional<double> ratio = plain_number(text);
    if (!ratio) ratio = read_quantity(text, "1").value;
    if (!ratio || !(*ratio > 0) || !(*ratio < 1))
      throw InputError("--damp takes ratios of critical damping between 0 and 1, as 0.01 or \"1 %\", and not '" + text +
                       "'");
    ratios.push_back(*ratio);
  }
  return ratios;
}

}  // namespace withy::study
