#include "withy/campaign/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "withy/campaign/correlation.hpp"
#include "withy/campaign/derived.hpp"
#include "withy/campaign/kept.hpp"
#include "withy/campaign/list_file.hpp"
#include "withy/campaign/overlaps.hpp"
#include "withy/campaign/plan_reader.hpp"
#include "withy/campaign/random.hpp"
#include "withy/campaign/si_levels.hpp"
#include "withy/campaign/store.hpp"
#include "withy/campaign/trials.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_name.hpp"
#include "withy/results/provenance.hpp"
#include "withy/results/results_error.hpp"
#include "withy/scene/asked_outputs.hpp"
#include "withy/scene/describe.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/sha256.hpp"
#include "withy/study/input_error.hpp"

namespace withy::campaign {
namespace {

using Json = nlohmann::ordered_json;

/// A name in the plan, relative to its folder.
std::string beside(const std::string& directory, const std::string& name) {
  return (std::filesystem::path(directory) / name).string();
}

/// Makes a plan of one document.
class PlanBuilder {
 public:
  PlanBuilder(const std::string& file, const Document& document, Registry& registry, Problems& problems)
      : root_(document.root), registry_(registry), problems_(problems), reader_(document, problems.of_plan()) {
    plan_.file = file;
  }

  Plan build() {
    if (!reader_.is_map(root_, keys::plan) && root_.kind() != Value::Kind::map) return std::move(plan_);
    if (reader_.choice(find("format"), {"withy-sweep/1"}) && find("format") == nullptr)
      reader_.key_error("/format", "missing; need format: withy-sweep/1");
    if (const Value* name = find("name")) plan_.name = reader_.text(*name).value_or("");
    read_design();
    read_axes();
    plan_.seed = reader_.whole(find("seed"), 0, 0x1p53, 0);
    if (const Value* given = find("derived")) read_derived(*given, reader_, plan_);
    check_overlaps(plan_, reader_);
    if (const Value* given = find("correlation")) read_correlation(*given, reader_, plan_);
    plan_.stop_on_failure = reader_.choice(find("failures"), keys::failures).value_or(0) == 1;
    plan_.lanes = reader_.choice(find("evaluation"), keys::evaluations).value_or(0) == 1;
    if (const Value* keep = find("keep"); keep != nullptr && reader_.is_map(*keep, keys::keep)) {
      plan_.final = reader_.texts(keep->find("final"));
      plan_.peak = reader_.texts(keep->find("peak"));
      if (const Value* history = keep->find("history")) read_history(*history);
    }
    std::optional<SceneValues> base = read_scene();
    Tried tried;
    if (base) tried = try_values(plan_, *base, trials_, rows_of_names(plan_.axes, grid_of_file_), registry_, problems_);
    const bool good = problems_.none();
    if (base && good) use_si(plan_, *base, tried, registry_);
    plan_.sources = std::move(tried.sources);
    if (base) plan_.base = prepared_base(std::move(*base), registry_, problems_);
    if (plan_.base == nullptr) return std::move(plan_);
    check_derived(plan_, problems_);
    check_kept();
    if (good) finish();
    return std::move(plan_);
  }

 private:
  [[nodiscard]] const Value* find(std::string_view key) const { return root_.find(key); }

  std::optional<SceneValues> read_scene() {
    const Value* name = find("scene");
    if (name == nullptr) {
      reader_.key_error("/scene", "missing; need the file of a scene");
      return {};
    }
    const auto file = reader_.text(*name);
    if (!file) return {};
    try {
      SceneValues values = SceneValues::read(beside(reader_.directory(), *file));
      if (const Value* set = find("set")) {
        if (set->kind() != Value::Kind::map) {
          reader_.error(set->place(),
                        fmt::format("got {}; need a map of paths, as integrator.rtol: 1e-5", shown(*set)));
          return {};
        }
        for (const auto& [path, value] : set->members())
          values.set(path, value, origin_of(plan_.file, reader_.key_place("/set/" + path)));
        plan_.set = set->members();
      }
      ask_kept(values);
      return values;
    } catch (const std::system_error& e) {
      reader_.error(name->place(), e.what());
    }
    return {};
  }

