#include "withy/study/open_loop.hpp"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>

#include "withy/core/model/columns.hpp"
#include "withy/core/plugin/load_numbers.hpp"
#include "withy/core/plugin/sampled_part.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/linear_parts.hpp"
#include "withy/study/turning_ends.hpp"

namespace withy::study {
namespace {

/// Derivatives of what a load answers with, its efforts on all speeds or its command, by the small motions: a column
/// each.
struct FedBack {
  Eigen::MatrixXd slopes;
  Eigen::RowVectorXd errors;  ///< what differences may be off by, of the greatest answer
};
template <class Answers>
FedBack fed_back(const SmallMotions& motions, Answers&& answers) {
  const Eigen::VectorXd here = answers(motions.state());
  FedBack all{Eigen::MatrixXd(here.size(), motions.size()), Eigen::RowVectorXd::Zero(motions.size())};
  const double greatest = here.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < all.slopes.cols(); ++i) {
    const double step = motions.step(i);
    const Differenced d =
        adaptive_difference([&](double h) -> Eigen::VectorXd { return answers(motions.displaced(i, h)); }, step);
    all.slopes.col(i) = d.slope;
    // A constant answer that is far above what a displacement changes takes digits from it.
    all.errors[i] = d.change.maxCoeff() + 8 * std::numeric_limits<double>::epsilon() * greatest / step;
  }
  return all;
}

std::size_t find_load(const Model& model, const std::string& name) {
  const auto& loads = model.loads();
  return static_cast<std::size_t>(
      std::find_if(loads.begin(), loads.end(), [&](const LoadNode& l) { return l.name == name; }) - loads.begin());
}

/// The load and hinge that "control.elbow" or "control" names; the hinge may be empty. Load's index is their count
/// where there is none.
std::pair<std::size_t, std::string> load_and_hinge(const Model& model, const std::string& name) {
  if (const std::size_t load = find_load(model, name); load < model.loads().size()) return {load, ""};
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos) return {model.loads().size(), ""};
  const std::size_t load = find_load(model, name.substr(0, dot));
  return {load, name.substr(dot + 1)};
}

OptionError nothing_fed_back(const std::string& name) {
  return {"input", "load '" + name +
                       "' feeds nothing back at this state: it is at a limit, or no load that acts continuously "
                       "follows its command; one that gives an effort, or whose command others follow, can be opened"};
}

/// What a load answers with: efforts in one proportion, along · (row · states).
struct Answer {
  Eigen::VectorXd along;  ///< one a speed, the greatest 1
  Eigen::RowVectorXd row;
  std::string unit;  ///< of the effort where there is one alone; else empty
};

/// Whether all rows of a matrix that is not zero are one row, times a number each.
bool in_one_proportion(const Eigen::JacobiSVD<Eigen::MatrixXd>& svd) {
  constexpr double rounding = 1e-9;
  const Eigen::VectorXd& singular = svd.singularValues();
  return singular.size() < 2 || !(singular[1] > rounding * singular[0]);
}

