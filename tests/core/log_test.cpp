#include "core/log.h"

#include <gtest/gtest.h>

#include <regex>

namespace parkade {
namespace {

class Logging : public testing::Test {
 protected:
  ~Logging() override { SetLogLevel(LogLevel::kInfo); }
};

TEST_F(Logging, ALineHoldsTimeLevelAndMessage) {
  testing::internal::CaptureStderr();
  LogWarning("stage=track frames=812");
  const std::string line = testing::internal::GetCapturedStderr();

  EXPECT_TRUE(std::regex_match(
      line,
      std::regex(
          "\\d{4}-\\d\\d-\\d\\dT\\d\\d:\\d\\d:\\d\\d\\.\\d{3}Z warning stage=track frames=812\n")))
      << line;
}

TEST_F(Logging, AFileNameCannotForgeASecondLine) {
  testing::internal::CaptureStderr();
  LogInfo("read 'a\nb\x1b[31m\x7f'");
  const std::string line = testing::internal::GetCapturedStderr();

  EXPECT_NE(line.find("read 'a\\x0ab\\x1b[31m\\x7f'"), std::string::npos) << line;
  EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1);
}

TEST_F(Logging, WhatIsBelowTheLevelIsNotWritten) {
  SetLogLevel(LogLevel::kError);
  testing::internal::CaptureStderr();
  LogWarning("quiet");
  LogError("loud");
  const std::string text = testing::internal::GetCapturedStderr();

  EXPECT_EQ(text.find("quiet"), std::string::npos);
  EXPECT_NE(text.find("loud"), std::string::npos);
}

}  // namespace
}  // namespace parkade
