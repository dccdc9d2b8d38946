#include "withy/campaign/sweep_run.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>

#include "withy/campaign/case_lanes.hpp"
#include "withy/scene/units.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/work_together.hpp"

namespace withy::campaign {
namespace {

/// What the threads of a sweep share.
class Workers {
 public:
  Workers(const Plan& plan, Registry& registry, const Store& store, const SweepSettings& settings)
      : plan_(plan), registry_(registry), store_(store), settings_(settings), cases_(plan) {}

  SweepOutcome run() {
    const auto began = std::chrono::steady_clock::now();
    look_up();
    const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
    const std::size_t jobs = std::clamp<std::size_t>(settings_.jobs > 0 ? settings_.jobs : cores, 1,
                                                     std::max<std::size_t>(1, outcome_.cases - outcome_.before));
    // All segments are taken before the first case runs: another process then has none of them.
    std::vector<std::unique_ptr<SegmentWriter>> segments;
    for (std::size_t j = 0; j < jobs; ++j)
      segments.push_back(
          std::make_unique<SegmentWriter>(store_.segment(settings_.shard, settings_.shards, j), plan_.fingerprint));
    study::work_together(jobs, [&](std::size_t j) { work(*segments[j], j == 0); });
    if (error_) std::rethrow_exception(error_);
    outcome_.ran = ran_;
    outcome_.failed = failed_;
    outcome_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return outcome_;
  }

 private:
  void look_up() {
    const StoreIndex index(store_.path(), store_.about(), {settings_.shard, settings_.shards});
    outcome_.lost = index.lost();
    done_.resize(cases_.size());
    for (std::uint64_t i = settings_.shard - 1; i < cases_.size(); i += settings_.shards) {
      ++outcome_.cases;
      done_[i] = index.has(i);
      outcome_.before += done_[i] ? 1 : 0;
    }
  }

  void work(SegmentWriter& segment, bool tells) {
    try {
      CaseFlow flow;
      flow.next = [this] { return next(); };
      flow.alone = [this](const std::string& why) { note_alone(why); };
      flow.done = [&](const CaseResult& result) {
        segment.append(result);
        ++ran_;
        if (!result.completed()) note(result);
        if (tells)
          settings_.control.tell(static_cast<double>(outcome_.before + ran_), static_cast<double>(outcome_.cases));
      };
      run_cases(plan_, cases_, registry_, settings_.control, flow);
      segment.close();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      stop_ = true;
    }
  }

  std::optional<std::uint64_t> next() {
    while (!stop_) {
      const std::uint64_t index = settings_.shard - 1 + next_++ * settings_.shards;
      if (index >= cases_.size()) break;
      if (!done_[index]) return index;
    }
    return {};
  }

  void note_alone(const std::string& why) {
    const std::lock_guard lock(mutex_);
    if (outcome_.alone++ == 0 && plan_.lanes) outcome_.alone_because = why;
  }
  void note(const CaseResult& result) {
    ++failed_;
    if (plan_.stop_on_failure) stop_ = true;
    const std::lock_guard lock(mutex_);
    if (!outcome_.failure || result.index < outcome_.failure->index) outcome_.failure = result;
  }

  const Plan& plan_;
  Registry& registry_;
  const Store& store_;
  const SweepSettings& settings_;
  Cases cases_;
  std::vector<bool> done_;  ///< only read while threads run
  std::atomic<std::uint64_t> next_{0}, ran_{0}, failed_{0};
  std::atomic<bool> stop_{false};
  std::mutex mutex_;  ///< of what follows, while threads run
  SweepOutcome outcome_;
  std::exception_ptr error_;
};

}  // namespace

void read_shard(const std::string& text, SweepSettings& settings) {
  if (text.empty()) return;
  const std::size_t slash = text.find('/');
  const auto shard = plain_number(std::string_view(text).substr(0, slash));
  const auto shards =
      slash == std::string::npos ? std::nullopt : plain_number(std::string_view(text).substr(slash + 1));
  const auto whole = [](double x) {
    return x >= 1 && x <= 1e6 && x == static_cast<double>(static_cast<std::uint64_t>(x));
  };
  if (!shard || !shards || !whole(*shard) || !whole(*shards) || *shard > *shards)
    throw study::OptionError("shard", "got '" + text + "'; need I/N, the parts of N counted from 1, as 1/4 to 4/4");
  settings.shard = static_cast<std::uint64_t>(*shard);
  settings.shards = static_cast<std::uint64_t>(*shards);
}

SweepOutcome run_sweep(const Plan& plan, Registry& registry, const Store& store, const SweepSettings& settings) {
  return Workers(plan, registry, store, settings).run();
}

}  // namespace withy::campaign