  /// Adds outputs to the scene that are kept and whose names say what they are.
  void ask_kept(SceneValues& values) {
    for (const auto* names : {&plan_.final, &plan_.peak, &plan_.history.of})
      for (const std::string& name : *names) {
        const std::string asked = output_of_rate(values.root(), name).value_or(name);
        if (defines_output(values.root(), asked) || !asked_output(values.root(), asked)) continue;
        values.set("outputs", Value(asked), origin_of(plan_.file, reader_.key_place("/keep")));
        plan_.set.emplace_back("outputs", Value(asked));
      }
  }

  /// A list of names, or a map with them and an interval.
  void read_history(const Value& given) {
    if (given.kind() == Value::Kind::list) {
      plan_.history.of = reader_.texts(&given);
      return;
    }
    if (!reader_.is_map(given, keys::history)) return;
    if (given.has("of")) {
      plan_.history.of = reader_.texts(given.find("of"));
    } else {
      reader_.key_error(given.place().path + "/of", "missing; need a list of names, as [shoulder]");
    }
    if (const Value* every = given.find("every")) {
      const auto read = reader_.number(*every);
      const Dimension time = read_any_quantity("1 s").dimension;
      if (read && (!(read->si > 0) || (read->dimension != Dimension{} && read->dimension != time)))
        reader_.error(every->place(), fmt::format("got {}; need a time above 0 s", shown(*every)));
      if (read) plan_.history.every = read->si;
    }
  }

  void read_design() {
    const Value* given = find("design");
    const bool map = given != nullptr && given->kind() == Value::Kind::map;
    if (map && !reader_.is_map(*given, keys::design)) return;
    const auto design = reader_.choice(map ? given->find("type") : given, keys::designs);
    plan_.design = static_cast<Design>(design.value_or(0));
    if (map && given->has("levels")) {
      if (plan_.design != Design::morris) reader_.key_error("/design/levels", "of the design morris alone");
      plan_.levels = reader_.whole(given->find("levels"), 2, 1000, 4);
      if (plan_.levels % 2 != 0) reader_.error(given->at("levels").place(), "need an even number");
    }
    plan_.cases = reader_.whole(find("cases"), 1, most_cases, 1);
  }

  void read_axes() {
    const Value* vary = find("vary");
    if (vary == nullptr || vary->kind() != Value::Kind::map || vary->members().empty()) {
      reader_.key_error("/vary",
                        "need at least one path of the scene that varies, as bodies.link1.length: {grid: [1, 2]}");
      return;
    }
    for (const auto& [path, value] : vary->members()) {
      Axis axis;
      axis.path = path;
      axis.place = reader_.key_place("/vary/" + path);
      if (!reader_.is_map(value, keys::axis)) continue;
      if (value.members().size() != 1) {
        reader_.error(value.place(), "need one of: " + listed(keys::axis));
        continue;
      }
      if (read_axis(axis, value.members().front().first, value.members().front().second))
        plan_.axes.push_back(std::move(axis));
    }
    check_axes();
  }

  bool read_axis(Axis& axis, const std::string& kind, const Value& value) {
    if (kind == "grid") {
      axis.levels = reader_.grid(value);
      if (axis.levels.size() == 0) return false;
      axis.grid = plan_.grids.size();
      plan_.grids.push_back(axis.levels.size());
      const auto& tried =
          value.kind() == Value::Kind::list ? value.items() : std::vector<Value>{value.at("from"), value.at("to")};
      for (const Value& v : tried) add_trial(v);
      return true;
    }
    if (kind == "list") return read_list(axis, value);
    if (kind == "latin" || kind == "sobol") {
      axis.sampling = kind == "latin" ? Sampling::latin : Sampling::sobol;
      const bool inner = value.members().size() == 1 && value.find("from") == nullptr && value.find("to") == nullptr;
      if (!inner) return read_distribution(axis, "uniform", value);
      if (!reader_.is_map(value, keys::distributions)) return false;
      return read_distribution(axis, value.members().front().first, value.members().front().second);
    }
    return read_distribution(axis, kind, value);
  }

