#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/sweep.hpp"
#include "withy/campaign/collect.hpp"
#include "withy/campaign/sweep_page.hpp"
#include "withy/campaign/sweep_run.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/scene/units.hpp"

namespace withy::app {
namespace {

using Json = nlohmann::ordered_json;

/// "2/8".
void read_shard(const std::string& text, campaign::SweepSettings& settings) {
  if (text.empty()) return;
  const std::size_t slash = text.find('/');
  const auto shard = plain_number(std::string_view(text).substr(0, slash));
  const auto shards =
      slash == std::string::npos ? std::nullopt : plain_number(std::string_view(text).substr(slash + 1));
  const auto whole = [](double x) {
    return x >= 1 && x <= 1e6 && x == static_cast<double>(static_cast<std::uint64_t>(x));
  };
  if (!shard || !shards || !whole(*shard) || !whole(*shards) || *shard > *shards)
    throw InputError("--shard: got '" + text + "'; need I/N, the parts of N counted from 1, as 1/4 to 4/4");
  settings.shard = static_cast<std::uint64_t>(*shard);
  settings.shards = static_cast<std::uint64_t>(*shards);
}

Json json_of(const campaign::Collected& c) {
  Json j = {{"cases", c.cases}, {"done", c.done}, {"failed", c.failed}, {"missing", c.cases - c.done}};
  if (c.done > 0)
    j["failed_share"] = {{"value", c.failed_share.value}, {"low", c.failed_share.low}, {"high", c.failed_share.high}};
  j["files"] = {"table.csv", "failed.csv"};
  if (c.statistics) j["files"].push_back("statistics.csv");
  if (c.indices) j["files"].push_back("indices.csv");
  if (c.histories) j["files"].insert(j["files"].end(), {"histories.csv", "histories.svg"});
  if (has_report_page()) j["files"].push_back(report_name);
  return j;
}

std::string collected_text(const campaign::Collected& c, const std::string& store) {
  std::string text = fmt::format("{} cases: {} done, {} missing", c.cases, c.done, c.cases - c.done);
  if (c.failed > 0)
    text += fmt::format(
        "\n{} failed, {:.3g} % of those done ({:.3g} to {:.3g} % with 95 % confidence, were they drawn at random): "
        "why, "
        "and the command that repeats each, is in failed.csv",
        c.failed, 100 * c.failed_share.value, 100 * c.failed_share.low, 100 * c.failed_share.high);
  text += "\ntable.csv";
  if (c.statistics) text += ", statistics.csv";
  if (c.indices) text += ", indices.csv";
  if (c.histories) text += ", histories.csv, histories.svg";
  return text + " in " + store + (has_report_page() ? ", to look at in its report.html\n" : "\n");
}

campaign::Collected collected_with_page(const std::string& store) {
  const campaign::Collected collected = campaign::collect(store);
  campaign::write_sweep_page(store, collected);
  return collected;
}

std::string lost_text(std::uint64_t bytes) {
  return fmt::format(
      "{} bytes of the store belong to no result: damage, or a process was killed as it wrote; the cases "
      "they were of are run again",
      bytes);
}

}  // namespace

ExitStatus sweep_run(const SweepArguments& arguments) {
  const Plugins plugins(arguments);
  campaign::SweepSettings settings;
  settings.jobs = arguments.jobs;
  read_shard(arguments.shard, settings);
  const campaign::Plan plan = read_plan(arguments, plugins.registry());
  const campaign::Store store(arguments.store, plan, arguments.force);
  settings.control = study_control("sweep");
  const campaign::SweepOutcome outcome = run_sweep(plan, plugins.registry(), store, settings);
  const bool whole = outcome.whole() && settings.shards == 1;
  if (outcome.lost > 0) complain(lost_text(outcome.lost));
  std::string text =
      fmt::format("{} cases{}: {} now in {:.3g} s, {} before\n", outcome.cases,
                  settings.shards > 1 ? fmt::format(" of part {} of {}", settings.shard, settings.shards) : "",
                  outcome.ran, outcome.seconds, outcome.before);
  if (outcome.alone > 0 && !outcome.alone_because.empty())
    text += fmt::format("{} evaluated one at a time, not four at once: {}\n", outcome.alone, outcome.alone_because);
  if (outcome.failure)
    text += fmt::format("{} failed, the first of them case {}: {}\n", outcome.failed, outcome.failure->index,
                        outcome.failure->message);
  Json j = {{"cases", outcome.cases},   {"before", outcome.before},   {"ran", outcome.ran},
            {"failed", outcome.failed}, {"seconds", outcome.seconds}, {"store", arguments.store}};
  j["one_at_a_time"] = outcome.alone;
  if (!outcome.alone_because.empty()) j["one_at_a_time_because"] = outcome.alone_because;
  if (whole) {
    const campaign::Collected collected = collected_with_page(arguments.store);
    text += collected_text(collected, arguments.store);
    j["collected"] = json_of(collected);
  }
  print(arguments.json ? json_text(j) : text);
  if (outcome.whole()) return ExitStatus::done;
  const bool failed = plan.stop_on_failure && outcome.failure;
  complain(failed ? fmt::format("stopped, as the plan says, at case {}", outcome.failure->index)
                  : "interrupted; the same command goes on from there");
  return failed ? ExitStatus::stopped : ExitStatus::interrupted;
}

ExitStatus sweep_status(const SweepArguments& arguments) {
  const campaign::StoreDescription about = campaign::read_description(arguments.store);
  const campaign::StoreIndex index(arguments.store, about);
  const std::uint64_t missing = about.size - index.done();
  Json j = {{"cases", about.size},       {"done", index.done()},       {"failed", index.failed()},
            {"missing", missing},        {"writers", index.writers()}, {"cpu_seconds", index.seconds()},
            {"lost_bytes", index.lost()}};
  std::string text = fmt::format("{} cases: {} done, {} of them failed, {} missing\n", about.size, index.done(),
                                 index.failed(), missing);
  if (index.done() > 0) {
    const double each = index.seconds() / static_cast<double>(index.done());
    const double left =
        each * static_cast<double>(missing) / std::max<double>(1.0, static_cast<double>(index.writers()));
    j["seconds_left"] = left;
    text += fmt::format("{:.3g} s of CPU time, {:.3g} ms a case", index.seconds(), 1e3 * each);
    if (missing > 0)
      text += fmt::format("; about {:.3g} s left {}", left,
                          index.writers() > 0 ? fmt::format("with the {} threads at work", index.writers())
                                              : "for one thread; nothing runs now");
    text += '\n';
  }
  if (index.lost() > 0 && index.writers() == 0) text += lost_text(index.lost()) + '\n';
  print(arguments.json ? json_text(j) : text);
  return ExitStatus::done;
}

ExitStatus sweep_collect(const SweepArguments& arguments) {
  const campaign::Collected collected = collected_with_page(arguments.store);
  print(arguments.json ? json_text(json_of(collected)) : collected_text(collected, arguments.store));
  return ExitStatus::done;
}

}  // namespace withy::app
