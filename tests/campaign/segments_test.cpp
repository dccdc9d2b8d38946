// Segments of a store: what was kept is found again to the last bit, and damage costs what it touches.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "withy/campaign/store.hpp"
#include "withy/results/results_folder.hpp"
#include "withy/tests/campaign/store_fixture.hpp"

namespace withy::campaign {
namespace {

using test::PlanFolder;

const std::string fingerprint(64, 'a');

std::map<std::uint64_t, std::string> records(const std::filesystem::path& path) {
  SegmentReader reader(path, fingerprint);
  std::map<std::uint64_t, std::string> all;
  while (const auto record = reader.next()) all.emplace(decode(*record)->index, *record);
  return all;
}

TEST(Segments, KeepEveryStatusThatARunCanHave) {
  CaseResult r = made(1);
  for (const RunStatus status :
       {RunStatus::completed, RunStatus::inaccurate, RunStatus::diverged, RunStatus::singular,
        RunStatus::step_underflow, RunStatus::interrupted, RunStatus::load_failed, RunStatus::too_stiff}) {
    r.status = name(status);
    EXPECT_EQ(decode(encode(r))->status, name(status));
  }
}

TEST(Segments, TellWhatIsTakenAwayFromWhatStays) {
  const CaseResult r = *decode(encode(made(1)));
  ASSERT_EQ(r.values.size(), 4U);
  EXPECT_EQ(r.values[0]->number(), 0.1);
  EXPECT_EQ(r.values[1]->text(), "quadratic");
  ASSERT_TRUE(r.values[2]);
  EXPECT_EQ(r.values[2]->kind(), Value::Kind::null);
  EXPECT_FALSE(r.values[3]);
}

TEST(Segments, ARecordIsNoneThatIsLongerOrShorterThanWhatItHolds) {
  const std::string bytes = encode(made(1));
  EXPECT_TRUE(decode(bytes));
  EXPECT_FALSE(decode(bytes + '\0'));
  EXPECT_FALSE(decode(bytes.substr(0, bytes.size() - 1)));
}

TEST(Segments, AnyDamageCostsTheRecordsItTouchesAndNoOther) {
  const PlanFolder folder;
  const std::filesystem::path path = folder / "a.segment";
  std::vector<std::size_t> ends;
  {
    SegmentWriter writer(path, fingerprint);
    for (std::uint64_t i = 0; i < 60; ++i) {
      writer.append(made(i));
      ends.push_back(std::filesystem::file_size(path));
    }
    writer.close();
  }
  const std::string whole = folder.read("a.segment");
  std::mt19937 random(4);
  const std::size_t head = ends[0] - (ends[1] - ends[0]);
  for (int trial = 0; trial < 400; ++trial) {
    std::string bytes = whole;
    std::size_t from = random() % whole.size(), to = from + 1 + random() % 300;
    to = std::min(to, whole.size());
    std::size_t cut = whole.size();
    if (trial % 3 == 0) {
      for (std::size_t i = from; i < to; ++i) bytes[i] = static_cast<char>(random());
    } else if (trial % 3 == 1) {
      bytes.resize(cut = from);
    } else {
      bytes.erase(from, to - from);
    }
    folder.write("b.segment", bytes);
    const auto found = records(folder / "b.segment");
    for (const auto& [index, record] : found) EXPECT_EQ(record, encode(made(index)));
    for (std::uint64_t i = 0; i < 60; ++i) {
      const std::size_t begin = i == 0 ? head : ends[i - 1];
      const bool touched = ends[i] > cut || (trial % 3 != 1 && begin < to && from < ends[i]);
      if (!touched) {
        EXPECT_TRUE(found.contains(i)) << trial << ' ' << i;
      }
    }
  }
}

TEST(Segments, GoOnBehindATornRecordAndHaveOneWriter) {
  const PlanFolder folder;
  const std::filesystem::path path = folder / "a.segment";
  {
    SegmentWriter writer(path, fingerprint);
    writer.append(made(1));
    writer.append(made(2));
    EXPECT_THROW(SegmentWriter(path, fingerprint), FolderBusy);
  }
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 3);
  {
    SegmentWriter writer(path, fingerprint);
    writer.append(made(3));
  }
  const auto found = records(path);
  EXPECT_EQ(found.size(), 2U);
  EXPECT_TRUE(found.contains(1));
  EXPECT_TRUE(found.contains(3));
  SegmentReader other(path, std::string(64, 'b'));
  EXPECT_FALSE(other.next()) << "records of another plan are none";
}

}  // namespace
}  // namespace withy::campaign
