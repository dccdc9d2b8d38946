#include "withy/study/response.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "withy/study/input_error.hpp"
#include "withy/study/open_loop.hpp"

namespace withy::study {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

LinearModel one_of(LinearModel model, const ResponseQuestion& question) {
  const auto require_one = [](const std::vector<Column>& columns, const std::string& option, const std::string& name) {
    if (columns.size() == 1) return;
    std::vector<std::string> names;
    for (const Column& c : columns) names.push_back(c.name);
    throw OptionError(option, fmt::format("'{}' is {} of: {}; name one", name, columns.size(), fmt::join(names, ", ")));
  };
  require_one(model.inputs, "input", question.input);
  require_one(model.outputs, "output", question.output);
  return model;
}

/// A hinge of one coordinate is that coordinate, as in every other study, and not its rate as well.
std::string coordinate_of(const Model& model, const std::string& name) {
  const auto& hinges = model.layout().hinges;
  const auto found = std::find_if(hinges.begin(), hinges.end(), [&](const Slot& hinge) { return hinge.name == name; });
  return found != hinges.end() && found->speeds == 1 ? name + ".0" : name;
}

LinearModel model_for(const Configuration& c, const ResponseQuestion& question, bool& opened) {
  opened = feeds_back(c.prepared().model(), question.input);
  if (!opened) {
    if (question.output.empty())
      throw OptionError("output",
                        "needs a name: an output of the scene, or a coordinate or tip that 'withy linearize' lists");
    return one_of(linear_model(c, {{question.input}, {coordinate_of(c.prepared().model(), question.output)}}),
                  question);
  }
  if (!question.output.empty())
    throw OptionError("output", "'" + question.input +
                                    "' feeds back: its loop is opened, and the output is what it "
                                    "answers; leave --output out");
  return open_loop(c, question.input);
}

/// Whether a root stands for s = 0: those are found by rank.
bool at_zero(const LinearSystem& s, Complex root) { return root == (s.sampled() ? 1.0 : 0.0); }

/// At so many frequencies a decade and about the roots [rad/s].
std::vector<ResponseAt> values_between(const TransferFunction& G, const Response& r, std::pair<double, double> ends,
                                       int per_decade) {
  Eigen::VectorXcd marks(r.roots.poles.size() + r.roots.zeros.size());
  marks << r.roots.poles, r.roots.zeros;
  std::vector<ResponseAt> values = frequency_response(G, ends.first, ends.second, per_decade, marks);
  // At half the rate of the samples, z = −1, where one of the zeros is: no rounding of it.
  const LinearSystem& s = r.model.system;
  const auto at_half_rate = [](Complex root) { return std::abs(root + 1.0) <= 1e-7 * pi; };
  if (s.sampled() && !values.empty() && values.back().omega >= pi / s.period &&
      std::any_of(r.roots.zeros.begin(), r.roots.zeros.end(), at_half_rate))
    values.back().value = 0;
  return values;
}

/// G(0), or the limit of s^integrators G, as ∏ (s − zero) / ∏ (s − pole) has it.
void find_static_gain(const TransferFunction& G, double gain, Response& r) {
  const LinearSystem& s = r.model.system;
  const auto zero = [&](Complex root) { return at_zero(s, root); };
  const auto held = std::count_if(r.roots.poles.begin(), r.roots.poles.end(), zero);
  const auto lost = std::count_if(r.roots.zeros.begin(), r.roots.zeros.end(), zero);
  r.integrators = static_cast<int>(std::max<std::ptrdiff_t>(0, held - lost));
  if (lost > held) return;
  const Complex here = s.sampled() ? 1.0 : 0.0;
  if (std::none_of(r.every.begin(), r.every.end(), zero)) {
    r.static_gain = G(here)(0, 0).real();
    return;
  }
  Complex logarithm = std::log(Complex(gain));
  for (const Complex z : r.roots.zeros)
    if (!zero(z)) logarithm += std::log(here - z);
  for (const Complex p : r.roots.poles)
    if (!zero(p)) logarithm -= std::log(here - p);
  r.static_gain = std::exp(logarithm).real();
  // (z − 1)ⁿ is (s T)ⁿ near s = 0.
  if (s.sampled()) r.static_gain /= std::pow(s.period, r.integrators);
}

/// Residues of simple poles from zeros, poles and gain.
void find_participation(double gain, Response& r) {
  r.participation.assign(static_cast<std::size_t>(r.roots.poles.size()), 0.0);
  if (r.model.system.sampled()) return;
  double sum = 0;
  for (Eigen::Index i = 0; i < r.roots.poles.size(); ++i) {
    const Complex p = r.roots.poles[i];
    if (p == 0.0) continue;
    Complex logarithm = std::log(Complex(gain)) - std::log(p);
    for (const Complex z : r.roots.zeros) logarithm += std::log(p - z);
    for (Eigen::Index j = 0; j < r.roots.poles.size(); ++j)
      if (j != i) logarithm -= std::log(p - r.roots.poles[j]);
    const double share = std::exp(logarithm.real());
    if (!std::isfinite(share)) continue;  // a double pole has no residue
    r.participation[static_cast<std::size_t>(i)] = share;
    sum += share;
  }
  for (double& share : r.participation) share = sum > 0 ? share / sum : 0.0;
}

/// A decade around the poles [rad/s] or, where all of these are at zero, the zeros; of a loop the zeros count as well,
/// and it is looked at until its gain is one.
std::pair<double, double> decades(const TransferFunction& G, const Response& r, bool loop) {
  const LinearSystem& s = r.model.system;
  const double half_rate = s.sampled() ? pi / s.period : std::numeric_limits<double>::infinity();
  double low = std::numeric_limits<double>::infinity(), high = 0;
  const auto meet = [&](const Eigen::VectorXcd& roots, double least) {
    for (const Complex root : roots) {
      const double size = std::abs(exponent_of(s, root));
      // What is over before the next sample has no frequency.
      if (at_zero(s, root) || !(size < 2 * half_rate) || size < least) continue;
      low = std::min(low, size);
      high = std::max(high, size);
    }
  };
  meet(r.roots.poles, 0);
  const double fastest = high;
  // Zeros far below the poles are rounding of zero; far beyond them, of nothing in the leading coefficient.
  if (loop || !(high > 0)) meet(r.roots.zeros, high > 0 ? 1e-4 * low : 0);
  if (fastest > 0) high = fastest;
  if (!(high > 0)) low = high = std::min(2 * pi, half_rate);
  high = s.sampled() && loop ? half_rate : std::min(10 * high, half_rate);
  low = std::min(low / 10, high / 10);
  const auto gain = [&](double omega) { return std::abs(G.at_frequency(omega)); };
  constexpr int farthest = 6;  // decades
  const bool falls = loop && !s.sampled() && std::abs(s.D(0, 0)) < 1;
  for (int k = 0; falls && k < farthest && gain(high) > 1; ++k) high *= 10;
  for (int k = 0; loop && k < farthest && r.integrators > 0 && gain(low) < 1; ++k) low /= 10;
  return {low, high};
}

/// The ends of the frequencies [rad/s].
std::pair<double, double> ends(const ResponseQuestion& question, const TransferFunction& G, const Response& r) {
  auto [low, high] = decades(G, r, r.opened);
  const double half_rate = r.model.system.sampled() ? pi / r.model.system.period : high;
  if (question.from) low = 2 * pi * *question.from;
  if (question.to) high = 2 * pi * *question.to;
  if (!(low > 0) || !(high > low))
    throw InputError(fmt::format("frequencies from {:g} to {:g} Hz: need above 0, and the end above the beginning",
                                 low / (2 * pi), high / (2 * pi)));
  if (r.model.system.sampled() && low >= half_rate)
    throw OptionError("from", fmt::format("half the rate of the samples is {:g} Hz; need a frequency below it",
                                          half_rate / (2 * pi)));
  return {low, high};
}

/// Of the loop at all frequencies, whichever are shown.
void find_margins(const TransferFunction& G, const ResponseQuestion& question, Response& r) {
  const int enough = ResponseQuestion{}.per_decade;
  const bool shown = r.opened && !question.from && !question.to && question.per_decade >= enough;
  const std::vector<ResponseAt> whole =
      shown ? r.values : values_between(G, r, decades(G, r, true), std::max(enough, question.per_decade));
  try {
    r.margins = margins(G, whole, r.roots.hidden, r.integrators > 0 ? std::optional<double>() : r.static_gain);
  } catch (const std::domain_error&) {  // the closed loop is not well posed
    r.margins.reset();
  }
}

/// What a command line refuses before it is read, for those who ask otherwise.
void check(const ResponseQuestion& question) {
  constexpr int least = 5, most = 100000;
  if (question.per_decade < least || question.per_decade > most)
    throw OptionError("points", fmt::format("got {}; need {} to {} a decade", question.per_decade, least, most));
  if (question.reduce && *question.reduce < 0)
    throw OptionError("reduce", fmt::format("got {}; need a number of states", *question.reduce));
}

}  // namespace

