#include "server/ingest/drive/intact_images.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace parkade {
namespace {

TEST(IntactImages, HasWhatWasAddedInAnyOrder) {
  std::mt19937 random(5);
  std::set<std::pair<int, std::int64_t>> added;
  IntactImages images;
  for (int i = 0; i < 500; ++i) {
    const std::pair<int, std::int64_t> image(static_cast<int>(random() % 3), random() % 400);
    images.Add(image.first, {image.second});
    added.insert(image);
  }

  for (int stream = 0; stream < 4; ++stream)
    for (std::int64_t time = 0; time < 410; ++time)
      EXPECT_EQ(images.Has(stream, {time}), added.count({stream, time}) > 0) << stream << time;
}

}  // namespace
}  // namespace parkade
