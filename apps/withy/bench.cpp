#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "withy/apps/withy/allocations.hpp"
#include "withy/apps/withy/command.hpp"
#include "withy/apps/withy/engine.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/core/simulation/moving_state.hpp"
#include "withy/results/json_text.hpp"

namespace withy::app {
namespace {

struct BenchArguments : StateArguments {
  std::vector<std::string> formulations;  ///< `all` is every one found; empty: the scene's
};

using Json = nlohmann::ordered_json;

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Evaluates one state again and again.
class Evaluations {
 public:
  Evaluations(const EquationsOfMotion& equations, State state)
      : equations_(equations), state_(std::move(state)), rates_(equations.size()), work_(equations.make_work()) {}

  /// CPU time [s] of `count` evaluations.
  double time(std::size_t count) {
    const double begin = cpu_seconds();
    for (std::size_t i = 0; i < count; ++i) outcome_ = equations_.derivatives(state_.time, state_.y, rates_, work_);
    total_ += count;
    return cpu_seconds() - begin;
  }
  [[nodiscard]] bool ok() const { return outcome_.ok(); }
  [[nodiscard]] std::size_t total() const { return total_; }

 private:
  const EquationsOfMotion& equations_;
  State state_;
  std::vector<double> rates_;
  Work work_;
  Evaluation outcome_;
  std::size_t total_ = 0;
};

Json measure(const Engine& engine, const std::string& state_file) {
  // At rest, branches and sines are cheaper than in motion.
  const State given = engine.state(state_file);
  Evaluations evaluations(engine.equations(), state_file.empty() ? moving_state(engine.model(), given) : given);
  // Batches of ten milliseconds, long against the clock's resolution; the first ones warm caches and clock rate.
  std::size_t batch = 1;
  while (evaluations.time(batch) < 0.01) batch *= 2;
  if (!evaluations.ok()) throw InputError("the equations of motion cannot be evaluated at this state; see withy eval");
  constexpr std::size_t batches = 25;
  std::vector<double> times(batches);
  const std::size_t evaluations_before = evaluations.total();
  const std::size_t allocations_before = allocations();
  for (double& t : times) t = evaluations.time(batch);
  const std::size_t allocated = allocations() - allocations_before;
  const std::size_t counted = evaluations.total() - evaluations_before;
  std::sort(times.begin(), times.end());
  const double to_ns = 1e9 / static_cast<double>(batch);
  Json j;
  j["formulation"] = engine.scene().formulation_name;
  j["ns_per_evaluation"] = times[batches / 2] * to_ns;
  j["ns_fastest_batch"] = times.front() * to_ns;
  j["ns_slowest_batch"] = times.back() * to_ns;
  j["evaluations"] = counted;
  j["allocations_per_evaluation"] = static_cast<double>(allocated) / static_cast<double>(counted);
  j["bodies"] = engine.model().bodies().size();
  j["coordinates"] = engine.model().layout().speeds;
  return j;
}

/// Those that a name is enough for, but `auto`: its equations are others', chosen along a run.
std::vector<std::string> all_formulations(Registry& registry) {
  std::vector<std::string> ids = registry.ids<Formulation>();
  std::erase_if(ids, [&](const std::string& id) {
    const std::vector<ParameterSpec>& options = registry.find<Formulation>(id)->parameters;
    return id == "auto" || std::any_of(options.begin(), options.end(), [](const auto& o) { return o.required; });
  });
  return ids;
}

ExitStatus bench(const BenchArguments& arguments) {
  std::vector<std::string> formulations = arguments.formulations;
  if (formulations.empty()) formulations = {""};
  if (formulations == std::vector<std::string>{"all"}) {
    formulations = all_formulations(Plugins(arguments).registry());
  }
  std::vector<Json> results;
  SceneArguments one = arguments;
  for (const std::string& formulation : formulations) {
    one.options.formulation = formulation;
    const Engine engine(one);
    Json result{{"scene", engine.scene().file}};
    result.update(measure(engine, arguments.state));
    results.push_back(std::move(result));
  }
  print(json_text(results.size() == 1 ? results.front() : Json(results)));
  return ExitStatus::done;
}

std::function<ExitStatus()> add_bench(CLI::App& c) {
  const auto arguments = std::make_shared<BenchArguments>();
  BenchArguments& a = *arguments;
  add_scene(c, a);
  add_formulations(c, a.formulations, "--formulation,--formulations",
                   "One formulation, several, or all; default: the scene's");
  add_state(c, a);
  return [arguments] { return bench(*arguments); };
}

}  // namespace

const Command bench_command = {"bench", "Time one evaluation of the equations of motion, as JSON",
                               "  withy bench scenes/two-link-slew.yaml\n"
                               "  withy bench scenes/two-link-slew.yaml --formulation ruthless,quadratic",
                               &add_bench};

}  // namespace withy::app
