/// \file
/// Reports benchmarks and then, of pairs measured in the same run, our time as a part of the rival's.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace withy::bench {

/// A statement about medians of CPU time, printed with the figure it asks for; `most` 0: none.
struct Ratio {
  std::string ours, rival;
  double most = 0;
};
/// Time of one unit of a benchmark (a link), in ns.
struct PerUnit {
  std::string name;
  double units = 1, most = 0;
};
/// Exponent of the growth of time between two benchmarks whose sizes have this ratio.
struct Growth {
  std::string small, large;
  double sizes = 1, most = 0;
};

class Summary final : public benchmark::ConsoleReporter {
 public:
  Summary() : ConsoleReporter(OO_None) {}
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type == Run::RT_Iteration) times_[run.run_name.function_name].push_back(run.GetAdjustedCPUTime());
    }
  }
  /// Median in ns; 0 where it was not measured.
  [[nodiscard]] double median(const std::string& name) const {
    const auto found = times_.find(name);
    if (found == times_.end()) return 0;
    std::vector<double> t = found->second;
    std::nth_element(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(t.size() / 2), t.end());
    return t[t.size() / 2];
  }
  void print(const std::vector<Ratio>& ratios) const {
    for (const Ratio& r : ratios) {
      const double a = median(r.ours), b = median(r.rival);
      if (a > 0 && b > 0) line(r.ours + " / " + r.rival, a, b, a / b, r.most);
    }
  }
  void print(const std::vector<PerUnit>& units) const {
    for (const PerUnit& u : units) {
      const double a = median(u.name);
      if (a > 0) line(u.name + ", ns a link", a, u.units, a / u.units, u.most);
    }
  }
  void print(const std::vector<Growth>& growths) const {
    for (const Growth& g : growths) {
      const double a = median(g.large), b = median(g.small);
      if (a > 0 && b > 0)
        line(g.small + " -> " + g.large + ", exponent", a, b, std::log(a / b) / std::log(g.sizes), g.most);
    }
  }

 private:
  static void line(const std::string& what, double a, double b, double figure, double most) {
    std::printf("%-58s %12.1f %12.1f %10.3f", what.c_str(), a, b, figure);
    if (most > 0) std::printf("  (at most %g)%s", most, figure <= most ? "" : "  MISSED");
    std::printf("\n");
  }
  std::map<std::string, std::vector<double>> times_;
};

/// Keeps the process on one core's clock: medians of several repetitions in random order.
inline void initialize(int argc, char** argv) {
  std::vector<char*> arguments(argv, argv + argc);
  char interleave[] = "--benchmark_enable_random_interleaving=true";
  char repetitions[] = "--benchmark_repetitions=5";
  char time[] = "--benchmark_min_time=0.05";
  // What the user gives comes last and wins.
  arguments.insert(arguments.begin() + 1, {interleave, repetitions, time});
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
}

}  // namespace withy::bench
