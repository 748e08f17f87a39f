#include "server/commands/failure.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <new>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "server/pipeline/progress.h"

namespace parkade {
namespace {

TEST(Failure, HasAStatusForEachClass) {
  const auto expect = [](const std::exception& exception, const std::string& code,
                         WorkerStatus status) {
    const Failure failure = FailureOf(exception);
    EXPECT_EQ(failure.code, code) << exception.what();
    EXPECT_EQ(failure.status, status) << exception.what();
    EXPECT_FALSE(failure.sentence.empty());
  };
  expect(Error(ErrorCode::kInvalidInput, "a"), "invalid_input", WorkerStatus::kInvalidInput);
  expect(Error(ErrorCode::kNotFound, "b"), "invalid_input", WorkerStatus::kInvalidInput);
  expect(Error(ErrorCode::kUsage, "c"), "usage", WorkerStatus::kUsage);
  expect(Error(ErrorCode::kConflict, "d"), "internal", WorkerStatus::kInternal);
  expect(Error(ErrorCode::kDiskFull, "e"), "disk_full", WorkerStatus::kDiskFull);
  expect(std::bad_alloc(), "out_of_memory", WorkerStatus::kOutOfMemory);
  expect(cv::Exception(cv::Error::StsNoMem, "f", "g", "h", 1), "out_of_memory",
         WorkerStatus::kOutOfMemory);
  expect(
      std::filesystem::filesystem_error("i", std::make_error_code(std::errc::no_space_on_device)),
      "disk_full", WorkerStatus::kDiskFull);
  expect(std::runtime_error("j"), "internal", WorkerStatus::kInternal);
}

TEST(Failure, IsAShortLineOfItsOwnInTheProgressFile) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / "failure_test.ndjson";
  std::ofstream(file) << R"({"stage": "tra)";  // as a full disk leaves it
  Progress({}, {.terminal = false, .file = file}).Fail(std::string(100'000, 'e'), "disk_full");

  std::ifstream stream(file);
  std::string cut_off, line;
  std::getline(stream, cut_off);
  std::getline(stream, line);
  std::filesystem::remove(file);
  EXPECT_LT(line.size(), 5000u);
  EXPECT_EQ(nlohmann::json::parse(line).at("code"), "disk_full");
}

}  // namespace
}  // namespace parkade
