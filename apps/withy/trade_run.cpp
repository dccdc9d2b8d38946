#include "withy/apps/withy/trade_run.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "withy/apps/withy/beyond.hpp"
#include "withy/apps/withy/progress.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"

namespace withy::app {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TradeResult result_of(const Json& j, const TradePoint& point) {
  return {point,
          j.at("status"),
          j.at("message"),
          j.at("hinge_error"),
          j.at("tip_error"),
          j.at("relative_error"),
          j.at("cpu_seconds"),
          j.at("steps"),
          j.at("evaluations"),
          j.at("reference").at("relative_error")};
}

/// Greatest distance of hinges and tips from where they start.
Distances ways(const ComparedRun& run) {
  Distances d;
  const Moment start{run.engine->model(), run.engine->equations(), run.outputs.front()};
  for (const State& s : run.outputs) add_distances(d, {start.model, start.equations, s}, start);
  return d;
}

double relative(const Distances& d, double hinge_way, double tip_way) {
  return std::max(hinge_way > 0 ? d.greatest_hinge() / hinge_way : 0, tip_way > 0 ? d.greatest_tip() / tip_way : 0);
}

/// On standard error, without ending the line.
void show(const std::string& text) { static_cast<void>(std::fputs(text.c_str(), stderr)); }

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& p : parts) text += (text.empty() ? "" : " ") + p;
  return text;
}

}  // namespace

/// What threads share.
struct TradeStudy::Shared {
  std::mutex making;  ///< scenes are read and plugins loaded by one thread at a time
  std::mutex keeping;
  std::map<std::string, TradeReference> references;
  Json told = Json::object();
};

Json result_json(const TradeResult& r) {
  return {{"formulation", r.point.formulation},
          {"modes", r.point.modes},
          {"family", r.point.family.empty() ? Json() : Json(r.point.family)},
          {"integrator", r.point.integrator},
          {"tolerance", r.point.tolerance},
          {"over", r.point.over},
          {"status", r.status},
          {"message", r.message},
          {"hinge_error", r.hinge_error},
          {"tip_error", r.tip_error},
          {"relative_error", r.relative_error},
          {"cpu_seconds", r.cpu_seconds},
          {"steps", r.steps},
          {"evaluations", r.evaluations}};
}

TradeStudy::TradeStudy(const SceneArguments& arguments, std::vector<TradePoint> points, TradeOptions options)
    : arguments_(arguments),
      engine_(arguments),
      points_(std::move(points)),
      options_(std::move(options)),
      finished_(points_.size()),
      shared_(std::make_unique<Shared>()) {
  int modes = 0;
  double tolerance = 1;
  for (const TradePoint& p : points_) {
    modes = std::max(modes, p.modes);
    tolerance = std::min(tolerance, p.tolerance);
  }
  fingerprint_ = fingerprint_of(
      fmt::format("{} {} {:g} {}", text_of(arguments.scene), modes, tolerance, joined(arguments.options.overrides)));
  find_finished(0);
}

TradeStudy::~TradeStudy() = default;

const Json& TradeStudy::references() const { return shared_->told; }

void TradeStudy::add(const TradePoint& point) {
  points_.push_back(point);
  finished_.emplace_back();
  find_finished(points_.size() - 1);
}

void TradeStudy::find_finished(std::size_t first) {
  if (options_.folder.empty()) return;
  std::filesystem::create_directories(options_.folder / "points");
  for (std::size_t i = first; i < points_.size(); ++i) {
    const Json j = Json::parse(text_of(options_.folder / "points" / (points_[i].key() + ".json")), nullptr, false);
    if (j.is_discarded() || j.value("fingerprint", "") != fingerprint_) continue;
    finished_[i] = result_of(j, points_[i]);
    shared_->told[joined(points_[i].over)] = j.at("reference");
  }
}

void TradeStudy::keep(const TradeResult& result) const {
  if (options_.folder.empty()) return;
  Json j = result_json(result);
  j["fingerprint"] = fingerprint_;
  j["reference"] = shared_->told.at(joined(result.point.over));
  write_file(options_.folder / "points" / (result.point.key() + ".json"), json_text(j));
}

ComparedRun TradeStudy::simulate(const TradePoint& point, double& cpu_seconds) {
  ComparedRun run;
  {
    const std::lock_guard lock(shared_->making);
    run.engine = std::make_unique<Engine>(arguments_at(arguments_, engine_.scene(), point));
  }
  const Scene& scene = run.engine->scene();
  RunOptions options;
  options.end = end_of_run(scene);
  options.output = scene.output;
  options.deflection_limit = scene.deflection_limit;
  options.interrupted = interrupted;
  // Short runs are timed again and again: the least time is nearest to what the processor needs.
  cpu_seconds = std::numeric_limits<double>::max();
  double spent = 0;
  for (int i = 0; i < 30 && spent < 0.05; ++i) {
    run.outputs.clear();
    run.summary = withy::simulate(run.engine->model(), run.engine->equations(), *scene.integrator, scene.initial,
                                  options, [&](const State& s) { run.outputs.push_back(s); });
    cpu_seconds = std::min(cpu_seconds, run.summary.cpu_seconds);
    spent += run.summary.cpu_seconds;
  }
  return run;
}

