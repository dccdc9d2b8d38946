// Stores: what is damaged is made again and nothing else, and nothing of another plan is mixed in.
#include "withy/campaign/store.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <barrier>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string>
#include <thread>
#include <vector>

#include "withy/campaign/own_part.hpp"
#include "withy/results/results_error.hpp"
#include "withy/study/input_error.hpp"
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

/// Of 2 points with 7 draws each, shard 2 of 9 has case 1 of the first point alone, and case 10, the fourth of the
/// other: one case tells the values of the grid.
TEST(Sweeps, TablesOfAPartHaveTheValuesOfTheGrids) {
  const PlanFolder folder;
  const Plan plan = folder.plan(R"(vary:
  bodies.rod.mass: {grid: [1, "2000 g"]}
  initial.hinges.pivot.rate.0: {uniform: {from: 0, to: 1}}
cases: 7
keep: {final: [pivot], history: {of: [pivot], every: 0.5}}
)");
  EXPECT_EQ(run(folder, plan, "part", {1, 2, 9, {}}).ran, 2U);
  collect(folder / "part");
  const std::string statistics = folder.read("part/statistics.csv"), histories = folder.read("part/histories.csv");
  EXPECT_THAT(statistics, testing::HasSubstr("\n0,1,,final.pivot[rad],1,"));
  EXPECT_THAT(statistics, testing::HasSubstr("\n1,2,,final.pivot[rad],1,"));
  EXPECT_THAT(histories, testing::HasSubstr("\n0,1,,pivot[rad],0,1,"));
  EXPECT_THAT(histories, testing::HasSubstr("\n1,2,,pivot[rad],0.5,1,"));
  EXPECT_THAT(folder.read("part/table.csv"), testing::HasSubstr("\n10,completed,2,"));
}

/// Tables and pages print it to be typed.
TEST(Sweeps, TheCommandOfACaseIsQuotedAndNamesThePlugins) {
  StoreDescription about;
  about.plan = "my plan.yaml";
  about.plugin_folders = {"more plugins"};
  EXPECT_EQ(case_command(about), "withy sweep case 'my plan.yaml' --plugins 'more plugins'");
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

/// Parts of tables are named after their processes: no process has a number beyond Linux's greatest, 4194304.
TEST(Sweeps, CollectingClearsAwayWhatKilledProcessesHaveLeftOfATable) {
  const PlanFolder folder;
  run(folder, folder.plan(twelve), "store", {1, 1, 1, {}});
  std::array<char, 256> host{};
  ASSERT_EQ(gethostname(host.data(), host.size() - 1), 0);
  const std::string here = std::string(".") + host.data(), part = "store/table.csv.part";
  const std::string dead = part + "4194305" + here, alive = part + "1" + here, elsewhere = part + "4194305.else",
                    old = part + "4194306.else";
  for (const std::string& name : {dead, alive, elsewhere, old}) folder.write(name, "half");
  std::filesystem::last_write_time(folder / old,
                                   std::filesystem::file_time_type::clock::now() - std::chrono::hours(25));
  collect(folder / "store");
  for (const std::string& gone : {dead, old}) EXPECT_FALSE(std::filesystem::exists(folder / gone)) << gone;
  for (const std::string& kept : {alive, elsewhere}) EXPECT_TRUE(std::filesystem::exists(folder / kept)) << kept;
}

TEST(Sweeps, GoingOnClearsAwayWhatKilledProcessesHaveLeftOfTheDescription) {
  const PlanFolder folder;
  const Plan plan = folder.plan(twelve);
  Store(folder / "store", plan, false);
  const std::filesystem::path about = folder / "store/store.json", alive = own_part(about);
  const auto make = [](const std::filesystem::path& part) { std::ofstream(part) << "half"; };
  make(alive);
  const pid_t killed = fork();
  if (killed == 0) {
    const std::filesystem::path part = own_part(about);
    make(part);
    make(part.string() + ".part");  // as it is itself written
    _exit(0);
  }
  ASSERT_EQ(waitpid(killed, nullptr, 0), killed);
  const auto parts = [&] {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "store"))
      if (entry.path().string().starts_with(about.string() + ".")) names.push_back(entry.path().string());
    return names;
  };
  ASSERT_EQ(parts().size(), 3U);
  Store(folder / "store", plan, false);
  EXPECT_THAT(parts(), testing::ElementsAre(alive.string()));
}

