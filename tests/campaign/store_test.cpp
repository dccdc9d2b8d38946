// Stores: what is damaged is made again and nothing else, and nothing of another plan is mixed in.
#include "withy/campaign/store.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "withy/results/results_error.hpp"
#include "withy/tests/campaign/store_fixture.hpp"

namespace withy::campaign {
namespace {

using test::PlanFolder;

TEST(Sweeps, RepeatWhatIsDamagedAndNothingElse) {
  const PlanFolder folder;
  const Plan plan = folder.plan(twelve);
  run(folder, plan, "store", {1, 1, 1, {}});
  const std::string table = table_of(folder, "store");
  const std::string segment = "store/segments/1-of-1.0.segment";
  std::string bytes = folder.read(segment);
  bytes[bytes.size() / 2] ^= 1;
  bytes.resize(bytes.size() - 5);
  folder.write(segment, bytes);
  const SweepOutcome repeated = run(folder, plan, "store", {1, 1, 1, {}});
  EXPECT_EQ(repeated.ran, 2U);
  EXPECT_GT(repeated.lost, 0U);
  EXPECT_EQ(table_of(folder, "store"), table);
}

TEST(Sweeps, ADamagedDescriptionIsNoticedAndCostsNoCase) {
  const PlanFolder folder;
  const Plan plan = folder.plan(twelve);
  run(folder, plan, "store", {1, 1, 1, {}});
  const std::string table = table_of(folder, "store"), about = folder.read("store/store.json");
  std::string other = about;
  other.replace(other.find("pivot.rate"), 5, "pivto");
  for (const std::string& damaged : {other, about.substr(0, about.size() / 2), std::string()}) {
    folder.write("store/store.json", damaged);
    EXPECT_THROW(read_description(folder / "store"), ResultsError);
    EXPECT_EQ(run(folder, plan, "store", {1, 1, 1, {}}).ran, 0U);
    EXPECT_EQ(folder.read("store/store.json"), about);
    EXPECT_EQ(table_of(folder, "store"), table);
  }
  std::string with_seed_4 = twelve;
  with_seed_4.replace(with_seed_4.find("seed: 3"), 7, "seed: 4");
  folder.write("store/store.json", other);
  EXPECT_THROW(Store(folder / "store", folder.plan(with_seed_4), false), ResultsError)
      << "its cases are another plan's";
}

TEST(Sweeps, AStoreOfAnotherPlanIsNotMixedWith) {
  const PlanFolder folder;
  const Plan plan = folder.plan(twelve);
  run(folder, plan, "store", {1, 1, 1, {}});
  std::string with_seed_4 = twelve;
  with_seed_4.replace(with_seed_4.find("seed: 3"), 7, "seed: 4");
  const Plan other = folder.plan(std::string(twelve) + "failures: stop\n"), another = folder.plan(with_seed_4);
  EXPECT_EQ(run(folder, other, "store", {1, 1, 1, {}}).ran, 0U) << "its cases are the same";
  EXPECT_THROW(Store(folder / "store", another, false), ResultsError);
  Store(folder / "store", another, true);
  EXPECT_EQ(run(folder, another, "store", {1, 1, 1, {}}).ran, 12U);
}

TEST(Sweeps, TwoResultsOfOneCaseThatDifferAreAnError) {
  const PlanFolder folder;
  const Plan plan = folder.plan(twelve);
  const Store store(folder / "store", plan, false);
  CaseResult one = made(3), another = made(3);
  another.numbers[0] = std::nextafter(another.numbers[0], 1.0);
  for (const auto& [worker, result] : {std::pair{0U, one}, {1U, another}}) {
    SegmentWriter writer(store.segment(1, 1, worker), plan.fingerprint);
    writer.append(result);
  }
  EXPECT_THROW(StoreIndex(store.path(), store.about()), ResultsError);
}

}  // namespace
}  // namespace withy::campaign
