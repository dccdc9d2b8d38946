#include "withy/campaign/store.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>
#include <utility>

#include "withy/campaign/cases.hpp"
#include "withy/campaign/kept.hpp"
#include "withy/campaign/own_part.hpp"
#include "withy/campaign/plan_reader.hpp"
#include "withy/results/json_text.hpp"
#include "withy/results/make_folder.hpp"
#include "withy/results/output_name.hpp"
#include "withy/results/report/report_page.hpp"
#include "withy/results/results_error.hpp"
#include "withy/results/results_folder.hpp"
#include "withy/results/run_command.hpp"
#include "withy/scene/sha256.hpp"

namespace withy::campaign {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* format_of_store = "withy-store/2";
constexpr const char* name_of_description = "store.json";
constexpr const char* name_of_segments = "segments";
constexpr const char* name_of_lock = "store.lock";
/// Files that a store has beside its segments.
constexpr std::array<const char*, 8> names_of_files = {name_of_description, "table.csv",  "statistics.csv",
                                                       "indices.csv",       "failed.csv", "histories.csv",
                                                       "histories.svg",     report_name};
constexpr std::uint64_t most_in_block = std::uint64_t{64} << 20;  // bytes of records that are read at once
constexpr int place_bits = 44;  // of a place in a segment: 16 TiB; the rest counts segments, to a million

Json json_of(const StoreDescription& d) {
  return {{"format", format_of_store},
          {"plan", d.plan},
          {"name", d.name},
          {"fingerprint", d.fingerprint},
          {"cases", d.size},
          {"draws", d.draws},
          {"design", keys::designs.at(static_cast<std::size_t>(d.design))},
          {"levels", d.levels},
          {"seed", d.seed},
          {"paths", d.paths},
          {"shared", d.shared},
          {"derived", d.derived},
          {"columns", d.columns},
          {"drawn", d.drawn},
          {"histories", d.histories},
          {"times", d.times},
          {"plugin_folders", d.plugin_folders}};
}

/// The description with its checksum.
std::string text_of(const StoreDescription& about) {
  Json j = json_of(about);
  j["sha256"] = sha256(j.dump());
  return json_text(j);
}

Design design_of(const std::string& name) {
  const auto at = std::find(keys::designs.begin(), keys::designs.end(), name);
  return static_cast<Design>(at - keys::designs.begin());
}

/// The same, to be given back where a folder is none, or its description is damaged.
std::optional<StoreDescription> described(const std::filesystem::path& store) {
  std::ifstream in(store / name_of_description, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  Json j = Json::parse(text, nullptr, false);
  try {
    if (!j.is_object() || j.at("format") != format_of_store) return {};
    const Json sum = j.at("sha256");
    j.erase("sha256");
    if (sum != sha256(j.dump())) return {};
    StoreDescription d;
    d.plan = j.at("plan");
    d.name = j.at("name");
    d.fingerprint = j.at("fingerprint");
    d.size = j.at("cases");
    d.draws = j.at("draws");
    d.design = design_of(j.at("design"));
    d.levels = j.at("levels");
    d.seed = j.at("seed");
    d.paths = j.at("paths");
    d.derived = j.at("derived");
    d.columns = j.at("columns");
    d.drawn = j.at("drawn");
    // Stores of earlier versions keep nothing over time, and do not say what is drawn.
    d.shared = j.value("shared", std::vector<bool>());
    d.histories = j.value("histories", std::vector<std::string>());
    d.times = j.value("times", std::vector<double>());
    d.plugin_folders = j.value("plugin_folders", std::vector<std::string>());
    return d;
  } catch (const Json::exception&) {
    return {};
  }
}

std::vector<std::filesystem::path> segments_of(const std::filesystem::path& store) {
  std::vector<std::filesystem::path> all;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(store / name_of_segments, none))
    if (entry.path().extension() == ".segment") all.push_back(entry.path());
  std::sort(all.begin(), all.end());
  return all;
}

bool is_locked(const std::filesystem::path& segment) {
  const int file = ::open(segment.c_str(), O_RDONLY | O_CLOEXEC);
  const bool locked = file >= 0 && ::flock(file, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  if (file >= 0) ::close(file);
  return locked;
}

/// Whether a segment is of this plan, by its head; an empty one is of any.
bool is_of(const std::filesystem::path& segment, const std::string& fingerprint) {
  SegmentReader reader(segment, fingerprint);
  return std::filesystem::file_size(segment) == 0 || reader.begins_well() || reader.next();
}

/// Whether a segment is of another shard of as many, by its name.
bool is_of_another(const std::filesystem::path& segment, Shard shard) {
  const std::string name = segment.filename().string(), end = fmt::format("-of-{}.", shard.count);
  return name.find(end) != std::string::npos && !name.starts_with(fmt::format("{}{}", shard.number, end));
}

/// What is there that a store would replace, and none has left: a file by its name, or others in the place of segments.
std::string foreign_in(const std::filesystem::path& store) {
  std::error_code none;
  for (const char* name : names_of_files)
    if (std::filesystem::exists(store / name, none)) return name;
  const std::filesystem::path segments = store / name_of_segments;
  const bool vacant = !std::filesystem::exists(segments, none) || std::filesystem::is_empty(segments, none);
  return vacant ? "" : name_of_segments;
}

/// One process at a time makes a store, from `take` on as long as this lives. The file stays: whoever waits for it has
/// it open.
class StoreLock {
 public:
  /// \throws std::system_error
  explicit StoreLock(const std::filesystem::path& path)
      : path_(path), file_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
    if (file_ < 0) throw std::system_error(errno, std::generic_category(), path_.string());
  }
  ~StoreLock() { ::close(file_); }
  StoreLock(const StoreLock&) = delete;
  StoreLock& operator=(const StoreLock&) = delete;

  /// Waits until the lock is free.
  /// \param made whether another process has made the store: it is asked while this waits, for then nobody need
  /// \returns false where it has
  /// \throws std::system_error; FolderBusy where it takes longer than any making of a store
  bool take(const std::function<bool()>& made) {
    using namespace std::chrono_literals;
    constexpr std::chrono::milliseconds patience = 20s, pause = 10ms;
    const auto end = std::chrono::steady_clock::now() + patience;
    while (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
      if (errno != EWOULDBLOCK && errno != EINTR)
        throw std::system_error(errno, std::generic_category(), path_.string());
      if (made()) return false;
      if (std::chrono::steady_clock::now() > end)
        throw FolderBusy(path_.string() +
                         " has been locked for 20 s by another process, which has not made the store: is it stopped?");
      std::this_thread::sleep_for(pause);
    }
    return true;
  }

 private:
  std::filesystem::path path_;
  int file_;
};

/// Two runs of one case differ in their times alone.
bool same(CaseResult a, CaseResult b) {
  a.seconds = b.seconds = 0;
  return encode(a) == encode(b);
}

}  // namespace