const TradeReference& TradeStudy::reference_for(const TradePoint& point) {
  const std::string key = joined(point.over);
  const auto found = shared_->references.find(key);
  if (found != shared_->references.end()) return found->second;
  TradeReference r;
  int modes = 0;
  double tolerance = 1e-6;
  for (const TradePoint& p : points_) {
    modes = std::max(modes, p.modes);
    tolerance = std::min(tolerance, p.tolerance);
  }
  r.point = {"exact", "", modes + 1, "dopri5", 0.1 * tolerance, point.over};
  double cpu = 0;
  try {
    r.run = simulate(r.point, cpu);
  } catch (const InputError&) {
    r.point.formulation = "quadratic";
    r.run = simulate(r.point, cpu);
  }
  if (r.run.summary.status == RunStatus::interrupted) throw InputError("interrupted");
  if (r.run.summary.status != RunStatus::completed)
    throw InputError("the reference (" + r.point.text() + ") does not reach the end: " + r.run.summary.message);
  TradePoint coarser = r.point;
  --coarser.modes;
  coarser.tolerance *= 10;
  const Distances own = distances(simulate(coarser, cpu), r.run), way = ways(r.run);
  r.hinge_way = way.greatest_hinge();
  r.tip_way = way.greatest_tip();
  r.hinge_error = own.greatest_hinge();
  r.tip_error = own.greatest_tip();
  r.relative_error = relative(own, r.hinge_way, r.tip_way);
  shared_->told[key] = {
      {"formulation", r.point.formulation}, {"modes", r.point.modes},   {"integrator", r.point.integrator},
      {"tolerance", r.point.tolerance},     {"hinge_way", r.hinge_way}, {"tip_way", r.tip_way},
      {"hinge_error", r.hinge_error},       {"tip_error", r.tip_error}, {"relative_error", r.relative_error}};
  return shared_->references.emplace(key, std::move(r)).first->second;
}

TradeResult TradeStudy::run_point(const TradePoint& point) {
  TradeResult result;
  result.point = point;
  try {
    const ComparedRun run = simulate(point, result.cpu_seconds);
    result.status = name(run.summary.status);
    result.message = run.summary.message;
    result.steps = run.summary.steps.accepted;
    result.evaluations = run.summary.steps.evaluations;
    const TradeReference& reference = shared_->references.at(joined(point.over));
    const Distances d = distances(run, reference.run);
    result.hinge_error = d.greatest_hinge();
    result.tip_error = d.greatest_tip();
    result.relative_error = relative(d, reference.hinge_way, reference.tip_way);
    result.reference_error = reference.relative_error;
  } catch (const PluginError&) {
    throw;
  } catch (const std::runtime_error& e) {  // InputError, SceneError: no such model
    result.status = "refused";
    result.message = e.what();
  } catch (const std::invalid_argument& e) {
    result.status = "refused";
    result.message = e.what();
  }
  return result;
}

bool TradeStudy::run() {
  watch_for_interrupt();
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (!finished_[i]) open.push_back(i);
  // References first: threads then only read them.
  for (const std::size_t i : open) {
    if (interrupted()) return false;
    static_cast<void>(reference_for(points_[i]));
  }
  std::atomic<std::size_t> next{0};
  std::size_t done = 0;
  const bool terminal = ::isatty(STDERR_FILENO) == 1;
  const auto began = Clock::now();
  std::exception_ptr failure;
  const auto work = [&] {
    for (std::size_t k = next++; k < open.size() && !interrupted(); k = next++) {
      try {
        const TradeResult result = run_point(points_[open[k]]);
        if (result.status == name(RunStatus::interrupted)) return;
        const std::lock_guard lock(shared_->keeping);
        keep(result);
        finished_[open[k]] = result;
        ++done;
        if (!terminal) continue;
        const double passed = std::chrono::duration<double>(Clock::now() - began).count();
        show(fmt::format("\r\033[Ktrade: {} of {} points, about {:.0f} s left", points_.size() - open.size() + done,
                         points_.size(), passed / static_cast<double>(done) * static_cast<double>(open.size() - done)));
      } catch (...) {
        const std::lock_guard lock(shared_->keeping);
        failure = std::current_exception();
        next = open.size();
      }
    }
  };
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t jobs = std::min(options_.jobs > 0 ? options_.jobs : cores, std::max<std::size_t>(open.size(), 1));
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 1; i < jobs; ++i) threads.emplace_back(work);
    work();
  }
  if (terminal && done > 0) show("\r\033[K");
  if (failure) std::rethrow_exception(failure);
  return !interrupted();
}

const TradeResult* TradeStudy::result(const TradePoint& point) const {
  const std::string key = point.key();
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (finished_[i] && points_[i].key() == key) return &*finished_[i];
  return nullptr;
}

std::vector<TradeResult> TradeStudy::results() const {
  std::vector<TradeResult> all;
  for (const auto& r : finished_)
    if (r) all.push_back(*r);
  return all;
}

std::vector<bool> pareto_front(const std::vector<TradeResult>& results) {
  const auto error = [](const TradeResult& r) { return std::max(r.relative_error, r.reference_error); };
  std::vector<bool> front(results.size(), false);
  for (std::size_t i = 0; i < results.size(); ++i) {
    const TradeResult& a = results[i];
    front[i] = a.completed() && std::none_of(results.begin(), results.end(), [&](const TradeResult& b) {
                 return b.completed() && b.point.over == a.point.over && error(b) <= error(a) &&
                        b.cpu_seconds <= a.cpu_seconds && (error(b) < error(a) || b.cpu_seconds < a.cpu_seconds);
               });
  }
  return front;
}

}  // namespace withy::app
