#include "withy/results/check_columns.hpp"

#include <algorithm>

#include "withy/results/result_columns.hpp"
#include "withy/scene/asked_outputs.hpp"
#include "withy/scene/describe.hpp"
#include "withy/study/input_error.hpp"
#include "withy/study/prepared.hpp"

namespace withy {

void check_columns(const study::Prepared& prepared, const std::vector<std::string>& names) {
  if (names.empty()) return;
  const ResultColumns table(prepared.model(), *prepared.equations, prepared.scene.outputs);
  std::vector<std::string> known = asked_names(prepared.values.root());
  for (const Column& column : table.columns()) known.push_back(column.name);
  std::vector<std::string> unknown;
  for (const std::string& name : names) {
    const auto is = [&](const Column& c) { return c.name == name || c.name.starts_with(name + '.'); };
    if (std::any_of(table.columns().begin(), table.columns().end(), is)) continue;
    if (const std::string problem = problem_of_place(prepared.values.root(), name); !problem.empty())
      throw study::OptionError("output", problem);
    unknown.push_back(name);
  }
  if (!unknown.empty()) throw study::OptionError("output", unknown_names(unknown, known));
}

}  // namespace withy