  bool read_distribution(Axis& axis, const std::string& kind, const Value& value) {
    const auto distribution = reader_.distribution(kind, value);
    if (!distribution) return false;
    axis.distribution = *distribution;
    Value middle(axis.distribution.quantile(0.5));
    for (const char* key : {"to", "from", "mean"})
      if (const Value* v = value.find(key)) {
        add_trial(*v, true);
        middle.set_place(v->place());
      }
    add_trial(middle);
    return true;
  }

  /// The column of a file; columns of one file make one grid.
  bool read_list(Axis& axis, const Value& value) {
    const bool map = value.kind() == Value::Kind::map;
    if (map && !reader_.is_map(value, keys::list)) return false;
    const Value* name = map ? value.find("file") : &value;
    if (name == nullptr) {
      reader_.key_error(value.place().path + "/file", "missing; need the name of a CSV file");
      return false;
    }
    const auto text = reader_.text(*name);
    const auto column = map && value.has("column") ? reader_.text(value.at("column")) : axis.path;
    if (!text || !column) return false;
    try {
      const std::string file = beside(reader_.directory(), *text);
      const ListColumn read = read_list_column(file, *column, map && value.has("column"));
      axis.levels = read.levels;
      lists_.push_back(read.sha256);
      const auto [grid, is_new] = grid_of_file_.emplace(file, plan_.grids.size());
      if (is_new) plan_.grids.push_back(axis.levels.size());
      axis.grid = grid->second;
      Value first = axis.levels.at(0);
      first.set_place(name->place());
      add_trial(first);
      return true;
    } catch (const study::InputError& e) {
      reader_.error(name->place(), e.what());
      return false;
    }
  }

  /// Of the axis that is being read.
  void add_trial(const Value& value, bool end = false) { trials_.push_back({plan_.axes.size(), value, end}); }

  void check_axes() {
    const bool sampled = plan_.design == Design::morris || plan_.design == Design::saltelli;
    bool drawn = sampled;
    std::size_t sobol = 0;
    for (const Axis& axis : plan_.axes) {
      if (sampled && !axis.drawn())
        reader_.error(axis.place, "this design draws every value: need a distribution, as uniform: {from: 1, to: 2}");
      if (sampled && axis.sampling != Sampling::plain)
        reader_.error(axis.place, "this design has a sampling of its own: need uniform, normal or lognormal");
      drawn = drawn || axis.drawn();
      sobol += axis.sampling == Sampling::sobol ? 1 : 0;
    }
    if (std::max(sobol, plan_.axes.size() * (plan_.design == Design::saltelli ? 2 : 0)) > most_sobol_dimensions)
      reader_.key_error("/vary", fmt::format("a Sobol sequence has at most {} dimensions", most_sobol_dimensions));
    // An axis that is reported may have been drawn.
    const bool all_read = find("vary") != nullptr && find("vary")->members().size() == plan_.axes.size();
    if (find("cases") != nullptr && all_read && (!drawn || plan_.design == Design::one_at_a_time))
      reader_.key_error("/cases", "nothing is drawn: leave it out");
    double all = static_cast<double>(plan_.cases) * static_cast<double>(plan_.axes.size() + 2);
    for (const std::size_t n : plan_.grids) all *= static_cast<double>(n);
    if (all > most_cases * 1000) reader_.key_error("/cases", fmt::format("{:.3g} cases are too many", all));
  }

  void check_kept() {
    const Value* keep = find("keep");
    if (keep == nullptr) return;
    const Value* history = keep->find("history");
    if (history != nullptr && history->kind() == Value::Kind::map) history = history->find("of");
    for (const auto& [given, names] :
         {std::pair(keep->find("final"), &plan_.final), std::pair(keep->find("peak"), &plan_.peak),
          std::pair(history, &plan_.history.of)})
      for (std::size_t i = 0; i < names->size() && given->items().size() == names->size(); ++i)
        if (const std::string why = kept_problem(*plan_.base, (*names)[i], names == &plan_.final); !why.empty())
          reader_.error(given->items()[i].place(), why);
    if (problems_.none() && !plan_.history.of.empty()) make_times();
  }

