/// \file
/// Trade studies as JSON, table and picture, and the folder that keeps their finished points.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "withy/results/cheapest_points.hpp"
#include "withy/results/kept_results.hpp"
#include "withy/study/trade.hpp"

namespace withy {

/// The values gone over for people: "time_scale=1.2 end=3".
std::string trade_over_text(const study::Point& point);

/// Whether errors of hinges, and of tips, were measured at all: those of a study that is not asked for them are zero.
bool measures_hinges(const study::Outputs& outputs);
bool measures_tips(const study::Outputs& outputs);

nlohmann::ordered_json trade_result_json(const study::TradeResult& result);
nlohmann::ordered_json trade_reference_json(const study::TradeReference& reference);
/// The content of trade.json; what was not measured is null. \param front one a result \param shares errors that the
/// cheapest is named of
nlohmann::ordered_json trade_json(const Scene& scene, const study::TradeStudy& study,
                                  const std::vector<study::TradeResult>& results, const std::vector<bool>& front,
                                  const std::vector<double>& shares = usual_shares());
/// A line a point; what was not measured is empty.
std::string trade_csv(const std::vector<study::TradeResult>& results, const std::vector<bool>& front,
                      const study::Outputs& outputs);
/// Error over cost, both logarithmic; a colour a formulation, the front as a line. A panel for each of the values gone
/// over.
std::string trade_picture(const std::string& title, const std::vector<study::TradeResult>& results,
                          const std::vector<bool>& front);

/// What the page of a trade shows: the same with the command that runs each model.
/// \param plugin_folders that the command has to name
nlohmann::ordered_json trade_page(const study::Prepared& prepared, nlohmann::ordered_json trade,
                                  const std::vector<study::TradeResult>& results, Registry& registry,
                                  const std::vector<std::string>& plugin_folders);
/// The files of a trade in its folder: JSON, table, picture and their page.
std::vector<std::string> trade_content();
/// Writes them. \param content of trade.json \throws std::system_error
void write_trade(const std::filesystem::path& folder, const study::Prepared& prepared,
                 const nlohmann::ordered_json& content, const std::vector<study::TradeResult>& results,
                 const std::vector<bool>& front, const study::Outputs& outputs, Registry& registry,
                 const std::vector<std::string>& plugin_folders);

/// Finished points in a folder, a file each.
class TradeFolder : public study::PointStore {
 public:
  /// \param folder its `points` is made with the first
  /// \param fingerprint of all that points have in common: those of another study are not found
  TradeFolder(const std::filesystem::path& folder, const std::string& fingerprint)
      : points_(folder / "points", fingerprint) {}
  std::optional<Kept> find(const study::Point& point) override;
  void keep(const Kept& kept) override;

 private:
  KeptResults points_;
};

/// Of a study: the scene, what the points ask of a reference, and the builds of the plugins that they name.
/// \param outputs that errors are measured on
std::string trade_fingerprint(const study::Prepared& prepared, const std::vector<study::Point>& points,
                              Registry& registry, const std::vector<std::string>& outputs);

}  // namespace withy