StoreDescription description_of(const Plan& plan) {
  StoreDescription d;
  d.plan = plan.file;
  d.plugin_folders = plan.plugin_folders;
  d.name = plan.name;
  d.fingerprint = plan.fingerprint;
  d.size = Cases(plan).size();
  d.draws = plan.cases;
  d.design = plan.design;
  d.levels = plan.levels;
  d.seed = plan.seed;
  for (const Axis& axis : plan.axes) {
    d.paths.push_back(axis.path);
    d.shared.push_back(!axis.drawn());
    d.drawn = d.drawn || axis.drawn();
  }
  for (const Derived& derived : plan.derived) d.derived.push_back(derived.path);
  d.columns = kept_columns(plan);
  d.histories = history_columns(plan);
  d.times = plan.history.times;
  return d;
}

std::string case_command(const StoreDescription& about) {
  return command_with("withy sweep case", about.plan, about.plugin_folders);
}

void write_description(const std::filesystem::path& store, const StoreDescription& about) {
  const std::filesystem::path whole = store / name_of_description, own = own_part(whole);
  write_lasting_file(own, text_of(about));
  std::filesystem::rename(own, whole);
}

StoreDescription read_description(const std::filesystem::path& store) {
  if (auto about = described(store)) return *about;
  throw ResultsError(
      store.string() +
      " is no store of a sweep; need the folder that withy sweep run PLAN --out STORE keeps its results in");
}

Store::Store(std::filesystem::path path, const Plan& plan, bool anew)
    : path_(std::move(path)), about_(description_of(plan)) {
  for (const char* name : names_of_files) keep_inputs(path_ / name, plan.files);
  if (anew || !is_same()) make(anew);
  clear_parts(path_ / name_of_description);
}

void Store::make(bool anew) const {
  make_folder(path_);
  // Shards may begin a store together: one makes it, and the others find it made.
  StoreLock lock(path_ / name_of_lock);
  if (!lock.take([&] { return !anew && is_same(); })) return;
  try {
    if (!anew && goes_on()) return;
  } catch (const ResultsError&) {
    std::error_code ignored;
    if (!std::filesystem::exists(path_ / name_of_description, ignored))
      std::filesystem::remove(path_ / name_of_lock, ignored);  // the folder is somebody else's
    throw;
  }
  if (anew) clear();
  make_folder(path_ / name_of_segments);
  write_description(path_, about_);
}

/// Whether the folder is the store of the plan.
bool Store::is_same() const {
  const auto kept = described(path_);
  if (!kept || kept->fingerprint != about_.fingerprint) return false;
  // The plan may have another file, title or plugins' folders by now: commands and pages name those of today.
  if (text_of(*kept) != text_of(about_)) write_description(path_, about_);
  return true;
}