  /// The times of histories are those of every case.
  void make_times() {
    HistoryPlan& history = plan_.history;
    const auto refuse = [&](const std::string& why) { reader_.key_error("/keep/history", why); };
    std::vector<std::string> varied;
    for (const Axis& axis : plan_.axes) varied.push_back(axis.path);
    for (const Derived& derived : plan_.derived) varied.push_back(derived.path);
    for (const std::string& path : varied) {
      if (path == "time" || path == "time.end")
        return refuse(fmt::format("needs one end of all cases, and {} varies", path));
      if (path == "initial" || path == "initial.time")
        return refuse(fmt::format("needs one start of all cases, and {} varies", path));
    }
    const Scene& scene = plan_.base->scene;
    if (!scene.end) return refuse("needs the scene's time.end");
    const double every = history.every > 0 ? history.every : scene.output;
    const double start = scene.initial.time, lasts = *scene.end - start;
    if (lasts / every > static_cast<double>(most_history_times))
      return refuse(fmt::format("{:.3g} times are too many; need an `every` that gives at most {}", lasts / every,
                                most_history_times));
    history.times = history_times(start, *scene.end, every);
    const std::size_t count = history_columns(plan_).size() * history.times.size();
    if (count > most_history_numbers)
      refuse(fmt::format("{} numbers a case are too many; need at most {}: fewer names or times", count,
                         most_history_numbers));
  }

  /// What it was read from, and what tells it from others.
  void finish() {
    Json said = Json::object();
    for (const auto& [key, value] : root_.members())
      if (key != "name" && key != "scene" && key != "failures") said[key] = value_json(value);
    Scene scene = plan_.base->scene;
    scene.sources = plan_.sources;
    plan_.files = files_of(scene, plan_.file);
    for (const auto& [list, grid] : grid_of_file_) plan_.files.emplace_back(list);
    plan_.fingerprint = sha256(json_line(Json::array({said, lists_, withy::provenance_of(scene).fingerprint()})));
  }

  const Value& root_;
  Registry& registry_;
  Problems& problems_;
  PlanReader reader_;
  Plan plan_;
  std::vector<Trial> trials_;
  std::vector<std::string> lists_;  ///< SHA-256 of each
  std::map<std::string, std::size_t> grid_of_file_;
};

}  // namespace

std::string is_no_plan(const std::string& file) try {
  if (std::filesystem::is_directory(file))
    return fmt::format("{} is the store of a sweep; need its plan, {}", file, read_description(file).plan);
  Problems problems(file);
  Document document;
  if (!read_document(read_bytes(file), {}, document, problems.of_plan())) return {};
  const Value* format = document.root.find("format");
  if (format == nullptr || format->kind() != Value::Kind::text || !format->text().starts_with("withy/")) return {};
  return fmt::format(
      "{0} is a scene; need a plan of a sweep: a file that names a scene and says which of its values vary, as\n"
      "  format: withy-sweep/1\n  scene: {1}\n  vary:\n    bodies.NAME.mass: {{grid: [1, 2, 3]}}\n"
      "docs/sweep.md says more; withy run {0} runs the scene once",
      file, std::filesystem::path(file).filename().string());
} catch (const ResultsError&) {
  return {};
} catch (const std::system_error&) {
  return {};
}

Plan read_plan(const std::string& file, Registry& registry, std::vector<std::string> plugin_folders) {
  Problems problems(file);
  Document document;
  document.directory = std::filesystem::path(file).parent_path().string();
  if (!read_document(read_bytes(file), {}, document, problems.of_plan())) problems.raise();
  PlanBuilder builder(file, document, registry, problems);
  Plan plan = builder.build();
  problems.raise();
  plan.plugin_folders = std::move(plugin_folders);
  return plan;
}

}  // namespace withy::campaign
