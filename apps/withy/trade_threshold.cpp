#include <nlohmann/json.hpp>
#include <optional>

#include "withy/apps/withy/configuration.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/apps/withy/trade_axes.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/threshold_files.hpp"
#include "withy/results/trade_files.hpp"
#include "withy/study/accuracy.hpp"

namespace withy::app {
namespace {

constexpr std::size_t scanned = 9;  ///< values of the range that are looked at first

/// What the user asked for.
struct Question {
  study::Sweep range;
  double limit = 0;
  study::Axes axes;
  std::vector<std::string> over;  ///< without the range
};

Question read_question(const TradeArguments& arguments) {
  Question q;
  q.limit = study::read_shares({arguments.limit}, "limit").front();
  q.axes = arguments.axes;
  for (const std::string& over : arguments.over) {
    const bool range = over.find(':') != std::string::npos;
    if (range && !q.range.none()) throw InputError("--over: with --limit one range is gone along; got '" + over + "'");
    if (range) q.range = study::parse_sweep(over, "over", scanned);
    if (!range) q.over.push_back(over);
  }
  if (q.range.none()) throw InputError("--limit: need the range that it is sought in, as --over spin.axle=0:4");
  if (q.range.values.front() == q.range.values.back()) throw InputError("--over: the range has no length");
  if (arguments.measure == "frequencies") {  // integration has no part in them
    q.axes.integrators = {"dopri5"};
    q.axes.tolerances = {1e-6};
  } else if (!q.range.spun().empty()) {
    throw InputError("--over: '" + q.range.path +
                     "' holds a hinge at a rate, which is for --measure frequencies; "
                     "give a path of the scene, as motions.spin.rate");
  }
  return q;
}

std::optional<study::Thresholds> found(const Engine& engine, const TradeArguments& arguments, const Question& q) {
  const std::vector<study::Point> points = points_of(q.axes, q.over, engine);
  const study::Control control = study_control("trade");
  if (arguments.measure == "frequencies") {
    const study::Holding holding = study::read_holding(engine.model(), arguments.lock, arguments.spin);
    return study::thresholds_of_frequencies(engine.prepared(), engine.registry(),
                                            {points, q.range, holding, arguments.count}, q.limit, control);
  }
  std::optional<TradeFolder> store;
  if (!arguments.out.empty())
    store.emplace(arguments.out, trade_fingerprint(engine.prepared(), points, engine.registry(), arguments.outputs));
  return study::thresholds_of_runs(engine.prepared(), engine.registry(), points, q.range, q.limit,
                                   {arguments.jobs, store ? &*store : nullptr, control, arguments.outputs});
}

}  // namespace

ExitStatus trade_threshold(const TradeArguments& arguments) {
  const Question q = read_question(arguments);
  const bool frequencies = arguments.measure == "frequencies";
  const Engine engine(arguments);
  const auto taken =
      take_folder(arguments, "trade", provenance_of(engine.scene(), engine.plugins()), threshold_content());
  const auto thresholds = found(engine, arguments, q);
  if (!thresholds) return ExitStatus::interrupted;
  const ThresholdLabels labels{!arguments.axes.families.empty(), arguments.over.size() > 1, frequencies};
  const nlohmann::ordered_json j = thresholds_json(arguments.scene, arguments.measure, q.limit, q.range, *thresholds);
  const std::string title = threshold_title(arguments.scene, frequencies, q.limit);
  if (!arguments.out.empty()) write_thresholds(arguments.out, j, title, *thresholds, q.range, q.limit, labels);
  if (arguments.json) {
    print(json_text(j));
    return ExitStatus::done;
  }
  std::string text = threshold_text(title, *thresholds, q.range, labels);
  if (!arguments.out.empty()) text += "\nlimit.csv, limit.svg and limit.json in " + arguments.out + '\n';
  print(text);
  return ExitStatus::done;
}

}  // namespace withy::app