/// Takes the slopes of a load's efforts apart. \param hinge that the loop is opened at; empty: at all efforts
/// \throws InputError where the efforts are not in one proportion
Answer answer_of(const Configuration& c, const Eigen::MatrixXd& all, const std::string& name,
                 const std::string& hinge) {
  const Slot* const slot = hinge.empty() ? nullptr : c.layout().hinge(hinge);
  if (!hinge.empty() && slot == nullptr)
    throw OptionError("input", "no hinge '" + hinge + "' that load '" + name + "' could act on");
  const Held kept = c.kept();
  Eigen::MatrixXd slopes = all;
  std::vector<std::string> names;
  std::vector<std::size_t> speeds;
  for (std::size_t s = 0; s < c.layout().speeds; ++s) {
    const auto row = static_cast<Eigen::Index>(s);
    const bool here = slot == nullptr || (s >= slot->speed && s < slot->speed + slot->speeds);
    if (!here || kept[s]) slopes.row(row).setZero();
    if (slopes.row(row).isZero(0)) continue;
    names.push_back(c.layout().speed_names[s]);
    speeds.push_back(s);
  }
  if (speeds.empty()) throw nothing_fed_back(name);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(slopes, Eigen::ComputeThinU | Eigen::ComputeThinV);
  if (!in_one_proportion(svd))
    throw OptionError("input", fmt::format("load '{0}' feeds back to {1}; name one hinge, as {0}.HINGE", name,
                                           fmt::join(names, ", ")));
  Answer answer{svd.matrixU().col(0), {}, speeds.size() == 1 ? unit_of_effort(c.prepared().model(), speeds[0]) : ""};
  Eigen::Index greatest = 0;
  answer.along.cwiseAbs().maxCoeff(&greatest);
  answer.along /= answer.along[greatest];
  answer.row = slopes.row(greatest);
  return answer;
}

/// The command of a sampled load that acts through continuous ones alone, and what one unit of it does.
struct Command {
  Answer answer;         ///< `along`: the efforts that follow the command at once; `row` of what the load holds
  Eigen::VectorXd push;  ///< ẋ by it
};

/// \throws InputError where nothing measures it, several commands act, or sampled loads measure it too
Command command_of(SampledLoads& sampled, std::size_t load, const std::string& name) {
  const auto [first, count] = sampled.held_by(load);
  const Eigen::MatrixXd moved = sampled.moved(sampled.efforts()).middleCols(first, count);
  if (moved.isZero(0)) throw nothing_fed_back(name);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(moved, Eigen::ComputeThinU | Eigen::ComputeThinV);
  if (!in_one_proportion(svd))
    throw OptionError("input", "load '" + name + "' gives several commands, through which it acts on several loads");
  if (sampled.measured_by_others(load))
    throw OptionError("input", "load '" + name +
                                   "' acts through continuous loads, and sampled ones measure its command as well: no "
                                   "one place opens its loop");
  Eigen::RowVectorXd row = svd.matrixV().col(0).transpose();
  Eigen::Index greatest = 0;
  row.cwiseAbs().maxCoeff(&greatest);
  row /= row[greatest];  // the command is one of the numbers held
  const Eigen::VectorXd one = row.transpose() / row.squaredNorm();
  return {{sampled.efforts().middleCols(first, count) * one, row, ""}, moved * one};
}

/// What a load gives to others.
class CommandSensor final : public BoundSensor {
 public:
  explicit CommandSensor(std::size_t load) : load_(load) {}
  std::vector<SensorColumn> columns() const override { return {{"", "1"}}; }
  void read(SensedState& state, const SensorInputs& /*inputs*/, std::span<double> values) const noexcept override {
    auto* const loads = dynamic_cast<SensedLoads*>(&state);
    values[0] = loads == nullptr ? std::numeric_limits<double>::quiet_NaN() : loads->given(load_, 0, state.y());
  }

 private:
  std::size_t load_;
};

std::string unit_of_command(const LoadNode& node) {
  const auto* told = dynamic_cast<const LoadNumbers*>(node.load.get());
  return told == nullptr || told->numbers().empty() ? "" : told->numbers().front().unit;
}

/// \throws InputError where other loads are sampled at instants that are none of the load's
void require_its_period_is_common(const SampledLoads& sampled, std::size_t load, const std::string& name) {
  const double period = sampled.period_of(load);
  if (!(period > 0) && !sampled.none())
    throw OptionError("input",
                      "the loop of '" + name + "', which acts without pause, cannot be opened beside sampled ones");
  if (period > 0 && std::abs(period - sampled.period()) > 1e-9 * sampled.period())
    throw OptionError(
        "input", fmt::format("load '{}' is sampled each {:g} s, and all loads together repeat each {:g} s: only the "
                             "loop of a load that is sampled that seldom can be opened",
                             name, period, sampled.period()));
}

