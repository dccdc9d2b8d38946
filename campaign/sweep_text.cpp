#include "withy/campaign/sweep_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "withy/results/report/report_page.hpp"

namespace withy::campaign {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

Json outcome_json(const SweepOutcome& outcome, const std::string& store) {
  Json j = {{"cases", outcome.cases},   {"before", outcome.before},   {"ran", outcome.ran},
            {"failed", outcome.failed}, {"seconds", outcome.seconds}, {"store", store}};
  j["one_at_a_time"] = outcome.alone;
  if (!outcome.alone_because.empty()) j["one_at_a_time_because"] = outcome.alone_because;
  return j;
}

std::string outcome_text(const SweepOutcome& outcome, const SweepSettings& settings) {
  std::string text =
      fmt::format("{} cases{}: {} now in {:.3g} s, {} before\n", outcome.cases,
                  settings.shards > 1 ? fmt::format(" of part {} of {}", settings.shard, settings.shards) : "",
                  outcome.ran, outcome.seconds, outcome.before);
  if (outcome.alone > 0 && !outcome.alone_because.empty())
    text += fmt::format("{} evaluated one at a time, not in lanes: {}\n", outcome.alone, outcome.alone_because);
  if (outcome.failure) {
    // A message of a scene names the case that its values come from.
    const std::string who = fmt::format("case {}: ", outcome.failure->index), &why = outcome.failure->message;
    text += fmt::format("{} failed, the first of them {}{}\n", outcome.failed, why.starts_with(who) ? "" : who, why);
  }
  return text;
}

namespace {

/// How long the missing cases take.
struct Rest {
  std::uint64_t missing = 0;
  double each = 0, left = 0;  ///< [s]; 0 where nothing is done
};

Rest rest_of(const StoreDescription& about, const StoreIndex& index) {
  Rest rest{about.size - index.done()};
  if (index.done() == 0) return rest;
  rest.each = index.seconds() / static_cast<double>(index.done());
  rest.left =
      rest.each * static_cast<double>(rest.missing) / std::max<double>(1.0, static_cast<double>(index.writers()));
  return rest;
}

}  // namespace

Json status_json(const StoreDescription& about, const StoreIndex& index) {
  const Rest rest = rest_of(about, index);
  Json j = {{"cases", about.size},       {"done", index.done()},       {"failed", index.failed()},
            {"missing", rest.missing},   {"writers", index.writers()}, {"cpu_seconds", index.seconds()},
            {"lost_bytes", index.lost()}};
  if (index.done() > 0) j["seconds_left"] = rest.left;
  return j;
}

std::string status_text(const StoreDescription& about, const StoreIndex& index) {
  const Rest rest = rest_of(about, index);
  std::string text = fmt::format("{} cases: {} done, {} of them failed, {} missing\n", about.size, index.done(),
                                 index.failed(), rest.missing);
  if (index.done() > 0) {
    text += fmt::format("{:.3g} s of CPU time, {:.3g} ms a case", index.seconds(), 1e3 * rest.each);
    if (rest.missing > 0)
      text += fmt::format("; about {:.3g} s left {}", rest.left,
                          index.writers() > 0 ? fmt::format("with the {} threads at work", index.writers())
                                              : "for one thread; nothing runs now");
    text += '\n';
  }
  if (index.lost() > 0 && index.writers() == 0) text += lost_text(index.lost()) + '\n';
  return text;
}

Json collected_json(const Collected& c) {
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

std::string collected_text(const Collected& c, const std::string& store) {
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

std::string lost_text(std::uint64_t bytes) {
  return fmt::format(
      "{} bytes of the store belong to no result: damage, or a process was killed as it wrote; the cases "
      "they were of are run again",
      bytes);
}

}  // namespace withy::campaign
