/// \file
/// Runs of a scene at a point, outputs read as they come and ended as soon as the caller has seen enough.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "withy/study/measures.hpp"
#include "withy/study/point.hpp"
#include "withy/study/prepared.hpp"

namespace withy::study {

/// A scene as a point makes it, or why there is none. The point's integrator and tolerance mean nothing here.
struct ModelAt {
  Point point;
  std::optional<Prepared> prepared;
  std::string refusal;  ///< empty where there is a model
  double fastest = 0;   ///< greatest √ of the eigenvalues of M⁻¹K at the start [rad/s]; 0: not known
  double seconds = 0;   ///< CPU time of an evaluation [s], the least of some batches
  [[nodiscard]] bool refused() const { return !prepared; }
};
/// \param base the scene that the point changes
/// \param alike the same modes in another formulation, of which the fastest mode is taken: formulations differ in it by
/// what deflections at the start change alone, and some are long about telling their own; null: it is looked for
/// \throws PluginError
ModelAt model_at(const Prepared& base, Registry& registry, const Point& point, const ModelAt* alike = nullptr);

/// Evaluations over the whole run that `dop853` takes at its stability limit, whatever the tolerance.
double explicit_evaluations(const ModelAt& model);

/// What stepping through a scene gave.
struct Walk {
  enum class End { reached, cut, stopped, interrupted };
  End end = End::reached;
  std::string reason;  ///< of `stopped`
  double time = 0;     ///< reached [s]
  std::size_t steps = 0, evaluations = 0;
  double seconds = 0;  ///< CPU time of stepping alone
};

/// What a walk is told; all but `output` may be empty.
struct WalkObserver {
  std::function<bool(const State&)> output;  ///< gets the state at each output and says whether to go on
  std::function<bool(const Walk&)> afford;   ///< at the same times: whether the cost so far may be spent
  std::function<bool()> interrupted;
  double interval = 0;  ///< of outputs [s]; 0: the scene's
};

/// Steps from the scene's initial state to its end as a run does, without looking for events or measuring on the way.
/// \throws std::invalid_argument where the integrator cannot treat the equations.
Walk walk(const Prepared& model, const Integrator& integrator, const WalkObserver& observer);

/// Outputs of a run, read at their times.
struct Readings {
  std::vector<double> times;  ///< [s]
  std::vector<std::vector<double>> values;
};
/// Greatest distances over the times that both have from the first on, and the last of these times.
std::pair<Distances, double> distances(const Outputs& outputs, const Readings& a, const Readings& b);
/// The last of these times up to which no distance is beyond its limit; 0 where there is none.
double agree_until(const Outputs& outputs, const Readings& a, const Readings& b, const Distances& limits);

}  // namespace withy::study
