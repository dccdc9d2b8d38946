// The batch scripts of a sweep: names of folders stay one word in directives and in commands.
#include "withy/campaign/slurm.hpp"

#include <gmock/gmock.h>

#include "withy/study/input_error.hpp"
#include "withy/tests/results/scratch.hpp"

namespace withy::campaign {
namespace {

using testing::HasSubstr;

SlurmJob job_in(const std::filesystem::path& store) {
  SlurmJob job;
  job.program = "/opt/my programs/withy";
  job.plan = "/home/a/it's a plan.yaml";
  job.store = store;
  job.tasks = 3;
  return job;
}

/// sbatch takes a directive apart at blanks but within quotes, in which a backslash goes before a quote; a % of the
/// name is doubled, for %a is the task's number. Slurm 22.05 reads these as they are meant.
TEST(Slurm, DirectivesHoldAnyNameOfAFolder) {
  EXPECT_THAT(array_script(job_in("/data/s q")), HasSubstr("\n#SBATCH --output=\"/data/s q/slurm/%a.log\"\n"));
  EXPECT_THAT(collect_script(job_in("/data/s q")), HasSubstr("\n#SBATCH --output=\"/data/s q/slurm/collect.log\"\n"));
  EXPECT_THAT(array_script(job_in("/data/it's")), HasSubstr("\n#SBATCH --output=\"/data/it's/slurm/%a.log\"\n"));
  EXPECT_THAT(array_script(job_in("/data/50% \"x\"")),
              HasSubstr("\n#SBATCH --output=\"/data/50%% \\\"x\\\"/slurm/%a.log\"\n"));
}

TEST(Slurm, CommandsHoldAnyNameOfAFolder) {
  EXPECT_THAT(
      array_script(job_in("/data/it's")),
      HasSubstr("'/opt/my programs/withy' sweep run '/home/a/it'\\''s a plan.yaml' --out '/data/it'\\''s' --jobs 1"));
  EXPECT_THAT(collect_script(job_in("/data/it's")),
              HasSubstr("\nexec '/opt/my programs/withy' sweep collect '/data/it'\\''s'\n"));
}

TEST(Slurm, RefusesAFolderThatItsLogsCannotBeWrittenInto) {
  const test::Scratch folder;
  EXPECT_THROW(submit(job_in(folder / "back\\slash"), true), study::InputError);
  EXPECT_THROW(submit(job_in(folder / "two\nlines"), true), study::InputError);
  const Submitted written = submit(job_in(folder / "one line"), true);
  EXPECT_THAT(folder.read("one line/slurm/array.sh"), HasSubstr("/one line/slurm/%a.log\"\n"));
  EXPECT_TRUE(written.array_job.empty());
}

}  // namespace
}  // namespace withy::campaign
