/// \file
/// Blocks that other loads measure: a low-pass filter, the parts of a digital measurement, sums over time.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "withy/loads/control/control_load.hpp"
#include "withy/loads/control/linear_block.hpp"

namespace withy {
namespace {

/// Butterworth's polynomial of an order, of s/ω, from the highest power on.
std::vector<double> butterworth(std::size_t order) {
  std::vector<double> product{1};
  const auto times = [&](const std::vector<double>& factor) {
    std::vector<double> next(product.size() + factor.size() - 1, 0.0);
    for (std::size_t i = 0; i < product.size(); ++i)
      for (std::size_t j = 0; j < factor.size(); ++j) next[i + j] += product[i] * factor[j];
    product = std::move(next);
  };
  const auto n = static_cast<double>(order);
  for (std::size_t k = 0; k < order / 2; ++k)
    times({1, 2 * std::sin((2 * static_cast<double>(k) + 1) * std::numbers::pi / (2 * n)), 1});
  if (order % 2 == 1) times({1, 1});
  return product;
}

std::unique_ptr<Load> make_filter(const Value& p, const MakeContext& context) {
  std::optional<ControlEnds> ends = read_signal_ends(p, context, 1);
  if (!ends) return nullptr;
  StateSpace low_pass = canonical_form({1}, butterworth(p.count_at("order")));
  const double cutoff = 2 * std::numbers::pi * p.number_at("cutoff");
  low_pass.A *= cutoff;
  low_pass.B *= cutoff;
  auto block = std::make_shared<LinearBlock>(std::move(low_pass), std::nullopt, LinearBlock::Start::settled);
  if (ends->sample > 0) block->set_sample(ends->sample);
  return make_control(std::move(*ends), std::move(block));
}

/// A signal as it was a time before, by Padé's approximation of e^(−sT) with one zero fewer than poles: it begins at
/// zero error, feeds nothing through, and is exact to (ωT)^(2 order).
StateSpace pade_delay(double time, std::size_t order) {
  const auto m = static_cast<double>(order - 1), n = static_cast<double>(order);
  // Coefficients of (∓x)^k: (m + n − k)! m! / ((m + n)! k! (m − k)!), and with n for m.
  const auto coefficients = [&](double own, double sign) {
    std::vector<double> c{1};
    for (double k = 1; k <= own; ++k) c.insert(c.begin(), sign * c.front() * (own - k + 1) / (k * (m + n - k + 1)));
    return c;
  };
  StateSpace delay = canonical_form(coefficients(m, -1), coefficients(n, 1));
  delay.A /= time;
  delay.B /= time;
  return delay;
}

std::unique_ptr<Load> make_delay(const Value& p, const MakeContext& context) {
  std::optional<ControlEnds> ends = read_signal_ends(p, context, 1);
  if (p.has("sample")) {
    context.diagnostics.error(p.at("sample").place(),
                              "this delay is continuous; a sampled controller has an exact 'delay' of its own");
    return nullptr;
  }
  if (!ends) return nullptr;
  return make_control(std::move(*ends),
                      std::make_shared<LinearBlock>(pade_delay(p.number_at("time"), p.count_at("order")), std::nullopt,
                                                    LinearBlock::Start::settled));
}

/// The mean of what was measured at the last samples. States: those before the present one, the latest first.
class MovingAverage final : public ControlBlock {
 public:
  explicit MovingAverage(std::size_t samples) : samples_(samples) {}
  std::size_t inputs() const override { return 1; }
  std::string unit_of_output() const override { return "signal"; }
  std::vector<std::string> states() const override {
    std::vector<std::string> names;
    for (std::size_t i = 1; i < samples_; ++i) names.push_back("before" + std::to_string(i));
    return names;
  }
  std::string unit_of_state(std::size_t /*state*/) const override { return "signal"; }
  void begin(double /*t*/, std::span<const double> w, std::span<double> z) const noexcept override {
    std::fill(z.begin(), z.end(), w[0]);
  }
  void output(double /*t*/, std::span<const double> w, std::span<const double> z,
              std::span<double> v) const noexcept override {
    v[0] = w[0];
    for (const double x : z) v[0] += x;
    v[0] /= static_cast<double>(samples_);
  }
  void advance(double /*t*/, std::span<const double> w, std::span<double> z) const noexcept override {
    if (z.empty()) return;
    std::copy_backward(z.begin(), z.end() - 1, z.end());
    z[0] = w[0];
  }

 private:
  std::size_t samples_;
};

/// Multiples of a step within a range, as of a converter.
class Quantizer final : public ControlBlock {
 public:
  /// \param range infinite: none; else at least the step
  Quantizer(double step, double range) : step_(step), most_(std::floor(range / step * (1 + 1e-12))) {}
  std::size_t inputs() const override { return 1; }
  std::string unit_of_output() const override { return "signal"; }
  void output(double /*t*/, std::span<const double> w, std::span<const double> /*z*/,
              std::span<double> v) const noexcept override {
    v[0] = step_ * std::clamp(std::round(w[0] / step_), -most_, most_);
  }
  bool gives_steps() const override { return true; }

