/// \file
/// An input: an effort on a rate of a hinge, or a force or moment at a frame, whose value a host sets between steps.
#include <algorithm>
#include <cmath>
#include <optional>

#include "withy/core/plugin/direction.hpp"
#include "withy/core/plugin/effortless_load.hpp"
#include "withy/core/plugin/registry.hpp"
#include "withy/loads/frame_load.hpp"
#include "withy/loads/hinge_rate.hpp"

namespace withy {
namespace {

/// The value of an input over time until a host sets it: zero before the first row, that of the last after it.
struct InputTable {
  bool linear = false;  ///< between the rows; else each row's value holds until the next
  std::vector<double> times, values;

  double operator()(double t) const noexcept {
    if (std::isnan(t)) return t;
    const auto next = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), t) - times.begin());
    if (next == 0) return 0;
    if (!linear || next == times.size()) return values[next - 1];
    const double r = (t - times[next - 1]) / (times[next] - times[next - 1]);
    return (1 - r) * values[next - 1] + r * values[next];
  }
};

/// The discrete states of an input: whether a host has set it and to which value; where it is linear also the value and
/// the time at which the line begins, and the time at which it ends. Nothing but the host changes them.
class HeldValue : public DiscretePart, public InputPort {
 public:
  HeldValue(InputTable table, std::string unit) : table_(std::move(table)), unit_(std::move(unit)) {}

  std::size_t states() const override { return table_.linear ? 5 : 2; }
  void renew(double /*t*/, std::span<const double> /*positions*/, std::span<const double> /*speeds*/,
             const Crossing& /*crossing*/, std::span<double> /*discrete*/,
             std::span<double> /*scratch*/) const noexcept override {}

  std::string unit() const override { return unit_; }
  bool interpolates() const override { return table_.linear; }
  bool is_set(std::span<const double> discrete) const noexcept override { return discrete[set_] != 0; }
  double value(double t, std::span<const double> discrete) const noexcept override {
    if (discrete[set_] == 0) return table_(t);
    if (!table_.linear || t >= discrete[ends_]) return discrete[value_];
    if (t <= discrete[begins_]) return discrete[from_];
    const double r = (t - discrete[begins_]) / (discrete[ends_] - discrete[begins_]);
    return (1 - r) * discrete[from_] + r * discrete[value_];
  }
  void set(double t, double reached, double value, std::span<double> discrete) const noexcept override {
    const double from = this->value(t, discrete);
    discrete[set_] = 1;
    discrete[value_] = value;
    if (!table_.linear) return;
    discrete[from_] = reached > t ? from : value;
    discrete[begins_] = t;
    discrete[ends_] = reached;
  }

 protected:
  [[nodiscard]] const std::vector<double>& rows() const { return table_.times; }

 private:
  enum : std::size_t { set_, value_, from_, begins_, ends_ };
  InputTable table_;
  std::string unit_;
};

class BoundHingeInput final : public EffortlessLoad, public HeldValue {
 public:
  BoundHingeInput(const InputTable& table, const char* unit, std::size_t speed)
      : HeldValue(table, unit), speed_(speed) {}
  using EffortlessLoad::add;
  std::vector<double> discontinuities() const override { return rows(); }
  const DiscretePart* discrete() const override { return this; }
  const InputPort* input() const override { return this; }
  InputPlace place() const override { return {.speed = static_cast<int>(speed_), .frame = {}}; }
  void add(double t, std::span<const double> discrete, std::span<double> efforts) const noexcept override {
    efforts[speed_] += value(t, discrete);
  }

 private:
  std::size_t speed_;
};

/// Where and along what a force or moment acts.
struct FrameInput {
  std::string frame;
  Vector3 direction = Vector3::Zero();  ///< unit vector
  bool following = false;
  bool moment = false;
};

class BoundFrameInput final : public FrameLoad, public HeldValue {
 public:
  BoundFrameInput(const InputTable& table, FrameIndex frame, const FrameInput& at)
      : FrameLoad({frame}), HeldValue(table, at.moment ? "N m" : "N"), at_(at) {}
  std::vector<double> discontinuities() const override { return rows(); }
  const DiscretePart* discrete() const override { return this; }
  const InputPort* input() const override { return this; }
  InputPlace place() const override {
    return {.frame = frames()[0], .direction = at_.direction, .following = at_.following, .moment = at_.moment};
  }
  void add(double /*t*/, std::span<const double> /*discrete*/, std::span<double> /*efforts*/) const noexcept override {}
  void wrenches(double /*t*/, std::span<const FrameMotion> /*motions*/,
                std::span<Wrench> wrenches) const noexcept override {
    wrenches[0] = {};
  }
  void add_wrenches(double t, std::span<const double> discrete, std::span<const FrameMotion> motions,
                    std::span<Wrench> wrenches) const noexcept override {
    const Vector3 acting = value(t, discrete) * at_.direction;
    (at_.moment ? wrenches[0].moment : wrenches[0].force) += at_.following ? Vector3(motions[0].R * acting) : acting;
  }
  using FrameLoad::add;

