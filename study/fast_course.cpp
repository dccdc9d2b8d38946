#include "withy/study/fast_course.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "withy/study/load_efforts.hpp"

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

constexpr int enough_turns = 16;  // eight periods, so that one more or less is an eighth

/// A row a sample, this far apart [s].
Eigen::MatrixXd sampled(const Course& course, double start, double apart) {
  Eigen::MatrixXd numbers;
  for (Eigen::Index k = 0; k < samples; ++k) {
    const Eigen::VectorXd row = course(start + static_cast<double>(k) * apart);
    if (k == 0) numbers.resize(samples, row.size());
    numbers.row(k) = row.transpose();
  }
  return numbers;
}

/// The period [s] of what goes to and fro fastest in samples this far apart [s]; 0 where nothing does.
double period_in(const Course& course, double start, double apart) {
  const Eigen::MatrixXd numbers = sampled(course, start, apart);
  if (numbers.size() == 0 || !numbers.allFinite()) return 0;
  int most = 0;
  for (const auto& column : numbers.colwise()) most = std::max(most, turns(column));
  return most < enough_turns ? 0 : 2 * static_cast<double>(samples - 1) * apart / most;
}

/// Zero in the place of numbers that go to and fro in samples so close that nothing does: what is no more than
/// rounding, as the effort on a hinge of a torque across its axis, does so at every distance.
Course without_rounding(Course course, double start, double too_close) {
  const Eigen::MatrixXd numbers = sampled(course, start, too_close);
  Eigen::VectorXd kept = Eigen::VectorXd::Ones(numbers.cols());
  for (Eigen::Index c = 0; c < numbers.cols(); ++c)
    if (numbers.col(c).allFinite() && turns(numbers.col(c)) >= enough_turns) kept[c] = 0;
  if ((kept.array() == 1).all()) return course;
  return [course = std::move(course), kept = std::move(kept)](double t) {
    return Eigen::VectorXd(course(t).cwiseProduct(kept));
  };
}

/// From the closest samples on: those further apart than half of a period tell a longer one.
struct Found {
  double period = 0, apart = 0;  ///< [s]
};
constexpr int octaves = 20;
Found fastest_period(const Course& course, double start, double longest) {
  for (int k = -octaves; k <= 0; ++k) {
    const double apart = std::ldexp(longest, k) / 8;
    if (apart < 64 * std::numeric_limits<double>::epsilon() * std::abs(start)) continue;
    const double period = period_in(course, start, apart);
    if (period > 0) return {period, apart};
  }
  return {};
}

Course efforts_of(const Prepared& prepared, const State& state, int load, Work& work) {
  return [&prepared, &state, load, &work](double t) { return load_efforts(*prepared.equations, t, state, load, work); };
}

Course accelerations_of(const Motion& motion) {
  return [&motion](double t) { return Eigen::VectorXd::Constant(1, motion.at(t).acceleration); };
}

/// What a course does. Of what samples of it tell the period is known to an eighth, of a clock to the last bit.
struct Does {
  const char* what;
  bool roughly;
};
constexpr Does swings_to_and_fro{"goes to and fro", true}, is_clocked{"is sampled", false};

/// What is told of a course, after what it does and how often.
using Rest = std::function<std::string(double period)>;

FastCourse told(bool of_motion, const std::string& name, double period, const Does& does, const Rest& rest) {
  return {of_motion, name, period,
          fmt::format("{} '{}' {} every {:.2g} s{}, whatever moves, {}", of_motion ? "motion" : "load", name, does.what,
                      period, does.roughly ? " or so" : "", rest(period))};
}

/// The first motion, else load, that goes to and fro in about `longest` [s] or less.
std::optional<FastCourse> swinging(const Prepared& prepared, const State& state, double longest, const Rest& rest) {
  const Model& model = prepared.model();
  const double too_close =
      std::max(std::ldexp(longest, -octaves) / 128, 4 * std::numeric_limits<double>::epsilon() * std::abs(state.time));
  const auto quiet = [&](Course course) { return without_rounding(std::move(course), state.time, too_close); };
  for (const MotionNode& node : model.motions())
    if (!node.motion->locks())
      if (const Found f = fastest_period(quiet(accelerations_of(*node.motion)), state.time, longest); f.period > 0)
        return told(true, node.name, f.period, swings_to_and_fro, rest);
  if (model.loads().empty()) return {};
  Work work = prepared.equations->make_work();
  const Found of_all =
      fastest_period(quiet(efforts_of(prepared, state, EquationsOfMotion::all_loads, work)), state.time, longest);
  if (!(of_all.period > 0)) return {};
  for (std::size_t l = 0; l < model.loads().size(); ++l)
    if (const double period =
            period_in(quiet(efforts_of(prepared, state, static_cast<int>(l), work)), state.time, of_all.apart);
        period > 0)
      return told(false, model.loads()[l].name, period, swings_to_and_fro, rest);
  return {};
}

/// Whether a motion or load may go to and fro in less than some steps of this size [s], by a few samples: those of
/// either distance see what returns to the same at each of the other.
bool may_swing(const Prepared& prepared, const State& state, double step) {
  const auto swings = [&](const Course& course) {
    return period_in(course, state.time, 0.0773 * step) > 0 || period_in(course, state.time, 0.0618 * step) > 0;
  };
  const Model& model = prepared.model();
  for (const MotionNode& node : model.motions())
    if (!node.motion->locks() && swings(accelerations_of(*node.motion))) return true;
  if (model.loads().empty()) return false;
  Work work = prepared.equations->make_work();
  return swings(efforts_of(prepared, state, EquationsOfMotion::all_loads, work));
}

}  // namespace

std::optional<FastCourse> fast_course(const Prepared& prepared, const State& state, std::size_t most_steps) {
  if (!prepared.scene.end) return {};
  const double left = *prepared.scene.end - state.time, allowed = static_cast<double>(most_steps);
  if (!(left > 0)) return {};
  const Rest rest = [&](double period) {
    return fmt::format("about {:.1g} times up to the end of the run, where {:g} steps are allowed", left / period,
                       allowed);
  };
  for (const LoadNode& node : prepared.model().loads())
    if (const DiscretePart* part = node.load->discrete();
        part != nullptr && left / allowed > part->period() && part->period() > 0)
      return told(false, node.name, part->period(), is_clocked, rest);
  // Adaptive steps of the usual tolerances, some ten in a period, are more than those allowed.
  constexpr double steps_in_a_period = 10;
  return swinging(prepared, state, steps_in_a_period * left / allowed, rest);
}

std::optional<FastCourse> unseen_course(const Prepared& prepared, const State& state) {
  const Value& integrator = prepared.scene.source.at("integrator");
  const Value* given = integrator.find("step");
  if (given == nullptr || integrator.find("rtol") != nullptr) return {};
  // A longer step than the run ends with it.
  const double left = prepared.scene.end ? *prepared.scene.end - state.time : std::numeric_limits<double>::infinity();
  const double step = std::min(given->number(), left);
  if (!(step > 0) || !std::isfinite(step) || !may_swing(prepared, state, step)) return {};
  constexpr double enough = 2, good = 20;  // steps in a period
  std::optional<FastCourse> course = swinging(prepared, state, enough * step, [&](double period) {
    return fmt::format("and steps of {:.2g} s do not follow it: take {:.1g} s, or an integrator with 'rtol'", step,
                       period / good);
  });
  if (course && course->period > enough * step) return {};
  return course;
}

}  // namespace withy::study
