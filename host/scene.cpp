#include "withy/host/scene.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "withy/core/equations/branch_equations.hpp"
#include "withy/host/names.hpp"
#include "withy/host/run_result.hpp"
#include "withy/results/certificate_json.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/recorded_run.hpp"
#include "withy/results/run_json.hpp"
#include "withy/scene/document.hpp"
#include "withy/scene/scene_values.hpp"
#include "withy/study/input_error.hpp"

namespace withy::host {
namespace {

/// Rows one behind the other.
class FlatRecorder final : public Recorder {
 public:
  explicit FlatRecorder(Result& result) : result_(result) {}
  void begin(const std::vector<Column>& columns) override {
    for (const Column& column : columns) result_.columns.push_back({column.name, column.unit});
  }
  void row(std::span<const double> numbers) override {
    result_.values.insert(result_.values.end(), numbers.begin(), numbers.end());
  }
  RecordMark mark() override { return {}; }
  void end() override {}

 private:
  Result& result_;
};

}  // namespace

struct Scene::Parts {
  Library library;
  std::string text, name;
  SceneValues values;
  std::vector<std::string> changes = {};
  std::size_t threads = 1;
};

Scene::Scene(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Scene::Scene(const Scene& other) : parts_(std::make_unique<Parts>(*other.parts_)) {}
Scene& Scene::operator=(const Scene& other) {
  if (this != &other) parts_ = std::make_unique<Parts>(*other.parts_);
  return *this;
}
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

Scene Scene::read(const Library& library, const std::string& file) { return parse(library, read_bytes(file), file); }

Scene Scene::parse(const Library& library, std::string_view text, const std::string& name) {
  return Scene(std::make_unique<Parts>(Parts{library, std::string(text), name, SceneValues::parse(text, name)}));
}

Scene Scene::parse(const Library& library, std::string_view text, const std::string& name, const std::string& folder) {
  return Scene(
      std::make_unique<Parts>(Parts{library, std::string(text), name, SceneValues::parse(text, name, folder)}));
}

Scene& Scene::set(std::string_view path, double value) { return set(path, std::string_view(fmt::format("{}", value))); }

Scene& Scene::set(std::string_view path, std::string_view text) {
  parts_->changes.push_back(fmt::format("{}={}", path, text));
  parts_->values.set_text(parts_->changes.back(), fmt::format("set({})", parts_->changes.back()));
  return *this;
}

Scene& Scene::formulation(const std::string& id) { return set("formulation", std::string_view(id)); }
Scene& Scene::integrator(const std::string& id) { return set("integrator", std::string_view(id)); }

Scene& Scene::threads(std::size_t count) {
  if (count == 0 || count > most_threads)
    throw study::InputError(fmt::format("threads: got {}; need 1 to {}", count, most_threads));
  parts_->threads = count;
  return *this;
}

void Scene::check() const { study::check_start(study::prepare(parts_->values, library().registry())); }

const std::string& Scene::text() const { return parts_->text; }
const std::string& Scene::name() const { return parts_->name; }
const std::vector<std::string>& Scene::changes() const { return parts_->changes; }
const std::string& Scene::folder() const { return parts_->values.document().whole_directory; }
std::string Scene::values() const {
  const SceneValues& values = parts_->values;
  if (!values.problems().errors().empty()) check();  // which reports them with every other problem
  return json_line(value_json(values.root()));
}
const Library& Scene::library() const { return parts_->library; }

std::shared_ptr<const study::Prepared> Scene::prepare() const {
  study::Prepared prepared = study::prepare(parts_->values, library().registry());
  if (parts_->threads > 1)
    if (const std::string refusal = study::use_threads(prepared, parts_->threads); !refusal.empty())
      library().log("one thread evaluates all: " + refusal);
  return std::make_shared<const study::Prepared>(std::move(prepared));
}

RunResult run_result(const study::Prepared& prepared, Registry& registry, study::RunSettings settings) {
  study::check_integrator(prepared);
  Result result;
  FlatRecorder recorder(result);
  RunTable table(prepared, recorder);
  const bool seen = !prepared.escalates();
  if (seen) settings.seen = &table.seen();
  settings.output = [&, also = std::move(settings.output)](const State& state, std::size_t rung) {
    if (seen) {
      table.add_seen(state);
    } else {
      table.add(state, rung);
    }
    if (also) also(state, rung);
  };
  std::vector<OutputStatistics> statistics;
  settings.statistics = &statistics;
  auto [summary, certificate] = study::run(prepared, registry, settings);
  table.note_blanks(summary);
  result.status = withy::name(summary.status);
  result.message = summary.message;
  nlohmann::ordered_json json = run_json(prepared.scene, summary, certificate);
  if (!statistics.empty()) json["outputs"] = statistics_json(statistics);
  result.json = json_line(json);
  return {std::move(result), std::move(summary)};
}

Result Scene::run(const Follow& follow) const {
  const std::shared_ptr<const study::Prepared> prepared = prepare();
  study::RunSettings settings;
  settings.control = {follow.interrupted, follow.progress};
  RunResult run = run_result(*prepared, library().registry(), std::move(settings));
  if (run.summary.status == RunStatus::completed && !run.summary.message.empty()) library().log(run.summary.message);
  return std::move(run.result);
}

std::vector<double> Result::column(std::string_view name) const {
  const std::size_t index = index_of(columns, name, "column");
  std::vector<double> numbers;
  numbers.reserve(rows());
  for (std::size_t at = index; at < values.size(); at += columns.size()) numbers.push_back(values[at]);
  return numbers;
}

}  // namespace withy::host
