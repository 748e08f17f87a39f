#include "server/jobs/progress_reader.h"

#include <fstream>

#include "tests/server/store/temporary_store.h"

namespace parkade {
namespace {

class ProgressFile : public testing::Test {
 protected:
  void Append(const std::string& text) {
    std::ofstream(file_, std::ios::app | std::ios::binary) << text;
  }

  TemporaryRoot root_;
  std::filesystem::path file_ = root_.path() / "progress.ndjson";
  ProgressReader reader_{file_};
};

TEST_F(ProgressFile, NeedNotExistYet) {
  EXPECT_FALSE(reader_.Poll());
  EXPECT_EQ(reader_.latest().progress, 0);
}

TEST_F(ProgressFile, IsFollowedLineByLineEvenWhenALineComesInTwoParts) {
  Append("{\"stage\": \"track\", \"progress\": 0.25}\n{\"stage\": \"me");
  EXPECT_TRUE(reader_.Poll());
  EXPECT_EQ(reader_.latest().stage, "track");
  EXPECT_FALSE(reader_.Poll());

  Append("sh\", \"progress\": 0.5, \"eta\": 12}\n");
  EXPECT_TRUE(reader_.Poll());
  EXPECT_EQ(reader_.latest().stage, "mesh");
  EXPECT_EQ(reader_.latest().progress, 0.5);
  EXPECT_EQ(reader_.latest().eta, 12);
}

TEST_F(ProgressFile, NeverGoesBackNorOutOfItsRange) {
  Append("{\"progress\": 0.5}\n{\"progress\": 0.2}\n{\"progress\": -3}\n");
  reader_.Poll();
  EXPECT_EQ(reader_.latest().progress, 0.5);
  Append("{\"progress\": 1e9}\n");
  reader_.Poll();
  EXPECT_EQ(reader_.latest().progress, 1.0);
}

TEST_F(ProgressFile, MayHoldNonsense) {
  Append("\n\xff\xfe\n[1, 2]\n{\"progress\": \"half\"}\n{\"stage\": 7}\n{\"progress\": 1e999}\n" +
         std::string(100'000, 'x') + "\n{\"stage\": \"a\\nb\", \"error\": \"" +
         std::string(5000, 'e') + "\"}\n");

  EXPECT_TRUE(reader_.Poll());

  EXPECT_EQ(reader_.latest().progress, 0);
  EXPECT_EQ(reader_.latest().stage, "a b");
  EXPECT_EQ(reader_.latest().error->size(), 1024u);
}

TEST_F(ProgressFile, TakesTheCodeBehindALongSentence) {
  Append("{\"error\": \"" + std::string(20'000, 'e') + "\", \"code\": \"disk_full\"}\n");
  reader_.Poll();
  EXPECT_EQ(reader_.latest().code, "disk_full");
}

TEST_F(ProgressFile, KeepsTheLastWordsOfAFailure) {
  Append("{\"error\": \"the log has no IMU\", \"code\": \"invalid_input\"}\n");
  reader_.Poll();
  EXPECT_EQ(reader_.latest().error, "the log has no IMU");
  EXPECT_EQ(reader_.latest().code, "invalid_input");
}

}  // namespace
}  // namespace parkade