Response response(const Configuration& c, const ResponseQuestion& question) {
  check(question);
  Response r;
  r.model = model_for(c, question, r.opened);
  if (r.opened && !r.model.system.sampled()) r.follows = commands_followed(c, question.input);
  const LinearSystem& s = r.model.system;
  const ZerosAndGain found = zeros(s);
  const KnownRoots every = known_poles(s);
  if (found.gain == 0 || !is_felt(s, every.values))
    throw Unfelt(
        r.opened ? fmt::format("the loop of '{0}' is open at this state: what it measures does not feel its effort, or "
                               "'{0}' or a load before it is at a limit",
                               r.model.inputs[0].name)
                 : fmt::format("the output {} does not feel the input {} at this state", r.model.outputs[0].name,
                               r.model.inputs[0].name));
  r.every = every.values;
  r.roots = seen_roots(s, every, found.zeros);
  const TransferFunction G(s);
  find_static_gain(G, found.gain, r);
  find_participation(found.gain, r);
  r.values = values_between(G, r, ends(question, G, r), question.per_decade);
  r.peaks = peaks(G, r.values, r.roots.poles);
  // Of equations that change, one instant tells no stability: there is nothing to be far from.
  if (!r.model.frozen) find_margins(G, question, r);
  if (!question.reduce) return r;
  r.reduction = balanced_truncation(s, *question.reduce);
  const TransferFunction smaller(r.reduction->system);
  for (const ResponseAt& at : r.values)
    r.reduction_error = std::max(r.reduction_error, std::abs(smaller.at_frequency(at.omega) - at.value));
  return r;
}

}  // namespace withy::study
