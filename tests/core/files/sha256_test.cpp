#include "core/files/sha256.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

TEST(Sha256, GivesTheStandardsExample) {
  EXPECT_EQ(Sha256Of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace parkade
