#include "withy/results/checkpoint_files.hpp"

#include <fmt/format.h>

#include <boost/crc.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "withy/results/output_file.hpp"
#include "withy/results/results_error.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;
using Bytes = std::vector<std::uint8_t>;

constexpr const char* format = "withy-checkpoint/2";

std::uint32_t checksum(const Bytes& bytes) {
  boost::crc_32_type crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

/// Refuses what is nested deeper than any checkpoint: the reader of CBOR calls itself for each level.
class Depth final : public nlohmann::json_sax<Json> {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool key(string_t&) override { return true; }
  bool start_object(std::size_t) override { return ++level_ < most; }
  bool start_array(std::size_t) override { return ++level_ < most; }
  bool end_object() override { return --level_ >= 0; }
  bool end_array() override { return --level_ >= 0; }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

 private:
  static constexpr int most = 16;
  int level_ = 0;
};

/// Null where the bytes are no CBOR of a sensible depth.
Json from_cbor(const Bytes& bytes) {
  Depth depth;
  if (!Json::sax_parse(bytes, &depth, Json::input_format_t::cbor)) return {};
  return Json::from_cbor(bytes, true, false);
}

/// What is wrong with a file, or its content.
struct Content {
  std::string fault;
  StoredRun run;
  std::string of;  ///< fingerprint of the run
};

/// \throws Json::exception where a part is missing or is not what it should be.
Content content_of(const Json& j) {
  return {"",
          {{{j.at("time"), j.at("y")}, j.at("stepper"), j.at("watches")},
           {j.at("rows"), j.at("bytes"), j.at("sha256")},
           {}},
          j.at("run")};
}

Content read_content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return {"is not there", {}, {}};
  const Bytes bytes{std::istreambuf_iterator<char>(in), {}};
  const Json outer = from_cbor(bytes);
  const auto format_there = outer.is_object() ? outer.find("format") : outer.end();
  if (format_there == outer.end() || *format_there != format) return {"is no checkpoint, or cut short", {}, {}};
  const auto content = outer.find("content");
  const auto sum = outer.find("crc32");
  if (content == outer.end() || !content->is_binary() || sum == outer.end() || !sum->is_number_unsigned())
    return {"is damaged", {}, {}};
  const Bytes& packed = content->get_binary();
  if (checksum(packed) != sum->get<std::uint32_t>()) return {"is damaged: its checksum does not fit", {}, {}};
  try {
    return content_of(from_cbor(packed));
  } catch (const Json::exception&) {
    return {"is damaged", {}, {}};
  }
}

}  // namespace

CheckpointFiles::CheckpointFiles(std::filesystem::path folder, std::string fingerprint)
    : newest_(folder / "checkpoint.cbor"),
      previous_(folder / "checkpoint.previous.cbor"),
      run_(std::move(fingerprint)) {}

void CheckpointFiles::write(const StoredRun& run) const {
  // CBOR keeps every bit of a double, infinities included.
  const Bytes packed = Json::to_cbor({{"run", run_},
                                      {"time", run.checkpoint.state.time},
                                      {"y", run.checkpoint.state.y},
                                      {"stepper", run.checkpoint.stepper},
                                      {"watches", run.checkpoint.watches},
                                      {"rows", run.table.rows},
                                      {"bytes", run.table.bytes},
                                      {"sha256", run.table.sha256}});
  const Bytes whole =
      Json::to_cbor({{"format", format}, {"crc32", checksum(packed)}, {"content", Json::binary(packed)}});
  if (std::filesystem::exists(newest_)) std::filesystem::rename(newest_, previous_);
  write_lasting_file(newest_, {reinterpret_cast<const char*>(whole.data()), whole.size()});
}

StoredRun CheckpointFiles::read() const {
  Content content = read_content(newest_);
  std::string remark;
  if (!content.fault.empty()) {
    const std::string first = fmt::format("{} {}", newest_.string(), content.fault);
    content = read_content(previous_);
    if (!content.fault.empty())
      throw ResultsError(
          fmt::format("{}, and {} {}; there is nothing to resume", first, previous_.string(), content.fault));
    remark = fmt::format("{}; going on from the checkpoint before", first);
  }
  if (content.of != run_)
    throw ResultsError(
        fmt::format("{} belongs to another scene, formulation, integrator or version; run without --resume "
                    "to begin anew",
                    newest_.string()));
  content.run.remark = std::move(remark);
  return std::move(content.run);
}

bool CheckpointFiles::exist() const { return std::filesystem::exists(newest_) || std::filesystem::exists(previous_); }

void CheckpointFiles::remove() const {
  std::filesystem::remove(newest_);
  std::filesystem::remove(previous_);
}

}  // namespace withy
