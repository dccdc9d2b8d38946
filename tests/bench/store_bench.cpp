/// \file
/// The store of a sweep at the size of a cluster: bench-store FOLDER CASES SEGMENTS writes that many results of cases
/// that no run has made, a record of a hundred bytes each, by the writer of sweeps, a segment a shard as if each were a
/// node. Then it makes the index of the whole store, that of one shard that goes on, and the tables. A row a step:
/// name, wall time [s], memory at most so far [MB]; then bytes of the segments and of table.csv.
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "withy/campaign/collect.hpp"

namespace {

using namespace withy::campaign;
using Clock = std::chrono::steady_clock;

/// Three values that vary and three results, from the case's number.
CaseResult made(std::uint64_t index) {
  const auto number = [&](std::uint64_t k) {
    return static_cast<double>((index * 3 + k) * 0x9E3779B97F4A7C15U >> 11) * 0x1p-53;
  };
  CaseResult r;
  r.index = index;
  r.status = "completed";
  r.values = {withy::Value(number(0)), withy::Value(number(1)), withy::Value(number(2))};
  r.numbers = {number(3), number(4), number(5)};
  r.seconds = 1e-3;
  return r;
}

/// What the plan of such cases would have said.
StoreDescription described(std::uint64_t cases) {
  StoreDescription about;
  about.plan = "plan.yaml";
  about.fingerprint = std::string(64, 'a');
  about.size = about.draws = cases;
  about.paths = {"a", "b", "c"};
  about.columns = {"final.x", "final.y", "final.z"};
  about.drawn = true;
  return about;
}

double memory() {  // MB at most so far
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_maxrss) / 1024;
}

template <class Step>
void row(const char* name, Step step) {
  const auto begin = Clock::now();
  step();
  std::printf("%s\t%.1f\t%.0f\n", name, std::chrono::duration<double>(Clock::now() - begin).count(), memory());
  std::fflush(stdout);
}

void run(const std::filesystem::path& folder, std::uint64_t cases, std::uint64_t segments) {
  const StoreDescription about = described(cases);
  std::filesystem::create_directories(folder / "segments");
  write_description(folder, about);
  row("write", [&] {
    for (std::uint64_t shard = 1; shard <= segments; ++shard) {
      SegmentWriter writer(folder / "segments" / fmt::format("{}-of-{}.0.segment", shard, segments), about.fingerprint);
      for (std::uint64_t i = shard - 1; i < cases; i += segments) writer.append(made(i));
      writer.close();
    }
  });
  row("index of a shard", [&] {
    const StoreIndex index(folder, about, {segments, segments});
    if (index.done() != Shard{segments, segments}.size(cases))
      throw std::runtime_error("cases of the shard are missing");
  });
  row("index", [&] {
    const StoreIndex index(folder, about);
    if (index.done() != cases || index.lost() != 0) throw std::runtime_error("cases are missing");
  });
  row("collect", [&] {
    if (collect(folder).done != cases) throw std::runtime_error("cases are missing");
  });
  std::uintmax_t bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "segments")) bytes += entry.file_size();
  std::printf("segments\t%ju\ntable\t%ju\n", bytes, std::filesystem::file_size(folder / "table.csv"));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 4) throw std::runtime_error("usage: bench-store FOLDER CASES SEGMENTS");
    run(argv[1], std::strtoull(argv[2], nullptr, 10), std::strtoull(argv[3], nullptr, 10));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "bench-store: %s\n", e.what());
    return 1;
  }
}