/// File, title and folders of plugins are no part of the fingerprint: tables and pages name those of the last command.
TEST(Sweeps, AStoreNamesThePlanAsItIsCalledToday) {
  const PlanFolder folder;
  run(folder, folder.plan(std::string("name: first\n") + twelve), "store", {1, 1, 1, {}});
  Plan moved = folder.plan(std::string("name: second\n") + twelve);
  moved.file = "moved.yaml";
  EXPECT_EQ(run(folder, moved, "store", {1, 1, 1, {}}).ran, 0U);
  const StoreDescription about = read_description(folder / "store");
  EXPECT_EQ(about.name, "second");
  EXPECT_EQ(case_command(about), "withy sweep case moved.yaml");
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

/// Without --force nothing is replaced that no store has left, and with it nothing that the plan is read from.
TEST(Sweeps, AFolderOfOtherFilesIsNotMadeAStore) {
  const PlanFolder folder;
  const std::string list = "vary: {bodies.rod.mass: {list: out/table.csv}}\n";
  folder.write("out/table.csv", "mass\n1\n2\n");
  for (const bool anew : {false, true})
    EXPECT_THROW(Store(folder / "out", folder.plan(list), anew), study::InputError) << "the plan reads its table.csv";
  EXPECT_EQ(folder.read("out/table.csv"), "mass\n1\n2\n");
  const Plan plan = folder.plan(twelve);
  for (const char* name : {"a/table.csv", "b/report.html", "c/segments/notes.txt", "d/store.json", "e/histories.svg"}) {
    folder.write(name, "mine");
    const std::filesystem::path store = folder / std::string(name, 1);
    EXPECT_THROW(Store(store, plan, false), ResultsError) << name;
    EXPECT_EQ(folder.read(name), "mine");
    EXPECT_TRUE(std::string(name).starts_with('d') || !std::filesystem::exists(store / "store.lock")) << name;
    EXPECT_NO_THROW(Store(store, plan, true)) << name;
  }
  EXPECT_EQ(folder.read("c/segments/notes.txt"), "mine") << "no name of a store";
  folder.write("f/notes.txt", "mine");
  EXPECT_EQ(run(folder, plan, "f", {1, 1, 1, {}}).ran, 12U);
  EXPECT_EQ(folder.read("f/notes.txt"), "mine");
}

/// However they come to begin at once, each finds the store that one has made, with its segments.
TEST(Sweeps, ShardsMayBeginAStoreTogether) {
  const PlanFolder folder;
  const Plan plan = folder.plan(twelve);
  constexpr std::uint64_t shards = 8;
  for (int round = 0; round < 20; ++round) {
    const std::filesystem::path path = folder / fmt::format("store{}", round);
    std::barrier together(shards);
    std::vector<std::thread> threads;
    for (std::uint64_t shard = 1; shard <= shards; ++shard)
      threads.emplace_back([&, shard] {
        together.arrive_and_wait();
        const Store store(path, plan, false);
        SegmentWriter(store.segment(shard, shards, 0), plan.fingerprint).append(made(shard - 1));
      });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(StoreIndex(path, read_description(path)).done(), shards) << round;
  }
}

// Neighbours in different segments, more than are open at once, one case of them twice.
/// A lock that is held as by a process that has been stopped. \returns its descriptor
int locked(const std::filesystem::path& file) {
  const int held = ::open(file.c_str(), O_RDWR | O_CREAT, 0666);
  EXPECT_EQ(::flock(held, LOCK_EX), 0);
  return held;
}

TEST(Sweeps, AStoreThatOthersHaveMadeNeedsNoLock) {
  const PlanFolder folder;
  const Plan plan = folder.plan(twelve);
  run(folder, plan, "made", {1, 1, 1, {}});
  std::filesystem::create_directories(folder / "store/segments");
  const int held = locked(folder / "store/store.lock");
  std::thread other([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    std::filesystem::copy_file(folder / "made/store.json", folder / "store/part");
    std::filesystem::rename(folder / "store/part", folder / "store/store.json");
  });
  EXPECT_EQ(run(folder, plan, "store", {1, 1, 1, {}}).ran, 12U);
  other.join();
  ::close(held);
}

TEST(Sweeps, ALockThatIsHeldForEverIsSaid) {
  const PlanFolder folder;
  const Plan plan = folder.plan(twelve);
  std::filesystem::create_directories(folder / "store");
  const int held = locked(folder / "store/store.lock");
  try {
    run(folder, plan, "store", {1, 1, 1, {}});
    ADD_FAILURE() << "no error";
  } catch (const FolderBusy& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("store.lock has been locked for 20 s by another process"));
  }
  ::close(held);
}