/// What stands in the place of a load's answer. Of a sampled load at frames, or that acts through others, it is what
/// the load holds, so that the force is where it was; on speeds it is an effort on these, for the loop may be opened at
/// some of them.
LinearInput in_place_of(const SmallMotions& motions, const SampledLoads& sampled, std::size_t load,
                        const Answer& answer, bool is_command) {
  if (!is_command && (motions.model().loads()[load].load->frames().empty() || sampled.period_of(load) == 0))
    return {{}, answer.along, [&](double h) { return motions.pushed(h * answer.along); }};
  const auto [first, count] = sampled.held_by(load);
  Eigen::VectorXd one = Eigen::VectorXd::Zero(sampled.size());
  one.segment(first, count) = answer.row.transpose() / answer.row.squaredNorm();
  return {{}, answer.along, [&sampled, one](double h) { return sampled.displaced(h * one); }};
}

/// a − b, zero where they are the same but for rounding and what b may be off by: a stiffness that is taken off leaves
/// none.
Eigen::MatrixXd difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const Eigen::MatrixXd& errors) {
  constexpr double rounding = 1e-11;  // of differences of eighth order
  return (a - b).binaryExpr(rounding * (a.cwiseAbs() + b.cwiseAbs()) + errors,
                            [](double left, double none) { return std::abs(left) <= none ? 0.0 : left; });
}

}  // namespace

namespace {

/// The loop of a continuous load that acts through others alone, opened at its command.
LinearModel open_at_command(const Configuration& c, const std::string& name, std::size_t load) {
  const LoadNode& node = c.prepared().model().loads()[load];
  if (node.load->output()->outputs() > 1)
    throw OptionError("input", "load '" + name + "' gives several commands, through which it acts on several loads");
  SmallMotions motions(c, {{"command", std::make_shared<CommandSensor>(load)}}, load);
  SampledLoads sampled(motions);
  const FedBack answer = fed_back(motions, [&](const State& state) { return motions.sensed(state); });
  const double command = motions.sensed(motions.state())[0];
  const Differenced push = adaptive_difference([&](double h) { return motions.moved(motions.commanded(h)); },
                                               std::max(1.0, std::abs(command)));
  if (answer.slopes.isZero(0) || push.slope.isZero(0)) throw nothing_fed_back(name);
  LinearModel linear = about(c, motions, sampled).linear;
  const std::string unit = unit_of_command(node);
  linear.inputs = {{name, unit}};
  linear.outputs = {{"-" + name, unit}};
  linear.output_values = {-command};
  linear.output_derivatives = "by central differences of eighth order";
  linear.system.A = difference(motions.A(), push.slope * answer.slopes,
                               push.slope.cwiseAbs() * answer.errors + push.change * answer.slopes.cwiseAbs());
  linear.system.B = push.slope;
  linear.system.C = -answer.slopes;
  linear.system.D.setZero(1, 1);
  return linear;
}

}  // namespace

std::vector<std::string> commands_followed(const Configuration& c, const std::string& name) {
  std::vector<std::string> followed;
  const Model& model = c.prepared().model();
  const std::size_t load = load_and_hinge(model, name).first;
  const LoadSlot& own = model.loads()[load].continuous_slot;
  for (std::size_t l = 0; l < model.loads().size(); ++l) {
    const BoundLoad& other = *model.loads()[l].load;
    if (l == load || other.output() == nullptr || (other.discrete() != nullptr && other.discrete()->period() > 0))
      continue;
    const SmallMotions motions(c, {}, l);
    const auto first = static_cast<Eigen::Index>(own.first - model.layout().positions - model.layout().speeds +
                                                 2 * motions.free().size());
    const auto answer = [&](double h) {
      const State state = motions.commanded(h);
      const Eigen::VectorXd efforts = motions.efforts(state, load);
      Eigen::VectorXd all(efforts.size() + static_cast<Eigen::Index>(own.count));
      all << efforts, motions.moved(state).segment(own.count > 0 ? first : 0, static_cast<Eigen::Index>(own.count));
      return all;
    };
    if (!adaptive_difference(answer, 1).slope.isZero(0)) followed.push_back(model.loads()[l].name);
  }
  return followed;
}

