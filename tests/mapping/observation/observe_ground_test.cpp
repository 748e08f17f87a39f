#include "mapping/observation/observe_ground.h"

#include <gtest/gtest.h>

#include <deque>

#include "core/error.h"
#include "tests/mapping/worlds/synthetic_drive.h"

namespace parkade {
namespace {

/// Plays records back in the order given.
class ListedDrive : public DriveLog {
 public:
  ListedDrive(Rig rig, std::vector<SensorRecord> records)
      : rig_(std::move(rig)), records_(std::move(records)) {}

  const std::string& name() const override { return name_; }
  const Rig& rig() const override { return rig_; }
  TimeSpan span() const override { return {TimeOf(records_.front()), TimeOf(records_.back())}; }

  std::unique_ptr<RecordStream> Read(const ReadOptions& options) const override {
    class Stream : public RecordStream {
     public:
      Stream(std::vector<SensorRecord> records, ReadOptions wanted)
          : records_(records.begin(), records.end()), wanted_(std::move(wanted)) {}
      std::optional<SensorRecord> Next() override {
        while (!records_.empty()) {
          SensorRecord record = std::move(records_.front());
          records_.pop_front();
          const auto* frame = std::get_if<CameraFrame>(&record);
          const auto* mask = std::get_if<SemanticFrame>(&record);
          if (mask != nullptr && !wanted_.semantics) continue;
          if (wanted_.wants_image(frame != nullptr ? frame->camera : mask->camera, TimeOf(record)))
            return record;
        }
        return std::nullopt;
      }

     private:
      std::deque<SensorRecord> records_;
      ReadOptions wanted_;
    };
    return std::make_unique<Stream>(records_, options);
  }

 private:
  std::string name_ = "listed";
  Rig rig_;
  std::vector<SensorRecord> records_;
};

class ObservingGround : public testing::Test {
 protected:
  ObservingGround()
      : rig_(MakeTestRig(true, 160, 100)),
        drive_(MakeLot(), rig_, DriveAlong(MakeLot(), {-15, 0, 0}, 0, {{12, 0}}, rig_), true) {}

  SensorRecord Image(double seconds) const {
    return CameraFrame{At(seconds), 0, drive_.Render(0, At(seconds)).first};
  }
  SensorRecord Mask(double seconds, double stamp_offset = 0) const {
    return SemanticFrame{At(seconds + stamp_offset), 0, drive_.Render(0, At(seconds)).second};
  }
  Timestamp At(double seconds) const { return drive_.span().begin + seconds; }

  GroundObservation Observe(std::vector<SensorRecord> records,
                            const GroundOptions& options = {}) const {
    return ObserveGround(ListedDrive(rig_, std::move(records)), drive_.trajectory(), {}, 0,
                         options);
  }

  Rig rig_;
  SyntheticDrive drive_;
};

TEST_F(ObservingGround, AMaskBelongsToItsImageWhetherItComesBeforeOrAfter) {
  const GroundObservation seen =
      Observe({Mask(0), Image(0), Image(0.5), Mask(0.5), Image(1), Image(1.5), Mask(1.5)});

  EXPECT_EQ(seen.num_images, 4);
  EXPECT_EQ(seen.num_masks, 3);
  EXPECT_EQ(seen.patches.size(), 4u) << "the one without a mask is guessed";
}

TEST_F(ObservingGround, AMaskStampedAMillisecondOffIsTaken) {
  EXPECT_EQ(Observe({Image(0), Mask(0, 0.001)}).num_masks, 1);
  EXPECT_EQ(Observe({Image(0), Mask(0, 0.05)}).num_masks, 0);
}

TEST_F(ObservingGround, MasksAreLeftAloneWhenNotWanted) {
  GroundOptions options;
  options.use_semantics = false;

  EXPECT_EQ(Observe({Image(0), Mask(0)}, options).num_masks, 0);
}

TEST_F(ObservingGround, SamplesLieOnTheGroundWithinReach) {
  const GroundObservation seen = Observe({Image(0), Mask(0)});

  ASSERT_EQ(seen.patches.size(), 1u);
  EXPECT_EQ(seen.patches[0].time, At(0));
  EXPECT_GT(seen.patches[0].samples.size(), 1000u);
  for (const GroundSample& sample : seen.patches[0].samples) {
    EXPECT_EQ(sample.point_in_body.z(), 0);
    EXPECT_LT(sample.point_in_body.norm(), 14);
    EXPECT_GT(sample.weight, 0);
  }
}

TEST_F(ObservingGround, ImagesOutsideOfTheTrajectoryAreNotUsed) {
  std::vector<SensorRecord> records{Image(0)};
  std::get<CameraFrame>(records[0]).time = At(-3);

  const GroundObservation seen = Observe(records);

  EXPECT_EQ(seen.num_images, 0);
  ASSERT_EQ(seen.warnings.size(), 1u);
  EXPECT_NE(seen.warnings[0].find("listed"), std::string::npos);
}

TEST_F(ObservingGround, ACameraThatLooksAtTheSkyIsNamed) {
  rig_.cameras[0].body_from_camera.rotation =
      Eigen::Quaterniond::Identity();  // z, its axis, points up
  rig_.cameras[0].model =
      CameraModel(PinholeProjection{.fx = 160, .fy = 160, .cx = 80, .cy = 50}, 160, 100);

  const GroundObservation seen = Observe({Image(0)});

  ASSERT_EQ(seen.warnings.size(), 2u);
  EXPECT_NE(seen.warnings[0].find("'cam0'"), std::string::npos);
}

TEST_F(ObservingGround, RejectsAKeyframeDistanceOfZero) {
  GroundOptions options;
  options.keyframe_distance = 0;
  EXPECT_THROW(Observe({Image(0)}, options), Error);
}

}  // namespace
}  // namespace parkade
