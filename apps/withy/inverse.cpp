#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "withy/apps/withy/commands.hpp"
#include "withy/apps/withy/output.hpp"
#include "withy/apps/withy/recorded_motion.hpp"
#include "withy/apps/withy/results.hpp"
#include "withy/apps/withy/run_report.hpp"
#include "withy/apps/withy/text_table.hpp"
#include "withy/core/model/hinge_rates.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/results/svg_plot.hpp"

namespace withy::app {
namespace {

using Json = nlohmann::ordered_json;

/// The effort on one driven speed over the outputs.
struct Drive {
  std::string name;  ///< of the speed
  std::string unit;  ///< of the effort
  std::size_t speed = 0;
  std::vector<double> effort, rate;
};

/// What a motor would have to give.
struct Demand {
  double peak = 0, peak_time = 0;  ///< effort of greatest size, with its sign
  double rms = 0;
  double peak_power = 0;  ///< [W] of greatest size, with its sign
  double work = 0;        ///< [J]
};

/// Integrals by the trapezoidal rule over the outputs.
Demand demand_of(const Drive& drive, const std::vector<double>& times) {
  Demand d;
  double squares = 0;
  const auto power = [&](std::size_t i) { return drive.effort[i] * drive.rate[i]; };
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (std::abs(drive.effort[i]) > std::abs(d.peak)) {
      d.peak = drive.effort[i];
      d.peak_time = times[i];
    }
    if (std::abs(power(i)) > std::abs(d.peak_power)) d.peak_power = power(i);
    if (i == 0) continue;
    const double h = times[i] - times[i - 1];
    squares += 0.5 * h * (std::pow(drive.effort[i], 2) + std::pow(drive.effort[i - 1], 2));
    d.work += 0.5 * h * (power(i) + power(i - 1));
  }
  const double length = times.empty() ? 0 : times.back() - times.front();
  if (length > 0) d.rms = std::sqrt(squares / length);
  return d;
}

/// The scene with the motions of the file in the place of its own.
SceneArguments with_motions(SceneArguments arguments, const std::string& file) {
  if (file.empty()) return arguments;
  const Engine plain(arguments);
  const RecordedMotion motion = read_recorded_motion(file, plain.model());
  std::vector<std::string> overrides = motion_overrides(motion);
  const Value* initial = plain.scene().source.find("initial");
  const Value* hinges = initial != nullptr ? initial->find("hinges") : nullptr;
  for (const auto& [hinge, coordinates] : motion.coordinates)  // they begin where the motion does
    if (hinges != nullptr && hinges->has(hinge)) overrides.push_back("initial.hinges." + hinge + "={}");
  std::vector<std::string>& all = arguments.options.overrides;
  all.insert(all.end(), overrides.begin(), overrides.end());
  return arguments;
}

std::vector<Drive> drives_of(const Model& model) {
  std::vector<Drive> drives;
  for (const MotionNode& motion : model.motions()) {
    const auto h = static_cast<std::size_t>(motion.hinge);
    const Slot& slot = model.layout().hinges[h];
    const std::vector<HingeRate> rates = hinge_rates(*model.hinges()[h].hinge);
    for (std::size_t i = 0; i < slot.speeds; ++i)
      drives.push_back(
          {model.layout().speed_names[slot.speed + i], rates[i].angular ? "N m" : "N", slot.speed + i, {}, {}});
  }
  return drives;
}

std::string table_text(const std::vector<Drive>& drives, const std::vector<double>& times) {
  TextTable table(
      {"<drive", "peak effort\n[N m, N]", "at\n[s]", "rms effort\n[N m, N]", "peak power\n[W]", "work\n[J]"});
  for (const Drive& drive : drives) {
    const Demand d = demand_of(drive, times);
    table.add({drive.name, fmt::format("{:.5g}", d.peak), fmt::format("{:.4g}", d.peak_time),
               fmt::format("{:.5g}", d.rms), fmt::format("{:.5g}", d.peak_power), fmt::format("{:.5g}", d.work)});
  }
  return table.str();
}

Json drives_json(const std::vector<Drive>& drives, const std::vector<double>& times) {
  Json all = Json::object();
  for (const Drive& drive : drives) {
    const Demand d = demand_of(drive, times);
    all[drive.name] = {{"unit", drive.unit},  {"peak_effort", d.peak},      {"peak_time", d.peak_time},
                       {"rms_effort", d.rms}, {"peak_power", d.peak_power}, {"work", d.work}};
  }
  return all;
}

std::string picture(const std::string& title, const std::vector<Drive>& drives, const std::vector<double>& times) {
  std::vector<Panel> panels;
  for (const Drive& drive : drives) {
    Curve curve;
    curve.x = times;
    curve.y = drive.effort;
    const auto [low, high] = std::minmax_element(curve.y.begin(), curve.y.end());
    const std::pair<double, double> range = curve.y.empty() ? std::pair(0.0, 1.0) : std::pair(*low, *high);
    panels.push_back({"time [s]", drive.name + " [" + drive.unit + "]", range, {std::move(curve)}});
  }
  return svg_plot(title, {"effort of the motion"}, panels);
}

}  // namespace

ExitStatus inverse(const InverseArguments& arguments) {
  const Engine engine(with_motions(arguments, arguments.motion));
  const Model& model = engine.model();
  std::vector<Drive> drives = drives_of(model);
  if (drives.empty())
    throw InputError(arguments.scene +
                     ": no hinge is driven; give the scene motions, or --motion FILE with columns "
                     "t[s] and hinge coordinates");
  std::filesystem::path folder = arguments.out;
  if (folder.empty())
    folder = std::filesystem::path("results") / (std::filesystem::path(arguments.scene).stem().string() + "-inverse");
  std::vector<double> times, efforts(model.layout().speeds);
  Work work = engine.equations().make_work();
  const RunSummary summary = simulate_into(folder, engine, [&](const State& state) {
    engine.equations().motion_efforts(state.time, state.y, efforts, work);
    times.push_back(state.time);
    for (Drive& drive : drives) {
      drive.effort.push_back(efforts[drive.speed]);
      drive.rate.push_back(state.y[model.layout().positions + drive.speed]);
    }
  });
  const Scene& scene = engine.scene();
  const std::string title = (scene.name.empty() ? scene.file : scene.name) + ": inverse dynamics";
  write_file(folder / "inverse.svg", picture(title, drives, times));
  if (arguments.json) {
    print(json_text({{"scene", scene.file},
                     {"name", scene.name},
                     {"formulation", scene.formulation_name},
                     {"status", name(summary.status)},
                     {"message", summary.message},
                     {"t_end", summary.final.time},
                     {"drives", drives_json(drives, times)}}));
  } else {
    print(fmt::format("{} ({}, {}, {} outputs, {})\n\n{}\nresults.csv, run.json and inverse.svg in {}\n", title,
                      scene.formulation_name, scene.integrator_name, times.size(), outcome_text(summary),
                      table_text(drives, times), folder.string()));
  }
  if (summary.status != RunStatus::completed) complain(std::string(name(summary.status)) + ": " + summary.message);
  return exit_status(summary.status);
}

}  // namespace withy::app
