#include "withy/results/make_folder.hpp"

#include <stdexcept>
#include <string>
#include <system_error>

namespace withy {

void make_folder(const std::filesystem::path& path) {
  std::error_code failed;
  std::filesystem::create_directories(path, failed);
  if (!failed) return;
  std::filesystem::path there = path;
  std::error_code ignored;
  while (there.has_parent_path() && there != there.parent_path() && !std::filesystem::exists(there, ignored))
    there = there.parent_path();
  const bool in_the_way = std::filesystem::is_regular_file(there, ignored);
  throw std::runtime_error("the folder " + path.string() + " for results cannot be made: " +
                           (in_the_way ? there.string() + " is a file" : failed.message()) +
                           "; give one that can be written by --out");
}

}  // namespace withy