bool feeds_back(const Model& model, const std::string& name) {
  const auto [load, hinge] = load_and_hinge(model, name);
  return load < model.loads().size() && model.loads()[load].load->input() == nullptr;
}

LinearModel open_loop(const Configuration& c, const std::string& name) {
  SmallMotions motions(c, {});
  const Model& model = motions.model();
  const auto [load, hinge] = load_and_hinge(model, name);
  SampledLoads sampled(motions);
  const bool is_sampled = sampled.period_of(load) > 0;
  require_its_period_is_common(sampled, load, name);
  const auto [first, count] = sampled.held_by(load);
  const bool is_command = is_sampled && hinge.empty() && sampled.own_efforts().middleCols(first, count).isZero(0);
  FedBack all;
  Answer answer;
  Eigen::VectorXd push;
  if (is_command) {
    Command command = command_of(sampled, load, name);
    answer = std::move(command.answer);
    push = std::move(command.push);
  } else {
    all = is_sampled ? FedBack{sampled.own_efforts().middleCols(first, count), {}}
                     : fed_back(motions, [&, at = load](const State& state) { return motions.efforts(state, at); });
    if (!is_sampled && hinge.empty() && all.slopes.isZero(0) && model.loads()[load].load->output() != nullptr)
      return open_at_command(c, name, load);
    answer = answer_of(c, all.slopes, name, hinge);
    push = motions.by_effort() * answer.along;
  }
  auto [linear, states] = about(c, motions, sampled);
  const bool known =
      std::find(linear.changing.begin(), linear.changing.end(), model.loads()[load].name) != linear.changing.end();
  if (!linear.frozen && !is_sampled && !known && load_changes(motions, states, load)) {
    linear.turning_loads = {model.loads()[load].name};
    linear.frozen = true;
  }
  linear.inputs = {{name, answer.unit}};
  linear.outputs = {{"-" + name, answer.unit}};
  linear.output_values = {is_command
                              ? -answer.row.dot(sampled.held_at_state().segment(first, count))
                              : -answer.along.dot(motions.efforts(motions.state(), load)) / answer.along.squaredNorm()};
  linear.output_derivatives = "by central differences of eighth order";
  Eigen::MatrixXd A = motions.A(), held = sampled.efforts();
  linear.system.C.setZero(1, motions.size() + sampled.size() + sampled.told());
  linear.system.D.setZero(1, 1);
  Eigen::MatrixXd replaced;
  if (is_sampled) {
    linear.system.C.block(0, motions.size() + first, 1, count) = -answer.row;
    replaced.setZero(1, sampled.size());
    replaced.middleCols(first, count) = answer.row;
    if (!is_command)
      held.middleCols(first, count) = difference(held.middleCols(first, count), answer.along * answer.row,
                                                 Eigen::MatrixXd::Zero(held.rows(), count));
  } else {
    linear.system.C.leftCols(motions.size()) = -answer.row;
    A = difference(A, push * answer.row, push.cwiseAbs() * all.errors);
  }
  Eigen::MatrixXd by_held = sampled.moved(held);
  if (is_command)
    by_held.middleCols(first, count) =
        difference(by_held.middleCols(first, count), push * answer.row, Eigen::MatrixXd::Zero(by_held.rows(), count));
  sample(sampled, {A, by_held, push, sampled.felt({in_place_of(motions, sampled, load, answer, is_command)}), replaced},
         linear);
  return linear;
}

}  // namespace withy::study
