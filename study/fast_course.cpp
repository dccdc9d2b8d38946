#include "withy/study/fast_course.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace withy::study {
namespace {

/// Numbers at a time [s].
using Course = std::function<Eigen::VectorXd(double)>;

constexpr Eigen::Index samples = 256;

/// How often numbers, one a row, turn back by more than a quarter of the range that they go through.
int turns(const Eigen::VectorXd& numbers) {
  const double range = numbers.maxCoeff() - numbers.minCoeff();
  // What does not change is the same to rounding.
  if (!(range > 1e-9 * numbers.cwiseAbs().maxCoeff())) return 0;
  int count = 0, direction = 0;
  double extreme = numbers[0];
  for (const double x : numbers) {
    if (direction == 0 ? std::abs(x - extreme) > range / 4 : (extreme - x) * direction > range / 4) {
      count += direction == 0 ? 0 : 1;
      direction = x > extreme ? 1 : -1;
      extreme = x;
    } else if ((x - extreme) * direction > 0) {
      extreme = x;
    }
  }
  return count;
}

/// The period [s] of what goes to and fro fastest in samples this far apart [s]; 0 where nothing does.
double period_in(const Course& course, double start, double apart) {
  constexpr int enough = 16;  // eight periods, so that one more or less is an eighth
  Eigen::MatrixXd numbers;
  for (Eigen::Index k = 0; k < samples; ++k) {
    const Eigen::VectorXd row = course(start + static_cast<double>(k) * apart);
    if (k == 0) numbers.resize(samples, row.size());
    numbers.row(k) = row.transpose();
  }
  if (numbers.size() == 0 || !numbers.allFinite()) return 0;
  int most = 0;
  for (const auto& column : numbers.colwise()) most = std::max(most, turns(column));
  return most < enough ? 0 : 2 * static_cast<double>(samples - 1) * apart / most;
}

/// From the closest samples on: those further apart than half of a period tell a longer one.
struct Found {
  double period = 0, apart = 0;  ///< [s]
};
Found fastest_period(const Course& course, double start, double longest) {
  constexpr int octaves = 20;
  for (int k = -octaves; k <= 0; ++k) {
    const double apart = std::ldexp(longest, k) / 8;
    if (apart < 64 * std::numeric_limits<double>::epsilon() * std::abs(start)) continue;
    const double period = period_in(course, start, apart);
    if (period > 0) return {period, apart};
  }
  return {};
}

Course efforts_of(const Prepared& prepared, const State& state, int load, Work& work) {
  return [&prepared, &state, load, &work](double t) {
    std::vector<double> efforts(prepared.model().layout().speeds);
    prepared.equations->load_efforts(t, state.y, load, efforts, work);
    return Eigen::VectorXd(Eigen::Map<Eigen::VectorXd>(efforts.data(), static_cast<Eigen::Index>(efforts.size())));
  };
}

Course accelerations_of(const Motion& motion) {
  return [&motion](double t) { return Eigen::VectorXd::Constant(1, motion.at(t).acceleration); };
}

}  // namespace

std::optional<FastCourse> fast_course(const Prepared& prepared, const State& state, std::size_t most_steps) {
  if (!prepared.scene.end) return {};
  const Model& model = prepared.model();
  const double left = *prepared.scene.end - state.time, allowed = static_cast<double>(most_steps);
  if (!(left > 0)) return {};
  const auto found = [&](bool of_motion, const std::string& name, double period, const char* does) {
    return FastCourse{of_motion, name, period,
                      fmt::format("{} '{}' {} every {:.2g} s, whatever moves, about {:.1g} times up to the end of the "
                                  "run, where {:g} steps are allowed",
                                  of_motion ? "motion" : "load", name, does, period, left / period, allowed)};
  };
  for (const LoadNode& node : model.loads())
    if (const DiscretePart* part = node.load->discrete();
        part != nullptr && left / allowed > part->period() && part->period() > 0)
      return found(false, node.name, part->period(), "is sampled");
  // Adaptive steps of the usual tolerances, some ten in a period, are more than those allowed.
  constexpr double steps_in_a_period = 10;
  const double longest = steps_in_a_period * left / allowed;
  constexpr const char* swings = "goes to and fro";
  for (const MotionNode& node : model.motions())
    if (!node.motion->locks())
      if (const Found f = fastest_period(accelerations_of(*node.motion), state.time, longest); f.period > 0)
        return found(true, node.name, f.period, swings);
  if (model.loads().empty()) return {};
  Work work = prepared.equations->make_work();
  const Found of_all =
      fastest_period(efforts_of(prepared, state, EquationsOfMotion::all_loads, work), state.time, longest);
  if (!(of_all.period > 0)) return {};
  for (std::size_t l = 0; l < model.loads().size(); ++l)
    if (const double period =
            period_in(efforts_of(prepared, state, static_cast<int>(l), work), state.time, of_all.apart);
        period > 0)
      return found(false, model.loads()[l].name, period, swings);
  return {};
}

}  // namespace withy::study