 private:
  double step_;
  double most_;  ///< steps within the range; the quotient of the two is rounded
};

/// A signal with a normal number added at each sample, which depends on the seed and on the sample's number alone.
class Noise final : public ControlBlock {
 public:
  Noise(std::size_t inputs, double deviation, std::uint64_t seed)
      : inputs_(inputs), deviation_(deviation), seed_(seed) {}
  std::size_t inputs() const override { return inputs_; }
  std::string unit_of_output() const override { return "signal"; }
  void set_sample(double period) override { period_ = period; }
  bool draws() const override { return deviation_ > 0; }
  void output(double t, std::span<const double> w, std::span<const double> /*z*/,
              std::span<double> v) const noexcept override {
    v[0] = (w.empty() ? 0 : w[0]) + deviation_ * normal(static_cast<std::uint64_t>(std::llround(t / period_)));
  }

 private:
  /// SplitMix64 of Steele, Lea and Flood (2014).
  static std::uint64_t mixed(std::uint64_t x) noexcept {
    x += 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
  }
  /// In (0, 1).
  static double uniform(std::uint64_t x) noexcept { return (static_cast<double>(x >> 11) + 0.5) * 0x1p-53; }
  /// Box and Muller's.
  [[nodiscard]] double normal(std::uint64_t sample) const noexcept {
    const std::uint64_t first = mixed(mixed(seed_) ^ sample), second = mixed(first);
    return std::sqrt(-2 * std::log(uniform(first))) * std::cos(2 * std::numbers::pi * uniform(second));
  }

  std::size_t inputs_;
  double deviation_;
  std::uint64_t seed_;
  double period_ = 1;
};

enum class Sum { integral, mean, rms, least, greatest };

/// Over the time since it began. States: the sum, or the extreme; when it began; and of a mean what the signal, of a
/// root mean square its size, was then: over no time at all these are the limit, and zero would be a jump at the start.
class OverTime final : public ControlBlock {
 public:
  explicit OverTime(Sum sum) : sum_(sum) {}
  std::size_t inputs() const override { return 1; }
  std::vector<std::string> states() const override {
    return averages() ? std::vector<std::string>{"sum", "begun", "first"} : std::vector<std::string>{"sum", "begun"};
  }
  std::string unit_of_output() const override { return sum_ == Sum::integral ? "(signal) s" : "signal"; }
  std::string unit_of_state(std::size_t state) const override {
    if (state == 1) return "s";
    if (state == 2) return "signal";
    return extreme() ? "signal" : sum_ == Sum::rms ? "(signal)^2 s" : "(signal) s";
  }
  void begin(double t, std::span<const double> w, std::span<double> z) const noexcept override {
    z[0] = extreme() ? w[0] : 0;
    z[1] = t;
    if (averages()) z[2] = sum_ == Sum::rms ? std::abs(w[0]) : w[0];
  }
  void rates(double /*t*/, std::span<const double> w, std::span<const double> /*z*/,
             std::span<double> rates) const noexcept override {
    rates[0] = added(w[0]);
    std::fill(rates.begin() + 1, rates.end(), 0.0);
  }
  void output(double t, std::span<const double> w, std::span<const double> z,
              std::span<double> v) const noexcept override {
    const double span = t - z[1];
    switch (sum_) {
      case Sum::integral:
        v[0] = z[0];
        break;
      case Sum::mean:
        v[0] = span > 0 ? z[0] / span : z[2];
        break;
      case Sum::rms:
        v[0] = span > 0 ? std::sqrt(z[0] / span) : z[2];
        break;
      case Sum::least:
        v[0] = std::min(z[0], w[0]);
        break;
      case Sum::greatest:
        v[0] = std::max(z[0], w[0]);
        break;
    }
  }
  bool feeds_through(std::size_t /*input*/) const override { return extreme(); }
  bool changes_gain() const override { return averages(); }
  void set_sample(double period) override { period_ = period; }
  void advance(double /*t*/, std::span<const double> w, std::span<double> z) const noexcept override {
    if (sum_ == Sum::least) z[0] = std::min(z[0], w[0]);
    if (sum_ == Sum::greatest) z[0] = std::max(z[0], w[0]);
    if (!extreme()) z[0] += period_ * added(w[0]);
  }

