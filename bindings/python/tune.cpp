#include "withy/campaign/tune.hpp"

#include <pybind11/stl.h>

#include <optional>
#include <utility>

#include "withy/bindings/python/bindings.hpp"
#include "withy/bindings/python/followed.hpp"
#include "withy/campaign/tune_files.hpp"

namespace withy::python {
namespace {

using Fitted = std::pair<campaign::TuneResult, std::vector<study::Change>>;

/// Numbers at the times of the data; none where the run that gives them has failed.
py::object at_times(const std::vector<double>& numbers) {
  if (numbers.empty()) return py::none();
  return array_of(numbers, {static_cast<py::ssize_t>(numbers.size())});
}

/// JSON, times, what was measured with the runs before and after of each column, and the changes of the scene.
py::tuple tune(const host::Scene& scene, campaign::TuneQuestion question, const py::object& progress) {
  const auto [result, changes] = of_a_copy(scene, progress, [&](const host::Scene& own, const host::Follow& follow) {
    question.control = {follow.interrupted, follow.progress};
    const std::shared_ptr<const study::Prepared> prepared = own.prepare();
    campaign::TuneResult found = campaign::tune(*prepared, own.library().registry(), question);
    std::vector<study::Change> changed;
    if (found.trouble.empty() && !found.interrupted) changed = campaign::fitted_changes(prepared->values, found);
    return Fitted(std::move(found), std::move(changed));
  });
  py::list columns, set;
  for (std::size_t c = 0; c < result.columns.size(); ++c)
    columns.append(py::make_tuple(at_times(result.data.columns[c].values), at_times(result.columns[c].at_start),
                                  at_times(result.columns[c].at_end)));
  for (const study::Change& change : changes) {
    const std::string text = change.text();
    set.append(py::make_tuple(change.path, text.substr(change.path.size() + 1)));  // behind "path="
  }
  return py::make_tuple(campaign::tune_json_line(result), at_times(result.data.times), columns, set);
}

}  // namespace

void bind_tune(py::class_<host::Scene>& scene) {
  using Names = std::vector<std::string>;
  scene.def("tune", [](const host::Scene& s, const Names& parameters, const std::string& data,
                       const std::optional<std::string>& text, const Names& outputs, const Names& deviations,
                       std::size_t starts, std::uint64_t seed, std::size_t jobs, const py::object& progress) {
    return tune(s, {parameters, data, text, outputs, deviations, starts, seed, jobs, {}}, progress);
  });
}

}  // namespace withy::python
