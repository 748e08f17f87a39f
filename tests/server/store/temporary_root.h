#pragma once

#include <gtest/gtest.h>

#include <filesystem>

#include "server/store/tables/names.h"

namespace parkade {

/// A folder that is new at the start and gone at the end.
class TemporaryRoot {
 public:
  TemporaryRoot() : path_(std::filesystem::path(testing::TempDir()) / ("parkade-" + NewId())) {
    std::filesystem::create_directories(path_);
  }
  ~TemporaryRoot() { std::filesystem::remove_all(path_); }
  TemporaryRoot(const TemporaryRoot&) = delete;
  TemporaryRoot& operator=(const TemporaryRoot&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace parkade