 private:
  FrameInput at_;
};

class HingeInput final : public Load {
 public:
  HingeInput(InputTable table, RateName rate) : table_(std::move(table)), rate_(std::move(rate)) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    const std::size_t speed = speed_index(model, rate_);
    const Hinge& hinge = *model.hinges()[static_cast<std::size_t>(model.hinge(rate_.hinge))].hinge;
    return std::make_unique<BoundHingeInput>(table_, hinge_rates(hinge)[rate_.component].angular ? "N m" : "N", speed);
  }

 private:
  InputTable table_;
  RateName rate_;
};

class InputAtFrame final : public Load {
 public:
  InputAtFrame(InputTable table, FrameInput at) : table_(std::move(table)), at_(std::move(at)) {}
  std::unique_ptr<BoundLoad> bind(const Model& model) const override {
    return std::make_unique<BoundFrameInput>(table_, frame_index(model, at_.frame), at_);
  }

 private:
  InputTable table_;
  FrameInput at_;
};

/// Reports what does not go together; nothing then.
bool fits(const Value& p, const MakeContext& context) {
  const auto error = [&](const Value& at, const std::string& message) {
    context.diagnostics.error(at.place(), message);
    return false;
  };
  bool good = true;
  if (p.has("hinge") == p.has("frame")) return error(p, "needs one of 'hinge' and 'frame', where it acts");
  const char* place = p.has("hinge") ? "hinge" : "frame";
  for (const char* key : {"direction", "following", "acts"})
    if (p.has("hinge") && p.has(key)) good = error(p.at(key), std::string("at a hinge there is no '") + key + "'");
  if (p.has("frame") && p.has("component")) good = error(p.at("component"), "at a frame there is no 'component'");
  if (p.has("frame") && !p.has("direction")) good = error(p, std::string("at a ") + place + " it needs a 'direction'");
  if (p.has("table") && p.at("table").items().empty())
    good = error(p.at("table"), "has no row; need [time, value] at least once");
  return good;
}

std::unique_ptr<Load> make_input(const Value& p, const MakeContext& context) {
  if (!fits(p, context)) return nullptr;
  InputTable table{p.text_at("hold") == "linear", {}, {}};
  if (p.has("table")) {
    for (const Value& row : p.at("table").items()) {
      table.times.push_back(row.items()[0].number());
      table.values.push_back(row.items()[1].number());
    }
  }
  if (p.has("hinge"))
    return std::make_unique<HingeInput>(std::move(table),
                                        RateName{p.text_at("hinge"), p.has("component") ? p.count_at("component") : 0});
  const std::optional<Vector3> direction = direction_at(p, "direction", context);
  if (!direction) return nullptr;
  FrameInput at{p.text_at("frame"), *direction, p.has("following") && p.at("following").boolean(),
                p.has("acts") && p.text_at("acts") == "torque"};
  return std::make_unique<InputAtFrame>(std::move(table), std::move(at));
}

std::vector<ParameterSpec> input_parameters() {
  return {
      text("hinge", "hinge whose rate it drives").naming(ParameterSpec::Refers::hinge).optional(),
      integer("component", "which of the hinge's rates, counted from 0, which is the default").least(0).optional(),
      text("frame", "or frame that it acts at: body.frame, or body for its root")
          .naming(ParameterSpec::Refers::frame)
          .optional(),
      vector("direction", 3, "1", "at a frame: direction of the force or torque, of any length").optional(),
      boolean("following", "at a frame: the direction is in its axes and turns with it; else in world axes").optional(),
      text("acts", "at a frame: what it is, a force where left out").one_of({"force", "torque"}).optional(),
      text("hold", "between two values: the first holds, or a straight line joins them")
          .one_of({"constant", "linear"})
          .otherwise("constant"),
      table("table", {"s", "1"}, "time and value [N m, N], until a host sets the input; zero where left out")
          .optional()};
}

}  // namespace

void enroll_input(Enrollment& enrollment) {
  enrollment.add<Load>({.id = "input",
                        .summary = "Effort at a hinge, or force or torque at a frame, that a host sets between steps",
                        .parameters = input_parameters(),
                        .make = &make_input});
}

}  // namespace withy
