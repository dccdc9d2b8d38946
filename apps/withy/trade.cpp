#include <nlohmann/json.hpp>
#include <optional>

#include "withy/apps/withy/results.hpp"
#include "withy/apps/withy/trade_axes.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/trade_files.hpp"
#include "withy/results/trade_text.hpp"
#include "withy/study/accuracy.hpp"

namespace withy::app {

std::vector<study::Point> points_of(study::Axes axes, const std::vector<std::string>& over, const Engine& engine) {
  for (const std::string& text : over) axes.over.push_back(study::parse_variation(text));
  return study::points_of(study::trade_axes(std::move(axes), engine.scene(), engine.registry()));
}

namespace {

ExitStatus trade(const TradeArguments& arguments) {
  if (!arguments.limit.empty() && !arguments.accuracy.empty())
    throw InputError("--accuracy names the cheapest models of a trade; with --limit there is none");
  if (!arguments.limit.empty()) return trade_threshold(arguments);
  if (arguments.measure != "runs" || !arguments.lock.empty() || !arguments.spin.empty())
    throw InputError(
        "--measure frequencies, --lock and --spin go with --limit; frequencies over a range are what "
        "withy modes --sweep shows");
  const std::vector<double> shares =
      arguments.accuracy.empty() ? usual_shares() : study::read_shares(arguments.accuracy, "accuracy");
  const Engine engine(arguments);
  const std::vector<study::Point> points = points_of(arguments.axes, arguments.over, engine);
  std::optional<TradeFolder> store;
  const auto taken = take_folder(arguments, "trade", provenance_of(engine.scene(), engine.plugins()), trade_content());
  if (taken)
    store.emplace(arguments.out, trade_fingerprint(engine.prepared(), points, engine.registry(), arguments.outputs));
  study::TradeStudy study(engine.prepared(), engine.registry(), points,
                          {arguments.jobs, store ? &*store : nullptr, study_control("trade"), arguments.outputs});
  const bool whole = study.run();
  const auto results = study.results();
  const auto front = study::pareto_front(results);
  const std::string title = engine.prepared().title();
  const nlohmann::ordered_json j = trade_json(engine.scene(), study, results, front, shares);
  std::string text =
      arguments.json ? json_text(j) : trade_text(title, study, results, front, engine.registry(), shares);
  if (!arguments.out.empty()) {
    write_trade(arguments.out, engine.prepared(), j, results, front, study.outputs(), engine.registry(),
                arguments.plugin_directories);
    if (!arguments.json) text += folder_text(arguments.out, "trade.csv, trade.svg and trade.json");
  }
  print(text);
  if (whole) return ExitStatus::done;
  if (store) complain("interrupted; the same command goes on from there");
  return ExitStatus::interrupted;
}

void add_trade(Options& o, TradeArguments& a) {
  add_scene(o, a);
  o.list("--formulations,--formulation", a.axes.formulations, "ID,ID,...",
         "Formulations; default: all that take part in studies, plugins' too");
  o.list("--families,--family", a.axes.families, "ID,ID,...", "Mode families of bending; default: the scene's");
  o.list("--modes", a.axes.modes, "N,N,...", "Modes of each family of a beam; default: 1,2,3");
  o.list("--integrators", a.axes.integrators, "ID,ID,...",
         "Integrators with a relative tolerance; default: dopri5,imex");
  o.list("--tolerances", a.axes.tolerances, "R,R,...", "Relative tolerances; default: 1e-4,1e-6");
  o.repeated("--over", a.over, "PATH=VALUE,VALUE,...", "Trade at each of these values of the scene; repeatable");
  o.list("--accuracy", a.accuracy, "SHARE,...",
         "Errors, of each output's own range, that the cheapest model is named of; default: 10%,1%,0.1%");
  o.value("--limit", a.limit, "SHARE",
          "Find where along --over PATH=FROM:TO[:COUNT] each model's error passes this share, as 1%");
  o.value("--measure", a.measure, "WHAT", "With --limit: errors of runs, or of frequencies")
      .among({"runs", "frequencies"})
      .with_default();
  o.value("--count", a.count, "N", "Lowest modes whose frequencies are compared")
      .between(std::size_t{1}, std::size_t{1000})
      .with_default();
  o.list("--lock", a.lock, "HINGE,HINGE,...", "Of frequencies: hinges that are held");
  o.list("--spin", a.spin, "HINGE=RATE,...", "Of frequencies: hinges held at a constant rate");
  o.list("--outputs,--output", a.outputs, "NAME,...",
         "What errors are measured on: hinges, BODY.tip, BODY.tip.deflection, outputs (root.mz, shoulder.effort)");
  o.value("--jobs", a.jobs, "N", "Points run at once; default: one a core");
  add_output(o, a, "Folder for table and picture, and for finished points: the same command continues");
}

}  // namespace

const Command trade_command = {
    "trade", "Weigh error against cost over formulations, modes, integrators and tolerances",
    "  withy trade scenes/screw.yaml --formulations ruthless,quadratic --modes 1,2\n"
    "  withy trade scenes/two-link-slew.yaml --set time.end=1 --modes 2 --tolerances 1e-4 "
    "--over loads.slew.time_scale=0.5,1 --out results/trade\n"
    "  withy trade scenes/rotating-blade.yaml --measure frequencies --limit 1% --over spin.axle=0:3.5 "
    "--formulations ruthless,inconsistent,quadratic --modes 2",
    &taking<TradeArguments, add_trade, trade>};

}  // namespace withy::app
