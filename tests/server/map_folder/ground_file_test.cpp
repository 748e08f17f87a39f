#include "server/map_folder/ground_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <random>

#include "core/files/file.h"
#include "server/map_folder/stage_cache.h"
#include "tests/server/store/temporary_root.h"

namespace parkade {
namespace {

/// What a camera that looks at a grid of keyframes sees, some of it hidden.
GroundPatch RandomPatch(int camera, unsigned seed) {
  std::mt19937 random(seed);
  const auto byte = [&] { return static_cast<std::uint8_t>(random() % 256); };
  GroundPatch patch{.drive = 0,
                    .camera = camera,
                    .time = {1'000'000 * static_cast<std::int64_t>(seed)},
                    .samples = {}};
  for (int range = 0; range < 20; ++range)
    for (int ray = 0; ray < 30; ++ray) {
      if (random() % 4 == 0) continue;
      const float x = 1 + 0.5F * static_cast<float>(range),
                  y = 0.1F * static_cast<float>(ray + camera);
      patch.samples.push_back(GroundSample{.point_in_body = Eigen::Vector3f(x, y, -0.01F * x),
                                           .blue = byte(),
                                           .green = byte(),
                                           .red = byte(),
                                           .is_free = random() % 2 == 0,
                                           .surface = static_cast<SurfaceClass>(random() % 10),
                                           .weight = 1000 / x,
                                           .footprint = 0.1F * x,
                                           .confidence = static_cast<float>(byte()) / 255});
    }
  return patch;
}

bool AreSame(const std::vector<GroundSample>& a, const std::vector<GroundSample>& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), a.size() * sizeof(GroundSample)) == 0;
}

class GroundFileTest : public ::testing::Test {
 protected:
  std::vector<GroundPatch> Write() {
    std::vector<GroundPatch> patches;
    GroundFileWriter writer(file_, key_);
    for (unsigned i = 0; i < 12; ++i) {
      patches.push_back(RandomPatch(static_cast<int>(i % 3), i + 1));
      writer.Add(patches.back());
    }
    GroundObservation observation;
    observation.body_from_ground.translation.z() = -0.25;
    observation.num_images = 14;
    observation.num_masks = 3;
    observation.warnings = {"a camera sees nothing"};
    observation.placements = {{}, {.body_from_camera = {}, .time_shift = 0.25, .line_delay = 1e-5}};
    writer.Finish(observation);
    return patches;
  }

  TemporaryRoot root_;
  const std::filesystem::path file_ = root_.path() / "drive" / "ground.bin";
  const std::string key_ = KeyOf({"drive"});
};

TEST_F(GroundFileTest, GivesBackEveryBit) {
  const std::vector<GroundPatch> patches = Write();

  const auto file = GroundFile::Open(file_, key_);

  ASSERT_NE(file, nullptr);
  EXPECT_EQ(file->observation().num_images, 14);
  EXPECT_EQ(file->observation().num_masks, 3);
  EXPECT_EQ(file->observation().body_from_ground.translation.z(), -0.25);
  EXPECT_EQ(file->observation().warnings, std::vector<std::string>{"a camera sees nothing"});
  ASSERT_EQ(file->observation().placements.size(), 2u);
  EXPECT_EQ(file->observation().placements[1].time_shift, 0.25);
  EXPECT_EQ(file->observation().placements[1].line_delay, 1e-5);
  ASSERT_EQ(file->patches().size(), patches.size());
  for (const size_t i : {11u, 0u, 5u}) {  // in any order
    const GroundPatch patch = file->Read(i, 7);
    EXPECT_EQ(patch.drive, 7);
    EXPECT_EQ(patch.camera, patches[i].camera);
    EXPECT_EQ(patch.time.ns, patches[i].time.ns);
    EXPECT_TRUE(AreSame(patch.samples, patches[i].samples)) << i;
    EXPECT_TRUE(file->patches()[i].extent_in_body.isApprox(ExtentOf(patches[i])));
  }
}

TEST_F(GroundFileTest, KeyframesThatEveryImageShowsCostLittle) {
  GroundFileWriter writer(file_, key_);
  GroundPatch patch = RandomPatch(0, 1);
  for (GroundSample& sample : patch.samples)
    sample.blue = sample.green = sample.red = 90, sample.confidence = 1;
  for (int i = 0; i < 100; ++i) writer.Add(patch);
  writer.Finish({});

  EXPECT_LT(std::filesystem::file_size(file_), 100 * patch.samples.size());
}

TEST_F(GroundFileTest, WhatIsOfAnotherKeyOrDamagedIsNotTaken) {
  Write();
  EXPECT_EQ(GroundFile::Open(file_, KeyOf({"another"})), nullptr);
  EXPECT_EQ(GroundFile::Open(root_.path() / "none", key_), nullptr);
  const std::string whole = ReadFile(file_, 1 << 24);
  for (const size_t length :
       {size_t{0}, size_t{5}, size_t{90}, whole.size() / 2, whole.size() - 1}) {
    std::ofstream(file_, std::ios::binary) << whole.substr(0, length);
    EXPECT_EQ(GroundFile::Open(file_, key_), nullptr) << length;
  }
  for (const size_t byte : {size_t{100}, whole.size() / 2, whole.size() - 40}) {
    std::string damaged = whole;
    damaged[byte] = static_cast<char>(damaged[byte] ^ 4);
    std::ofstream(file_, std::ios::binary) << damaged;
    EXPECT_EQ(GroundFile::Open(file_, key_), nullptr) << byte;
  }
  std::ofstream(file_, std::ios::binary) << whole;
  EXPECT_NE(GroundFile::Open(file_, key_), nullptr);
}

TEST_F(GroundFileTest, StoredGroundPosesPatchesOfSeveralDrives) {
  const std::vector<GroundPatch> patches = Write();
  const std::shared_ptr<const GroundFile> file = GroundFile::Open(file_, key_);
  std::vector<TrajectoryState> states(2);
  states[0].time = patches[2].time;
  states[1].time = patches[9].time;
  states[1].world_from_body.translation.x() = states[0].world_from_body.translation.x() = 100;

  StoredGround ground;
  ground.Add(file, 0, Trajectory(states));
  ground.Add(file, 1, Trajectory(states));

  ASSERT_EQ(ground.views().size(), 16u) << "those outside of the trajectory are left out";
  EXPECT_EQ(ground.views()[0].drive, 0);
  EXPECT_EQ(ground.views()[8].drive, 1);
  EXPECT_NEAR(ground.views()[0].extent.min().x(), 101, 0.01);
  EXPECT_TRUE(AreSame(ground.Read(8).patch.samples, patches[2].samples));
  EXPECT_EQ(ground.Read(8).patch.drive, 1);
}

}  // namespace
}  // namespace parkade
