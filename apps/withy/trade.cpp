#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/formulation_words.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/apps/withy/trade_axes.hpp"
#include "withy/core/plugin/formulation_ladder.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/text_table.hpp"
#include "withy/results/trade_files.hpp"

namespace withy::app {
namespace {

std::string table_text(const std::vector<study::TradeResult>& results, const std::vector<bool>& front,
                       const study::Outputs& outputs) {
  const auto any = [&](auto&& has) { return std::any_of(results.begin(), results.end(), has); };
  const bool families = any([](const study::TradeResult& r) { return !r.point.family.empty(); });
  const bool overs = any([](const study::TradeResult& r) { return !r.point.over.empty(); });
  const bool hinges = outputs.has(study::Measure::angle) || outputs.has(study::Measure::slide),
             tips = outputs.has(study::Measure::place);
  std::vector<std::string> head = {"<", "<formulation", "modes"};
  if (families) head.emplace_back("<family");
  if (overs) head.emplace_back("<over");
  for (const char* h :
       {"<integrator", "tolerance", "<outcome", "hinge\nerror", "tip error\n[mm]", "error\n[%]", "steps", "CPU\n[ms]"})
    head.emplace_back(h);
  TextTable table(head);
  for (std::size_t i = 0; i < results.size(); ++i) {
    const study::TradeResult& r = results[i];
    std::vector<std::string> row = {front[i] ? "*" : "", r.point.formulation, std::to_string(r.point.modes)};
    if (families) row.push_back(r.point.family.empty() ? "scene's" : r.point.family);
    if (overs) row.push_back(trade_over_text(r.point));
    row.push_back(r.point.integrator);
    row.push_back(fmt::format("{:g}", r.point.tolerance));
    row.push_back(r.status);
    if (r.completed()) {
      for (std::string& cell : std::vector<std::string>{
               hinges ? fmt::format("{:.3g}", r.hinge_error) : "-",
               tips ? fmt::format("{:.3g}", 1e3 * r.tip_error) : "-", fmt::format("{:.3g}", 100 * r.relative_error),
               std::to_string(r.steps), fmt::format("{:.2f}", 1e3 * r.cpu_seconds)})
        row.push_back(std::move(cell));
    } else {
      row.insert(row.end(), 5, "-");
    }
    table.add(std::move(row));
  }
  return table.str();
}

/// The answer: of each set of values gone over the cheapest models within some errors.
std::string cheapest_text(const std::vector<study::TradeResult>& results) {
  std::map<std::string, std::vector<const study::TradeResult*>> by_over;
  for (const study::TradeResult& r : results)
    if (r.completed()) by_over[trade_over_text(r.point)].push_back(&r);
  std::string out;
  for (const auto& [over, done] : by_over) {
    for (const double limit : {0.1, 0.01, 0.001}) {
      const study::TradeResult* best = nullptr;
      for (const study::TradeResult* r : done)
        if (r->relative_error <= limit && (best == nullptr || r->cpu_seconds < best->cpu_seconds)) best = r;
      const std::string within = fmt::format("within {:g} %{}", 100 * limit, over.empty() ? "" : " at " + over);
      out += best == nullptr ? fmt::format("{:<12} none of these models\n", within)
                             : fmt::format("{:<12} {}: {:.2g} % off, {:.3g} ms\n", within, best->point.text(),
                                           100 * best->relative_error, 1e3 * best->cpu_seconds);
    }
  }
  return out.empty() ? out : "Cheapest:\n" + out + '\n';
}

/// Reasons of the points that failed, each said once.
std::string reasons_text(const std::vector<study::TradeResult>& results) {
  std::map<std::string, std::pair<std::string, std::size_t>> reasons;  // by formulation, integrator and status
  for (const study::TradeResult& r : results) {
    if (r.completed()) continue;
    auto& [text, count] = reasons[r.point.formulation + ' ' + r.point.integrator + ' ' + r.status];
    if (text.empty()) text = r.point.text() + ": " + r.message;
    ++count;
  }
  std::string out;
  for (const auto& [key, reason] : reasons) {
    out += "\n" + reason.first;
    if (reason.second > 1) out += fmt::format(" ({} more like it)", reason.second - 1);
    out += '\n';
  }
  return out;
}

std::vector<std::string> formulations_of(const std::vector<study::TradeResult>& results) {
  std::vector<std::string> names;
  for (const study::TradeResult& r : results) names.push_back(r.point.formulation);
  return names;
}

std::string references_text(const study::TradeStudy& study) {
  std::string out;
  for (const auto& [over, r] : study.references()) {
    out += fmt::format(
        "Reference{}: {}, {} modes, {} at {:g}; its own error, against one mode less and ten times the tolerance: "
        "hinges {:.2g}, tips {:.2g} mm, {:.2g} %.\n",
        over.empty() ? "" : " at " + over, r.point.formulation, r.point.modes, r.point.integrator, r.point.tolerance,
        r.hinge_error, 1e3 * r.tip_error, 100 * r.relative_error);
  }
  return out;
}

}  // namespace

study::Axes axes_of(const TradeAxes& asked, Registry& registry) {
  study::Axes axes{asked.formulations, asked.families, asked.modes, asked.integrators, asked.tolerances, {}};
  for (const std::string& over : asked.over) axes.over.push_back(parse_variation(over));
  if (axes.formulations.empty()) axes.formulations = studied_formulations(registry);
  study::check_axes(axes);
  return axes;
}

namespace {

ExitStatus trade(const TradeArguments& arguments) {
  if (!arguments.limit.empty()) return trade_threshold(arguments);
  if (arguments.measure != "runs" || !arguments.lock.empty() || !arguments.spin.empty())
    throw InputError(
        "--measure frequencies, --lock and --spin go with --limit; frequencies over a range are what "
        "withy modes --sweep shows");
  const Engine engine(arguments);
  const std::vector<study::Point> points = study::points_of(axes_of(arguments.axes, engine.registry()));
  std::optional<TradeFolder> store;
  const auto taken = take_folder(arguments, "trade", provenance_of(engine.scene(), engine.plugins()),
                                 {"trade.json", "trade.csv", "trade.svg", report_name});
  if (taken)
    store.emplace(arguments.out, trade_fingerprint(engine.prepared(), points, engine.registry(), arguments.outputs));
  study::TradeStudy study(engine.prepared(), engine.registry(), points,
                          {arguments.jobs, store ? &*store : nullptr, study_control("trade"), arguments.outputs});
  const bool whole = study.run();
  const auto results = study.results();
  const auto front = study::pareto_front(results);
  const std::string title = engine.prepared().title();
  const nlohmann::ordered_json j = trade_json(engine.scene(), study, results, front);
  std::string text =
      arguments.json
          ? json_text(j)
          : title + "\n\n" + cheapest_text(results) + table_text(results, front, study.outputs()) +
                "\n*: no other point is both more accurate, as far as the reference can tell, and cheaper. Error "
                "in % of each output's own range, the greatest of all.\n" +
                references_text(study) + formulation_words(formulations_of(results), engine.registry()) +
                reasons_text(results);
  if (!arguments.out.empty()) {
    const std::filesystem::path folder = arguments.out;
    write_file(folder / "trade.json", json_text(j));
    write_file(folder / "trade.csv", trade_csv(results, front));
    write_file(folder / "trade.svg", trade_picture(title, results, front));
    if (has_report_page())
      write_study_page(folder / report_name, "trade", title,
                       trade_page(engine.prepared(), j, results, engine.registry()));
    if (!arguments.json)
      text += fmt::format("\ntrade.csv, trade.svg and trade.json in {}{}\n", arguments.out,
                          has_report_page() ? ", to look at in its report.html" : "");
  }
  print(text);
  if (whole) return ExitStatus::done;
  if (store) complain("interrupted; the same command goes on from there");
  return ExitStatus::interrupted;
}

std::function<ExitStatus()> add_trade(CLI::App& c) {
  const auto arguments = std::make_shared<TradeArguments>();
  TradeArguments& a = *arguments;
  add_scene(c, a);
  add_formulations(c, a.axes.formulations, "--formulations,--formulation",
                   "Formulations; default: all that take part in studies, plugins' too");
  c.add_option("--families,--family", a.axes.families, "Mode families of bending; default: the scene's")
      ->type_name("ID,ID,...")
      ->delimiter(',');
  c.add_option("--modes", a.axes.modes, "Modes of each family of a beam; default: 1,2,3")
      ->type_name("N,N,...")
      ->delimiter(',');
  c.add_option("--integrators", a.axes.integrators, "Integrators with a relative tolerance; default: dopri5,imex")
      ->type_name("ID,ID,...")
      ->delimiter(',');
  c.add_option("--tolerances", a.axes.tolerances, "Relative tolerances; default: 1e-4,1e-6")
      ->type_name("R,R,...")
      ->delimiter(',');
  c.add_option("--over", a.axes.over, "Trade at each of these values of the scene; repeatable")
      ->type_name("PATH=VALUE,VALUE,...")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->expected(1)
      ->allow_extra_args(false);
  c.add_option("--limit", a.limit,
               "Find where along --over PATH=FROM:TO[:COUNT] each model's error passes this share, as 1%")
      ->type_name("SHARE");
  c.add_option("--measure", a.measure, "With --limit: errors of runs, or of frequencies")
      ->type_name("WHAT")
      ->check(CLI::IsMember({"runs", "frequencies"}))
      ->capture_default_str();
  c.add_option("--count", a.count, "Lowest modes whose frequencies are compared")
      ->type_name("N")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1000}))
      ->capture_default_str();
  c.add_option("--lock", a.lock, "Of frequencies: hinges that are held")->type_name("HINGE,HINGE,...")->delimiter(',');
  c.add_option("--spin", a.spin, "Of frequencies: hinges held at a constant rate")
      ->type_name("HINGE=RATE,...")
      ->delimiter(',');
  c.add_option(
       "--outputs,--output", a.outputs,
       "What errors are measured on: hinges, BODY.tip, BODY.tip.deflection, outputs of the scene (root, root.mz)")
      ->type_name("NAME,...")
      ->delimiter(',');
  c.add_option("--jobs", a.jobs, "Points run at once; default: one a core")->type_name("N");
  add_output(c, a, "Folder for table and picture, and for finished points: the same command continues");
  return [arguments] { return trade(*arguments); };
}

}  // namespace

const Command trade_command = {
    "trade", "Weigh error against cost over formulations, modes, integrators and tolerances",
    "  withy trade scenes/screw.yaml --formulations ruthless,quadratic --modes 1,2\n"
    "  withy trade scenes/two-link-slew.yaml --set time.end=1 --modes 2 --tolerances 1e-4 "
    "--over loads.slew.time_scale=0.5,1 --out results/trade\n"
    "  withy trade scenes/rotating-blade.yaml --measure frequencies --limit 1% --over spin.axle=0:3.5 "
    "--formulations ruthless,inconsistent,quadratic --modes 2",
    &add_trade};

}  // namespace withy::app
