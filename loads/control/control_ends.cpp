#include <algorithm>
#include <cmath>

#include "withy/loads/control/control_load.hpp"
#include "withy/loads/sampled.hpp"

namespace withy {
namespace {

std::vector<std::string> texts_of(const Value& p, const char* key) {
  std::vector<std::string> all;
  if (const Value* given = p.find(key))
    for (const Value& item : given->items()) all.push_back(item.text());
  return all;
}

}  // namespace

std::vector<ParameterSpec> control_parameters(std::vector<ParameterSpec> own) {
  std::vector<ParameterSpec> all{
      texts("of", "what is measured: columns of hinges, numbers of outputs, what other loads give")
          .naming(ParameterSpec::Refers::signal)
          .optional(),
      texts("to", "loads of type input, to whose value the command is added; nothing: other loads measure it")
          .naming(ParameterSpec::Refers::input)
          .one_of({"nothing"})
          .optional(),
      text("hinge", "hinge whose rate it drives, where there is no 'to'")
          .naming(ParameterSpec::Refers::hinge)
          .optional(),
      integer("component", "which of the hinge's rates, counted from 0, which is the default").least(0).optional(),
      sample_parameter(),
      number("delay", "s", "of a sampled controller, from a measurement to its effort: a multiple of the sample")
          .least(0)
          .optional()};
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

std::optional<ControlEnds> read_signal_ends(const Value& p, const MakeContext& context, std::size_t signals) {
  Value with_end = p;
  if (!p.has("to") && !p.has("hinge")) with_end.set("to", Value::list({Value(std::string("nothing"))}));
  std::optional<ControlEnds> ends = read_ends(with_end, context);
  if (!ends) return {};
  if (ends->of.size() > signals || (ends->of.empty() && signals > 0 && !ends->hinge)) {
    context.diagnostics.error(p.place(), "needs 'of' with one signal");
    return {};
  }
  ends->measures_nothing = ends->of.empty() && signals == 0;
  return ends;
}

std::optional<ControlEnds> read_ends(const Value& p, const MakeContext& context) {
  ControlEnds ends;
  bool good = true;
  const auto error = [&](const Value& at, const std::string& message) {
    context.diagnostics.error(at.place(), message);
    good = false;
  };
  ends.of = texts_of(p, "of");
  ends.to = texts_of(p, "to");
  if (ends.to == std::vector<std::string>{"nothing"}) {
    ends.acts = false;
    ends.to.clear();
  }
  if (p.has("hinge")) ends.hinge = RateName{p.text_at("hinge"), p.has("component") ? p.count_at("component") : 0};
  if (!p.has("hinge") && p.has("component")) error(p.at("component"), "needs a 'hinge'");
  if (!p.has("hinge") && ends.to.empty() && ends.acts)
    error(p, "acts nowhere; need 'hinge', or 'to' with a load of type input");
  ends.sample = sample_period(p);
  const Value* delay = p.find("delay");
  if (delay != nullptr && delay->number() > 0 && !(ends.sample > 0)) {
    error(*delay,
          "a continuous controller has no delay of its own: give a 'sample', of which the delay is a multiple, or put "
          "a load of type 'delay' between, which a controller or an actuator measures");
  } else if (delay != nullptr && delay->number() > 0) {
    const double samples = delay->number() / ends.sample;
    ends.delay = static_cast<std::size_t>(std::llround(std::min(samples, 1e6)));
    if (samples < 1 - 1e-9) {
      error(*delay, "is shorter than a step: the controller acts once a sample; need a multiple of 'sample'");
    } else if (samples > 1000) {
      error(*delay, "is longer than 1000 samples");
    } else if (std::abs(samples - static_cast<double>(ends.delay)) > 1e-9 * samples) {
      error(*delay, "is no multiple of 'sample'");
    }
  }
  if (!good) return {};
  return ends;
}

}  // namespace withy