/// Whether the folder is the store of the plan, or what is left of it; false where nothing is there that a store would
/// replace. \throws ResultsError where it is something else
bool Store::goes_on() const {
  constexpr const char* advice = "give another folder, or --force to begin anew";
  if (is_same()) return true;
  if (described(path_))
    throw ResultsError(
        fmt::format("{} holds the cases of another plan, or the plan, its scene, a plugin or the program has "
                    "changed since: {}",
                    path_.string(), advice));
  if (const auto segments = segments_of(path_); !segments.empty()) {
    // Whose the cases are stands in the segments too, and the plan says the rest.
    for (const std::filesystem::path& segment : segments)
      if (!is_of(segment, about_.fingerprint))
        throw ResultsError(fmt::format("{} is damaged, or not there, and {} holds cases of another plan: {}",
                                       (path_ / name_of_description).string(), segment.string(), advice));
    write_description(path_, about_);
    return true;
  }
  if (std::filesystem::exists(path_ / "result.json"))
    throw ResultsError(fmt::format("{} holds the result of another command: {}", path_.string(), advice));
  if (const std::string name = foreign_in(path_); !name.empty())
    throw ResultsError(fmt::format("{} holds {}, and nothing says of what result: {}", path_.string(), name, advice));
  return false;
}

/// Removes what a store may have, and no other file. \throws FolderBusy
void Store::clear() const {
  const std::vector<std::filesystem::path> segments = segments_of(path_);
  for (const std::filesystem::path& segment : segments)
    if (is_locked(segment))
      throw FolderBusy(segment.string() + " is being written by another process; wait for its end");
  for (const std::filesystem::path& segment : segments) std::filesystem::remove(segment);
  for (const char* name : names_of_files) std::filesystem::remove(path_ / name);
}

std::filesystem::path Store::segment(std::uint64_t shard, std::uint64_t shards, std::size_t worker) const {
  return path_ / name_of_segments / fmt::format("{}-of-{}.{}.segment", shard, shards, worker);
}

StoreIndex::StoreIndex(const std::filesystem::path& store, const StoreDescription& about, Shard shard)
    : shard_(shard), where_(shard.size(about.size)), fingerprint_(about.fingerprint) {
  for (const std::filesystem::path& path : segments_of(store))
    if (!is_of_another(path, shard)) paths_.push_back(path);
  for (std::size_t s = 0; s < paths_.size(); ++s) add(s, about);
}

void StoreIndex::add(std::size_t segment, const StoreDescription& about) {
  if (is_locked(paths_[segment])) ++writers_;
  SegmentReader reader(paths_[segment], fingerprint_);
  while (const auto record = reader.next()) {
    const auto result = decode(*record);
    if (!result || result->index >= about.size || !shard_.has(result->index)) continue;
    if (has(result->index)) {
      if (!same(*read(result->index), *result))
        throw ResultsError(fmt::format("{}: case {} has two results that differ: it is not reproducible",
                                       paths_[segment].string(), result->index));
      continue;
    }
    where_[result->index / shard_.count] = (static_cast<std::uint64_t>(segment) << place_bits | reader.place()) + 1;
    bytes_ += record->size();
    ++done_;
    if (!result->completed()) ++failed_;
    seconds_ += result->seconds;
  }
  lost_ += reader.lost();
}

/// The record at a segment and place, until the next call.
std::string_view StoreIndex::record(std::uint64_t where) {
  constexpr std::size_t most_open = 64;
  const auto segment = static_cast<std::size_t>((where - 1) >> place_bits);
  if (open_.size() >= most_open && !open_.contains(segment)) open_.clear();
  const auto [reader, made] = open_.try_emplace(segment, paths_[segment], fingerprint_);
  const auto record = reader->second.at((where - 1) & ((std::uint64_t{1} << place_bits) - 1));
  if (!record) throw ResultsError(paths_[segment].string() + " has changed while it was read");
  return *record;
}

/// Goes through the segments one after the other, and through each from its beginning to its end.
void StoreIndex::read_block(std::uint64_t begin) {
  const std::uint64_t slot = begin / shard_.count, mean = bytes_ / done_ + sizeof(std::string);
  const std::uint64_t count = std::min(std::max<std::uint64_t>(1, most_in_block / mean), where_.size() - slot);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> places;  // where, and which of the block
  for (std::uint64_t k = 0; k < count; ++k)
    if (where_[slot + k] != 0) places.emplace_back(where_[slot + k], k);
  std::sort(places.begin(), places.end());
  block_.begin = slot;
  block_.records.assign(count, {});
  for (const auto& [where, k] : places) block_.records[k] = record(where);
}

std::optional<CaseResult> StoreIndex::read(std::uint64_t index) {
  if (!has(index)) return {};
  const std::uint64_t slot = index / shard_.count;
  const bool in_order = slot == next_;
  next_ = slot + 1;
  const auto in_block = [&] { return slot >= block_.begin && slot - block_.begin < block_.records.size(); };
  if (!in_block() && in_order && slot > 0) read_block(index);
  // What was found after the block was read is not in it.
  if (in_block() && !block_.records[slot - block_.begin].empty()) return decode(block_.records[slot - block_.begin]);
  return decode(record(where_[slot]));
}

}  // namespace withy::campaign
