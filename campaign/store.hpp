/// \file
/// The store of a sweep: a folder with a description and segments of results. An index is made from the segments
/// whenever one is needed; there is none to go wrong.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "withy/campaign/segment.hpp"

namespace withy::campaign {

/// What a store says of itself: enough to make tables and indices without plan, scene or plugins.
struct StoreDescription {
  std::string plan;  ///< file of the plan, as the command had it
  std::string name;
  std::string fingerprint;  ///< of the plan
  std::uint64_t size = 0;   ///< cases in all
  std::uint64_t draws = 1;  ///< for each point of the grids
  Design design = Design::product;
  std::size_t levels = 4;
  std::uint64_t seed = 0;
  std::vector<std::string> paths;      ///< of what varies
  std::vector<bool> shared;            ///< of each: one value a point of the grids; empty in older stores
  std::vector<std::string> derived;    ///< of what follows from it
  std::vector<std::string> columns;    ///< of what is kept
  std::vector<std::string> histories;  ///< of what is kept over time; a case's numbers are of them behind the columns
  std::vector<double> times;           ///< [s] that each history has a number at
  std::vector<std::string> plugin_folders;  ///< that the command named
  bool drawn = false;                       ///< whether cases of a point of the grids differ by draws
  /// Whether the cases of each point of the grids are a sample.
  [[nodiscard]] bool by_draws() const { return design == Design::product && drawn && draws > 1; }
};
StoreDescription description_of(const Plan& plan);
/// The command that runs a case alone, but for the number of the case, which is to follow behind a blank.
std::string case_command(const StoreDescription& about);

/// Every so many cases of a plan: those whose number is `number` − 1 modulo `count`, `number` from 1 to `count`.
struct Shard {
  std::uint64_t number = 1, count = 1;
  [[nodiscard]] bool has(std::uint64_t index) const { return index % count == number - 1; }
  /// How many of so many cases.
  [[nodiscard]] std::uint64_t size(std::uint64_t cases) const { return (cases + count - number) / count; }
};

/// What the segments of a store hold of the cases of a shard. Eight bytes a case of it.
class StoreIndex {
 public:
  /// Reads every segment once, but for those of other shards of as many: a thousand nodes that go on would each read
  /// the results of all. \throws ResultsError where two records of one case differ; std::system_error
  StoreIndex(const std::filesystem::path& store, const StoreDescription& about, Shard shard = {});
  [[nodiscard]] bool has(std::uint64_t index) const { return shard_.has(index) && where_[index / shard_.count] != 0; }
  /// The case's result; nothing where it is missing. Cases that are read in their order are read many at a time.
  [[nodiscard]] std::optional<CaseResult> read(std::uint64_t index);
  [[nodiscard]] std::uint64_t done() const { return done_; }
  [[nodiscard]] std::uint64_t failed() const { return failed_; }
  /// Bytes that belong to no record: damage, or what was being written when a process ended.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }
  [[nodiscard]] double seconds() const { return seconds_; }  ///< CPU time of all cases
  /// Segments that a process is writing.
  [[nodiscard]] std::size_t writers() const { return writers_; }

 private:
  /// Records of cases that follow one another. Neighbours stand in different segments, more than are kept open.
  struct Block {
    std::uint64_t begin = 0;           ///< the first, among the cases of the shard
    std::vector<std::string> records;  ///< of this and the next ones; empty where there is none
  };

  void add(std::size_t segment, const StoreDescription& about);
  std::string_view record(std::uint64_t where);
  void read_block(std::uint64_t begin);

  Shard shard_;
  std::vector<std::uint64_t> where_;  ///< segment and place of each case of the shard; 0: nowhere
  std::vector<std::filesystem::path> paths_;
  std::string fingerprint_;
  std::map<std::size_t, SegmentReader> open_;
  Block block_;
  std::uint64_t next_ = 0;  ///< the case behind the one that was read last
  std::uint64_t bytes_ = 0, done_ = 0, failed_ = 0, lost_ = 0;
  double seconds_ = 0;
  std::size_t writers_ = 0;
};

/// A store that is written.
class Store {
 public:
  /// Makes the folder, or goes on with one that has the same fingerprint. Several processes may do so at once.
  /// \param anew what another plan, or whoever, left there under names of a store is removed
  /// \throws ResultsError where the folder holds something else; study::InputError where a file that the plan was read
  /// from has a name of the store; FolderBusy; std::runtime_error where the folder cannot be made; std::system_error
  Store(std::filesystem::path path, const Plan& plan, bool anew);
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const StoreDescription& about() const { return about_; }
  /// The file of a worker of a shard, from 1.
  [[nodiscard]] std::filesystem::path segment(std::uint64_t shard, std::uint64_t shards, std::size_t worker) const;

 private:
  void make(bool anew) const;
  [[nodiscard]] bool is_same() const;
  [[nodiscard]] bool goes_on() const;
  void clear() const;

  std::filesystem::path path_;
  StoreDescription about_;
};

/// Writes store.json whole: several processes may begin a store at once. \throws std::system_error
void write_description(const std::filesystem::path& store, const StoreDescription& about);

/// \throws ResultsError where the folder is no store.
StoreDescription read_description(const std::filesystem::path& store);

}  // namespace withy::campaign