 private:
  [[nodiscard]] bool averages() const noexcept { return sum_ == Sum::mean || sum_ == Sum::rms; }
  [[nodiscard]] bool extreme() const noexcept { return sum_ == Sum::least || sum_ == Sum::greatest; }
  [[nodiscard]] double added(double w) const noexcept { return sum_ == Sum::rms ? w * w : w; }
  Sum sum_;
  double period_ = 0;
};

/// Reports a block without a `sample` that is digital by nature.
bool digital(const Value& p, const MakeContext& context, const char* what) {
  if (p.has("sample")) return true;
  context.diagnostics.error(p.place(), std::string(what) + " is of a digital measurement: it needs a 'sample'");
  return false;
}

std::unique_ptr<Load> make_moving_average(const Value& p, const MakeContext& context) {
  std::optional<ControlEnds> ends = read_signal_ends(p, context, 1);
  if (!digital(p, context, "a moving average") || !ends) return nullptr;
  const double samples = p.number_at("window") / ends->sample;
  const double whole = std::round(samples);
  if (whole < 1 || whole > 1000 || std::abs(samples - whole) > 1e-9 * samples) {
    context.diagnostics.error(p.at("window").place(), "needs 1 to 1000 times the 'sample'");
    return nullptr;
  }
  return make_control(std::move(*ends), std::make_shared<MovingAverage>(static_cast<std::size_t>(whole)));
}

std::unique_ptr<Load> make_quantizer(const Value& p, const MakeContext& context) {
  std::optional<ControlEnds> ends = read_signal_ends(p, context, 1);
  if (!digital(p, context, "a quantizer") || !ends) return nullptr;
  const double range = p.has("range") ? p.number_at("range") : std::numeric_limits<double>::infinity();
  if (range < p.number_at("step")) {
    context.diagnostics.error(p.at("range").place(), "is less than the 'step': it would never give but zero");
    return nullptr;
  }
  return make_control(std::move(*ends), std::make_shared<Quantizer>(p.number_at("step"), range));
}

std::unique_ptr<Load> make_noise(const Value& p, const MakeContext& context) {
  const std::size_t signals = p.has("of") ? 1 : 0;
  std::optional<ControlEnds> ends = read_signal_ends(p, context, signals);
  if (!digital(p, context, "noise") || !ends) return nullptr;
  ends->measures_nothing = signals == 0;
  auto block = std::make_shared<Noise>(signals, p.number_at("deviation"), p.count_at("seed"));
  block->set_sample(ends->sample);
  return make_control(std::move(*ends), std::move(block));
}

std::unique_ptr<Load> make_over_time(const Value& p, const MakeContext& context) {
  std::optional<ControlEnds> ends = read_signal_ends(p, context, 1);
  if (!ends) return nullptr;
  const std::string& what = p.text_at("what");
  const Sum sum = what == "integral" ? Sum::integral
                  : what == "mean"   ? Sum::mean
                  : what == "rms"    ? Sum::rms
                  : what == "min"    ? Sum::least
                                     : Sum::greatest;
  if ((sum == Sum::least || sum == Sum::greatest) && !digital(p, context, "an extreme over time")) return nullptr;
  auto block = std::make_shared<OverTime>(sum);
  block->set_sample(ends->sample);
  return make_control(std::move(*ends), std::move(block));
}

}  // namespace

void enroll_filter(Enrollment& enrollment) {
  const auto add = [&](const char* id, const char* summary, std::vector<ParameterSpec> own, auto make) {
    enrollment.add<Load>(
        {.id = id, .summary = summary, .parameters = control_parameters(std::move(own)), .make = make});
  };
  add("filter", "Low-pass filter of a signal, of Butterworth's form; of order 1 a lag",
      {number("cutoff", "Hz", "where the gain is 1/√2").above(0),
       integer("order", "count of poles").least(1).most(12).otherwise(1.0)},
      &make_filter);
  add("delay", "A continuous signal as it was a time before, approximately",
      {number("time", "s", "of the delay").above(0),
       integer("order", "count of poles; the error is of the order (frequency times time) to twice that")
           .least(1)
           .most(10)
           .otherwise(4.0)},
      &make_delay);
  add("moving-average", "Mean of a signal over its last samples",
      {number("window", "s", "a multiple of the sample").above(0)}, &make_moving_average);
  add("quantizer", "A signal in steps, as a converter gives it",
      {number("step", "1", "between two values, in the signal's unit").above(0),
       number("range", "1", "values end with the last step within it, of either sign").above(0).optional()},
      &make_quantizer);
  add("noise", "Normal noise, drawn anew at each sample: added to a signal, or alone",
      {number("deviation", "1", "standard deviation, in the signal's unit").least(0),
       integer("seed", "of the random numbers; loads of one seed have the same").least(0).otherwise(0.0)},
      &make_noise);
  add("over-time", "Integral, mean, root mean square or extreme of a signal since the start",
      {text("what", "which of these").one_of({"integral", "mean", "rms", "min", "max"})}, &make_over_time);
}

}  // namespace withy
