#include "server/jobs/slurm/run_command.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "core/error.h"

namespace parkade {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kLong{60'000};

TEST(Command, GivesBothOutputsAndItsStatus) {
  const CommandResult result =
      RunCommand({"sh", "-c", "echo said; echo warned >&2; exit 3"}, kLong);
  EXPECT_EQ(result.output, "said\n");
  EXPECT_EQ(result.errors, "warned\n");
  EXPECT_EQ(WEXITSTATUS(result.status), 3);
}

TEST(Command, TakesWordsAsTheyAre) {
  EXPECT_EQ(RunCommand({"printf", "%s", "$(id); `id` \"'"}, kLong).output, "$(id); `id` \"'");
}

TEST(Command, IsToldNoSecrets) {
  ::setenv("PARKADE_SECRET", "of the service", 1);
  ::setenv("SLURM_CONF", "/etc/slurm.conf", 1);
  const std::string environment = RunCommand({"env"}, kLong).output;
  ::unsetenv("PARKADE_SECRET");
  ::unsetenv("SLURM_CONF");

  EXPECT_EQ(environment.find("PARKADE_SECRET"), std::string::npos);
  EXPECT_NE(environment.find("SLURM_CONF=/etc/slurm.conf\n"), std::string::npos);
}

TEST(Command, MaySayMuch) {
  const CommandResult result =
      RunCommand({"sh", "-c", "yes | head -c 5000000; yes | head -c 5000000 >&2"}, kLong);
  EXPECT_EQ(result.output.size(), 5'000'000u);
  EXPECT_EQ(result.errors.size(), 4096u) << "the beginning says what is wrong";
  EXPECT_THROW(RunCommand({"yes"}, kLong, 1'000'000), Error);
}

TEST(Command, IsEndedWhenItTakesTooLong) {
  const auto begun = steady_clock::now();
  EXPECT_THROW(RunCommand({"sleep", "100"}, milliseconds(200)), Error);
  EXPECT_LT(steady_clock::now() - begun, std::chrono::seconds(20));
}

TEST(Command, ThatIsNotThereIsSaid) {
  EXPECT_THROW(RunCommand({"no-such-program-here"}, kLong), Error);
}

}  // namespace
}  // namespace parkade
