#include "withy/campaign/list_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <system_error>

#include "withy/results/csv.hpp"
#include "withy/scene/describe.hpp"
#include "withy/scene/document.hpp"
#include "withy/scene/names.hpp"
#include "withy/scene/sha256.hpp"
#include "withy/scene/units.hpp"
#include "withy/study/input_error.hpp"

namespace withy::campaign {
namespace {

std::string text_of(const std::string& file) {
  try {
    return read_bytes(file);
  } catch (const std::system_error& e) {
    throw study::InputError(e.what());
  }
}

}  // namespace

ListColumn read_list_column(const std::string& file, const std::string& column, bool named) {
  const std::string text = text_of(file);
  std::istringstream in(text);
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> head = csv_cells(line);
  const auto at = std::find(head.begin(), head.end(), column);
  if (at == head.end() && (named || head.size() != 1))
    throw study::InputError(fmt::format("{}:1: no column {}{}", file, in_quotes(column), suggestion(column, head)));
  const std::size_t index = at == head.end() ? 0 : static_cast<std::size_t>(at - head.begin());
  ListColumn list{{}, sha256(text)};
  bool plain = true;
  for (std::size_t number = 2; std::getline(in, line); ++number) {
    const std::vector<std::string> cells = csv_cells(line);
    if (cells.size() == 1 && cells[0].empty() && head.size() > 1) continue;
    if (cells.size() != head.size() || cells[index].empty())
      throw study::InputError(fmt::format("{}:{}: need {} cells, none empty", file, number, head.size()));
    const auto x = plain_number(cells[index]);
    if (plain && !x) {
      for (const double known : list.levels.numbers) list.levels.values.emplace_back(known);
      list.levels.numbers.clear();
      plain = false;
    }
    if (plain)
      list.levels.numbers.push_back(*x);
    else
      list.levels.values.push_back(x ? Value(*x) : Value(cells[index]));
  }
  if (list.levels.size() == 0) throw study::InputError(file + ": need a head and at least one row");
  return list;
}

}  // namespace withy::campaign