TEST(Sweeps, CasesAreReadFromManySegmentsInAnyOrder) {
  const PlanFolder folder;
  const Plan plan =
      folder.plan("vary: {bodies.rod.mass: {uniform: {from: 1, to: 2}}}\ncases: 1000\nkeep: {final: [pivot]}\n");
  const Store store(folder / "store", plan, false);
  constexpr std::uint64_t shards = 150;
  for (std::uint64_t shard = 1; shard <= shards; ++shard) {
    SegmentWriter writer(store.segment(shard, shards, 0), plan.fingerprint);
    for (std::uint64_t i = shard - 1; i < 1000; i += shards)
      if (i != 500) writer.append(made(i));
  }
  SegmentWriter(store.segment(1, 7, 0), plan.fingerprint).append(made(499));
  StoreIndex index(store.path(), store.about());
  EXPECT_EQ(index.done(), 999U);
  const auto expect = [&](std::uint64_t i) {
    const auto result = index.read(i);
    ASSERT_EQ(result.has_value(), i != 500) << i;
    if (result) {
      EXPECT_EQ(encode(*result), encode(made(i)));
    }
  };
  for (std::uint64_t i = 0; i < 1000; ++i) expect(i);
  for (std::uint64_t i = 1000; i-- > 0;) expect(i);
  for (std::uint64_t i = 0; i < 1000; ++i) expect(i * 37 % 1000);
}

TEST(Sweeps, AShardLooksForItsCasesWhereTheyCanBe) {
  const PlanFolder folder;
  const Plan plan =
      folder.plan("vary: {bodies.rod.mass: {uniform: {from: 1, to: 2}}}\ncases: 11\nkeep: {final: [pivot]}\n");
  const Store store(folder / "store", plan, false);
  const auto write = [&](std::uint64_t shard, std::uint64_t shards, std::initializer_list<std::uint64_t> cases) {
    SegmentWriter writer(store.segment(shard, shards, 0), plan.fingerprint);
    for (const std::uint64_t i : cases) writer.append(made(i));
  };
  write(2, 3, {1, 4});
  write(1, 1, {7, 8});                                         // of a run that had no shards
  folder.write("store/segments/3-of-3.0.segment", "damaged");  // of no concern
  StoreIndex index(store.path(), store.about(), {2, 3});
  EXPECT_EQ(index.done(), 3U);
  EXPECT_EQ(index.lost(), 0U);
  for (std::uint64_t i = 0; i < 11; ++i) {
    const bool is_there = i == 1 || i == 4 || i == 7;
    EXPECT_EQ(index.has(i), is_there) << i;
    const auto result = index.read(i);
    ASSERT_EQ(result.has_value(), is_there) << i;
    if (result) {
      EXPECT_EQ(encode(*result), encode(made(i)));
    }
  }
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
