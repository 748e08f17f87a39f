#include "core/log.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <thread>

namespace parkade {
namespace {

class Logging : public testing::Test {
 protected:
  ~Logging() override {
    SetLogLevel(LogLevel::kInfo);
    SetLogLineFormat(LogLineFormat::kText);
  }
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

TEST_F(Logging, FieldsStandBehindTheMessageAndThoseOfTheThreadBehindThem) {
  testing::internal::CaptureStderr();
  {
    const LogContext job(LogFields{{"job", "6f"}, {"attempt", 2}});
    const LogContext stage(LogFields{{"stage", "mesh"}});
    Log(LogLevel::kInfo, "worker ended", {{"status", 3}});
    std::thread([] { LogInfo("of another thread"); }).join();
  }
  LogInfo("afterwards");
  const std::string text = testing::internal::GetCapturedStderr();

  EXPECT_NE(text.find(" info worker ended status=3 job=6f attempt=2 stage=mesh\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find(" info of another thread\n"), std::string::npos) << text;
  EXPECT_NE(text.find(" info afterwards\n"), std::string::npos) << text;
}

TEST_F(Logging, AsJsonEachLineIsAnObjectWhateverIsSaid) {
  SetLogLineFormat(LogLineFormat::kJson);
  testing::internal::CaptureStderr();
  {
    const LogContext request(LogFields{{"request", "a1"}});
    Log(LogLevel::kError, "read '\"a\nb\x1b[31m\x7f\xff {}%v'", {{"bytes", 12}, {"path", "/\\"}});
  }
  const std::string line = testing::internal::GetCapturedStderr();

  EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1) << line;
  EXPECT_TRUE(std::all_of(line.begin(), line.end() - 1, [](char c) {
    return c >= 0x20 && c < 0x7f;
  })) << line;
  const nlohmann::json object = nlohmann::json::parse(line, nullptr, false);
  ASSERT_TRUE(object.is_object()) << line;
  EXPECT_TRUE(std::regex_match(object.at("time").get<std::string>(),
                               std::regex("\\d{4}-\\d\\d-\\d\\dT\\d\\d:\\d\\d:\\d\\d\\.\\d{3}Z")))
      << line;
  EXPECT_EQ(object.at("level"), "error");
  EXPECT_EQ(object.at("message"), "read '\"a\nb\x1b[31m\x7f\xef\xbf\xbd {}%v'");
  EXPECT_EQ(object.at("bytes"), 12);
  EXPECT_EQ(object.at("path"), "/\\");
  EXPECT_EQ(object.at("request"), "a1");
}

}  // namespace
}  // namespace parkade
