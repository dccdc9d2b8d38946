#include "withy/results/kept_results.hpp"

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "withy/results/json_text.hpp"
#include "withy/results/output_file.hpp"
#include "withy/scene/sha256.hpp"

namespace withy {
namespace {
using Json = nlohmann::ordered_json;
}  // namespace

KeptResults::KeptResults(std::filesystem::path folder, std::string fingerprint)
    : folder_(std::move(folder)), fingerprint_(std::move(fingerprint)) {}

void KeptResults::keep(const std::string& key, const Json& result) const {
  std::filesystem::create_directories(folder_);
  // What is read back and hashed is what the file says, where a number that is not finite has become null.
  const Json written = Json::parse(json_text(result));
  write_file(folder_ / (key + ".json"),
             json_text({{"fingerprint", fingerprint_}, {"sha256", sha256(written.dump())}, {"result", written}}));
}

std::optional<Json> KeptResults::find(const std::string& key) const {
  std::ifstream in(folder_ / (key + ".json"), std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const Json j = Json::parse(text, nullptr, false);
  if (!j.is_object() || !j.contains("result") || !j.contains("fingerprint") || !j.contains("sha256")) return {};
  if (j["fingerprint"] != fingerprint_ || j["sha256"] != sha256(j["result"].dump())) return {};
  return j["result"];
}

}  // namespace withy
