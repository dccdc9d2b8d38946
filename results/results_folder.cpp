#include "withy/results/results_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>

#include "withy/results/json_text.hpp"
#include "withy/results/make_folder.hpp"
#include "withy/results/output_name.hpp"
#include "withy/results/results_error.hpp"
#include "withy/scene/sha256.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* format_of_record = "withy-result/1";
constexpr const char* name_of_record = "result.json";
constexpr std::size_t longest_suffix = 100;

std::string text_of_record(const std::filesystem::path& folder) {
  std::ifstream in(folder / name_of_record, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// What a folder says of itself; null where it says nothing, or nothing that can be read.
Json read_record(const std::filesystem::path& folder) {
  Json j = Json::parse(text_of_record(folder), nullptr, false);
  return j.is_object() && j.value("format", "") == format_of_record ? j : Json();
}

/// Who took the folder last, in words.
std::string recorded_writer(const std::filesystem::path& folder) {
  const Json kept = read_record(folder);
  const Json process = kept.is_null() ? Json() : kept.value("process", Json());
  return process.is_number() ? "process " + process.dump() : "another process";
}

FolderBusy busy(const std::filesystem::path& folder, const std::string& writer) {
  return FolderBusy(
      fmt::format("{} is being written by {}; wait for its end, or give another folder", folder.string(), writer));
}

/// Whether `result.json` is no record, nor what is left of one.
bool is_foreign(const std::filesystem::path& folder) {
  const std::string text = text_of_record(folder);
  return !text.empty() && text.find(format_of_record) == std::string::npos;
}

std::vector<std::string> recorded_content(const Json& record) {
  std::vector<std::string> names;
  const auto content = record.find("content");
  if (content == record.end() || !content->is_array()) return names;
  for (const Json& name : *content)
    if (name.is_string()) names.push_back(name.get<std::string>());
  return names;
}

/// A plain name, or one below a folder in it: what a record may have removed.
bool is_inside(const std::string& name) {
  const std::filesystem::path path = name;
  return !path.empty() && path.is_relative() && std::find(path.begin(), path.end(), "..") == path.end();
}

std::vector<std::string> present(const std::filesystem::path& folder, const std::vector<std::string>& names) {
  std::vector<std::string> there;
  for (const std::string& name : names)
    if (std::filesystem::exists(folder / name)) there.push_back(name);
  return there;
}

bool same_result(const Json& kept, const Json& now) {
  return !kept.is_null() && kept.value("command", "") == now.at("command") &&
         kept.value("subject", "") == now.at("subject");
}

std::vector<std::string> united(std::vector<std::string> names, const std::vector<std::string>& more) {
  for (const std::string& name : more)
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

/// Why the folder cannot be taken for this result, whose record is `now`; empty where it can.
std::string refusal(const std::filesystem::path& folder, const Json& kept, const Json& now,
                    const std::vector<std::string>& content) {
  constexpr const char* advice = "give another folder, or --force to replace it";
  std::vector<std::string> there = present(folder, kept.is_null() ? content : recorded_content(kept));
  if (is_foreign(folder)) there.emplace_back(name_of_record);
  if (there.empty() || same_result(kept, now)) return {};
  if (kept.is_null())
    return fmt::format("{} holds {}, and nothing says of what result: {}", folder.string(), there.front(), advice);
  const std::string command = kept.value("command", "");
  if (command != now.at("command"))
    return fmt::format("{} holds a result of withy {}: {}", folder.string(), command, advice);
  const std::string scene = kept.value("scene", "");
  if (scene != now.at("scene"))
    return fmt::format("{} holds the result of another scene, {}: {}", folder.string(), scene, advice);
  return fmt::format("{} holds the result of other values of {}: {}", folder.string(), scene, advice);
}

/// Why a result goes on otherwise than it began.
std::string change(const Json& kept, const Provenance& now) {
  if (kept.is_null()) return {};
  try {
    return differences(provenance_of_json(kept), now);
  } catch (const ResultsError&) {
    return {};
  }
}

}  // namespace

ResultsFolder::ResultsFolder(std::filesystem::path path, const std::string& command, const Provenance& provenance,
                             const std::vector<std::string>& content, FolderUse use)
    : path_(std::move(path)) {
  make_folder(path_);
  lock();
  try {
    take(command, provenance, content, use);
  } catch (...) {
    std::error_code ignored;
    if (std::filesystem::is_empty(path_ / name_of_record, ignored))
      std::filesystem::remove(path_ / name_of_record, ignored);
    ::close(file_);
    throw;
  }
}

void ResultsFolder::take(const std::string& command, const Provenance& provenance,
                         const std::vector<std::string>& content, FolderUse use) {
  const Json kept = read_record(path_);
  Json now = stored_provenance(provenance);
  now["format"] = format_of_record;
  now["command"] = command;
  now["subject"] = provenance.subject();
  now["content"] = content;
  now["process"] = ::getpid();
  if (use == FolderUse::begin)
    if (const std::string why = refusal(path_, kept, now, content); !why.empty()) throw ResultsError(why);
  changed_ = change(kept, provenance);
  if (use == FolderUse::go_on && !changed_.empty()) return;  // the caller will not go on
  std::vector<std::string> old = content;
  if (use != FolderUse::go_on && !same_result(kept, now)) {
    old = united(old, recorded_content(kept));
  } else {
    now["content"] = united(recorded_content(kept), content);
  }
  std::erase_if(old, [](const std::string& name) { return !is_inside(name); });
  if (use != FolderUse::go_on) {
    keep_inputs_in(path_, united({name_of_record}, old), provenance.reads);
    for (const std::string& name : old) std::filesystem::remove_all(path_ / name);
  }
  write(json_text(now));
}

ResultsFolder::~ResultsFolder() { ::close(file_); }

void ResultsFolder::lock() {
  const std::filesystem::path record = path_ / name_of_record;
  file_ = ::open(record.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) throw std::system_error(errno, std::generic_category(), record.string());
  if (::flock(file_, LOCK_EX | LOCK_NB) == 0) return;
  const int error = errno;
  ::close(file_);
  if (error != EWOULDBLOCK) throw std::system_error(error, std::generic_category(), record.string());
  throw busy(path_, recorded_writer(path_));
}

// In place, since the lock is the file's. It is never cut to nothing: ext4 has a file that was written to the disk at
// once, and the next run's cut would wait for that.
void ResultsFolder::write(const std::string& text) const {
  const auto fail = [&] { throw std::system_error(errno, std::generic_category(), (path_ / name_of_record).string()); };
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t count = ::pwrite(file_, text.data() + done, text.size() - done, static_cast<off_t>(done));
    if (count < 0 && errno != EINTR) fail();
    if (count > 0) done += static_cast<std::size_t>(count);
  }
  if (::ftruncate(file_, static_cast<off_t>(text.size())) != 0) fail();
}

std::string writer_of(const std::filesystem::path& folder) {
  const int file = ::open((folder / name_of_record).c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return {};
  // Shared, so that several may ask at once; closing gives it back.
  const bool locked = ::flock(file, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(file);
  return locked ? recorded_writer(folder) : std::string();
}

void refuse_busy(const std::filesystem::path& folder) {
  if (const std::string writer = writer_of(folder); !writer.empty()) throw busy(folder, writer);
}

std::string folder_suffix(const std::vector<std::string>& settings) {
  std::string text;
  for (const std::string& setting : settings) text += (text.empty() ? '-' : ',') + setting;
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.' ||
           c == '-' || c == '+' || c == '=' || c == ',';
  };
  if (text.size() <= longest_suffix && std::all_of(text.begin(), text.end(), plain)) return text;
  std::string whole;
  for (const std::string& setting : settings) whole += setting + '\n';
  return "-set-" + sha256(whole).substr(0, 8);
}

}  // namespace withy
