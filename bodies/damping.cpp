#include "damping.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "withy/core/shape/vibrations.hpp"

namespace withy {

bool BodyDamping::given(const Value& p) { return p.has("damping_ratio") || p.has("damping"); }

std::optional<BodyDamping> BodyDamping::read(const Value& p, Diagnostics& diagnostics) {
  constexpr double most = 1e9;  // beyond what any body has, and exact
  BodyDamping damping;
  if (p.has("damping_ratio")) damping.ratio = p.number_at("damping_ratio");
  const Value* const more = p.find("damping");
  if (more == nullptr) return damping;
  if (more->has("stiffness_proportional")) damping.stiffness_proportional = more->number_at("stiffness_proportional");
  if (!more->has("ratios")) return damping;
  bool good = true;
  for (const Value& row : more->at("ratios").items()) {
    const Value& mode = row.items()[0];
    const double number = mode.number();
    if (number >= 1 && number <= most && number == std::floor(number)) {
      damping.ratios[static_cast<int>(number)] = row.items()[1].number();
      continue;
    }
    diagnostics.error(mode.place(), fmt::format("got {}; need the number of a mode, a whole number from 1", number));
    good = false;
  }
  return good ? std::optional(damping) : std::nullopt;
}

namespace {

/// A mode of vibration: D of a ratio of one in it, 2 ω (G v)(G v)ᵀ, on the coordinates it moves.
struct OwnMode {
  double square;  ///< ω² [1/s²]
  const std::vector<Eigen::Index>* coordinates;
  Eigen::MatrixXd critical;
};

void add_modes(const Eigen::MatrixXd& K, const Eigen::MatrixXd& G, const std::vector<Eigen::Index>& group,
               std::vector<OwnMode>& modes) {
  if (group.size() == 1 || Eigen::LLT<Eigen::MatrixXd>(G(group, group)).info() != Eigen::Success) {
    for (const Eigen::Index i : group) {
      Eigen::MatrixXd critical =
          Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(group.size()), static_cast<Eigen::Index>(group.size()));
      const auto at = std::find(group.begin(), group.end(), i) - group.begin();
      critical(at, at) = 2 * std::sqrt(std::max(0.0, K(i, i) * G(i, i)));
      modes.push_back({K(i, i) / std::max(G(i, i), 1e-300), &group, std::move(critical)});
    }
    return;
  }
  const Eigen::MatrixXd inertia = G(group, group);
  const Vibrations found = vibrations(K(group, group), inertia);
  for (Eigen::Index k = 0; k < inertia.rows(); ++k) {
    const Eigen::VectorXd momentum = inertia * found.vectors.col(k);
    const double square = std::max(0.0, found.squares[k]);
    modes.push_back({square, &group, 2 * std::sqrt(square) * momentum * momentum.transpose()});
  }
}

}  // namespace

Eigen::MatrixXd BodyDamping::matrix(const Eigen::MatrixXd& K, const Eigen::MatrixXd& G) const {
  Eigen::MatrixXd D = stiffness_proportional * K;
  if (K.rows() == 0 || (ratio == 0 && ratios.empty())) return D;
  const std::vector<std::vector<Eigen::Index>> groups = coupled_coordinates(K, G);
  std::vector<OwnMode> modes;
  for (const std::vector<Eigen::Index>& group : groups) add_modes(K, G, group, modes);
  std::stable_sort(modes.begin(), modes.end(), [](const OwnMode& a, const OwnMode& b) { return a.square < b.square; });
  int number = 0;
  for (const OwnMode& mode : modes) {
    if (is_rounding(mode.square, modes.back().square)) continue;  // a motion without strain
    const auto own = ratios.find(++number);
    D(*mode.coordinates, *mode.coordinates) += (own != ratios.end() ? own->second : ratio) * mode.critical;
  }
  return D;
}

std::vector<std::string> BodyDamping::remarks(Eigen::Index modes) const {
  std::vector<std::string> found;
  const auto above = [&](double z, const std::string& of) {
    if (z > 1)
      found.push_back(fmt::format("the damping ratio {} {}is above 1, so that nothing swings; 5 % is 0.05", z, of));
  };
  above(ratio, "");
  for (const auto& [mode, z] : ratios) {
    above(z, fmt::format("of mode {} ", mode));
    if (mode > modes)
      found.push_back(fmt::format("a damping ratio is given for mode {}, and the body has {}", mode, modes));
  }
  return found;
}

namespace {

/// Beyond, a mode does not move in any time there is; with a stiff one its coefficients leave the range of numbers.
constexpr double greatest_ratio = 1e6;

}  // namespace

std::vector<ParameterSpec> damping_parameters(bool with_default) {
  ParameterSpec ratio = number("damping_ratio", "1",
                               "fraction of critical damping of each mode that the body has with its frame held and "
                               "carrying nothing; modes of the mounted tree have other ratios")
                            .least(0)
                            .most(greatest_ratio);
  std::vector<ParameterSpec> specs;
  specs.push_back(with_default ? std::move(ratio).otherwise(0.0) : std::move(ratio).optional());
  specs.push_back(
      map("damping",
          {table("ratios", {"1", "1"},
                 "number of a mode of the body held so, from 1 in order of frequency, and its own ratio")
               .least(0)
               .most(greatest_ratio)
               .optional(),
           number("stiffness_proportional", "s", "beta of a damping beta K, ratio beta omega/2 beside the others")
               .least(0)
               .optional()},
          "damping of single modes, and in proportion to stiffness")
          .optional());
  return specs;
}

}  // namespace withy
