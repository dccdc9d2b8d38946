/// \file
/// A plan: which values of a scene vary and how, and what is kept of each run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "withy/campaign/distribution.hpp"
#include "withy/campaign/histories.hpp"
#include "withy/study/prepared.hpp"

namespace withy::campaign {

/// How the random numbers of an axis are spread.
enum class Sampling { plain, latin, sobol };

/// Values that an axis goes through, in SI units or as a scene has them.
struct Levels {
  std::vector<double> numbers;  ///< where all of them are plain numbers
  std::vector<Value> values;    ///< else
  [[nodiscard]] std::size_t size() const { return numbers.empty() ? values.size() : numbers.size(); }
  [[nodiscard]] Value at(std::size_t i) const { return numbers.empty() ? values[i] : Value(numbers[i]); }
};

/// What a case sets: of each axis, then of each path that is derived. Nothing where the scene's own stays; null where
/// what the scene says is taken away.
using CaseValues = std::vector<std::optional<Value>>;

/// A value of the scene that varies.
struct Axis {
  std::string path;      ///< as `--set` has it
  Place place;           ///< in the plan
  Levels levels;         ///< of a grid or a list; none where the value is drawn
  std::size_t grid = 0;  ///< among Plan::grids
  Sampling sampling = Sampling::plain;
  Distribution distribution;
  [[nodiscard]] bool drawn() const { return levels.size() == 0; }
};

/// Which cases a plan has.
enum class Design {
  product,        ///< of the grids, each point with its draws
  one_at_a_time,  ///< the scene itself, then each level of each axis alone
  morris,         ///< trajectories on which one axis after the other takes a step (Morris, 1991)
  saltelli        ///< two samples, and one with the column of the other for each axis (Saltelli and others, 2010)
};

/// A value of the scene that follows from others.
struct Derived {
  std::string path, formula;
  Place place;  ///< in the plan
  /// Those of the formula, in its order: index of that path among varied_paths(), or −1 where it is the scene's own
  /// value.
  std::vector<std::pair<std::string, int>> names;
};

struct Plan {
  std::string file, name;
  std::shared_ptr<const study::Prepared> base;     ///< the scene with what `set` says
  std::vector<std::pair<std::string, Value>> set;  ///< what `set` says
  SceneSources sources;                            ///< of the scene, and of what stands in the plan in its place
  std::vector<std::filesystem::path> files;        ///< that it was read from: plan, scene, lists and what these name
  std::vector<Axis> axes;                          ///< in the order of the plan
  std::vector<std::size_t> grids;                  ///< number of points of each; lists in one file are one grid
  Design design = Design::product;
  std::uint64_t cases = 1;  ///< draws for each point of the grids; trajectories; samples
  std::size_t levels = 4;   ///< of `morris`
  std::uint64_t seed = 0;
  std::vector<Derived> derived;
  std::vector<std::size_t> correlated;   ///< axes
  std::vector<double> cholesky;          ///< of their correlations: lower triangle by rows, as many columns as rows
  std::vector<std::string> final, peak;  ///< names of what is kept
  HistoryPlan history;                   ///< of what is kept over time
  bool stop_on_failure = false;
  /// Folders of plugins that a command for one of the cases has to name; no part of the plan.
  std::vector<std::string> plugin_folders;
  bool lanes = false;       ///< cases that can are evaluated several at once, see case_lanes.hpp
  std::string fingerprint;  ///< SHA-256 of all that decides on the bits of the cases: plan, scene, files, programs
};

/// What to do instead where what is given for a plan is a scene or the store of a sweep; empty where it is neither, or
/// cannot be read.
std::string is_no_plan(const std::string& file);

/// Reads a plan, with its scene and its lists, and checks all it says: every path and every value that stands in it is
/// tried in the scene. \param plugin_folders Plan::plugin_folders
/// \throws SceneError with every problem found; InputError where the scene's formulation cannot treat its model;
/// std::system_error where the plan cannot be read; PluginError.
Plan read_plan(const std::string& file, Registry& registry, std::vector<std::string> plugin_folders = {});

}  // namespace withy::campaign
