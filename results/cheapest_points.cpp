#include "withy/results/cheapest_points.hpp"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "withy/results/trade_files.hpp"

namespace withy {

std::vector<CheapestPoint> cheapest_points(const std::vector<study::TradeResult>& results,
                                           const std::vector<double>& shares) {
  std::map<std::string, std::vector<const study::TradeResult*>> by_over;
  for (const study::TradeResult& r : results)
    if (r.completed()) by_over[trade_over_text(r.point)].push_back(&r);
  std::vector<CheapestPoint> points;
  for (const auto& [over, done] : by_over) {
    for (const double limit : shares) {
      const study::TradeResult* best = nullptr;
      for (const study::TradeResult* r : done)
        if (r->relative_error <= limit && (best == nullptr || r->cpu_seconds < best->cpu_seconds)) best = r;
      points.push_back({over, limit, best});
    }
  }
  return points;
}

std::string cheapest_text(const std::vector<study::TradeResult>& results, const std::vector<double>& shares) {
  std::string out;
  for (const CheapestPoint& p : cheapest_points(results, shares)) {
    const std::string within = fmt::format("within {:g} %{}", 100 * p.within, p.over.empty() ? "" : " at " + p.over);
    out += p.result == nullptr ? fmt::format("{:<12} none of these models\n", within)
                               : fmt::format("{:<12} {}: {:.2g} % off, {:.3g} ms\n", within, p.result->point.text(),
                                             100 * p.result->relative_error, 1e3 * p.result->cpu_seconds);
  }
  return out.empty() ? out : "Cheapest:\n" + out + '\n';
}

nlohmann::ordered_json cheapest_json(const std::vector<study::TradeResult>& results,
                                     const std::vector<double>& shares) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const CheapestPoint& p : cheapest_points(results, shares))
    all.push_back({{"over", p.over},
                   {"within", p.within},
                   {"point", p.result == nullptr ? nlohmann::ordered_json()
                                                 : nlohmann::ordered_json(p.result - results.data())}});
  return all;
}

}  // namespace withy
