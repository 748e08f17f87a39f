#include "mapping/texture/paint_texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "mapping/mesh/mesh_surface.h"
#include "mapping/observation/observe_ground.h"
#include "mapping/texture/exposure_and_vignetting.h"
#include "tests/mapping/worlds/fuse_patches.h"
#include "tests/mapping/worlds/synthetic_drive.h"

namespace parkade {
namespace {

/// A drive whose records another one gives.
class WrappedDrive : public DriveLog {
 public:
  explicit WrappedDrive(const DriveLog& log) : log_(log) {}
  const std::string& name() const override { return log_.name(); }
  const Rig& rig() const override { return log_.rig(); }
  TimeSpan span() const override { return log_.span(); }

 protected:
  const DriveLog& log_;
};

/// Counts what is decoded of a drive.
class CountedDrive final : public WrappedDrive {
 public:
  using WrappedDrive::WrappedDrive;
  std::unique_ptr<RecordStream> Read(const ReadOptions& options) const override {
    ReadOptions counting = options;
    counting.wants_image = [this, options](int camera, Timestamp time) {
      const bool is_wanted = options.wants_image(camera, time);
      count_ += is_wanted;
      return is_wanted;
    };
    return log_.Read(counting);
  }
  int count() const { return count_; }

 private:
  mutable int count_ = 0;
};

/// A drive whose exposures jump from image to image and whose lenses darken toward their rims.
class DimmedDrive final : public WrappedDrive {
 public:
  using WrappedDrive::WrappedDrive;
  std::unique_ptr<RecordStream> Read(const ReadOptions& options) const override {
    return std::make_unique<Stream>(log_.Read(options));
  }

 private:
  class Stream final : public RecordStream {
   public:
    explicit Stream(std::unique_ptr<RecordStream> stream) : stream_(std::move(stream)) {}
    std::optional<SensorRecord> Next() override {
      std::optional<SensorRecord> record = stream_->Next();
      if (auto* frame = record ? std::get_if<CameraFrame>(&*record) : nullptr) {
        const float exposure = 0.6F + 0.1F * static_cast<float>(num_read_++ * 7 % 5);
        cv::Mat light(frame->image.size(), CV_32FC1);
        for (int row = 0; row < light.rows; ++row)
          for (int column = 0; column < light.cols; ++column) {
            const float square = ExposureAndVignetting::SquaredRadius(
                Eigen::Vector2i(column, row).cast<float>(), light.cols, light.rows);
            light.at<float>(row, column) = exposure * std::exp(-0.5F * square);
          }
        if (frame->image.channels() == 3)
          cv::merge(std::vector<cv::Mat>{light, light, light}, light);
        cv::Mat dimmed;
        cv::multiply(frame->image, light, dimmed, 1, frame->image.type());
        frame->image = dimmed;
      }
      return record;
    }

   private:
    std::unique_ptr<RecordStream> stream_;
    int num_read_ = 0;
  };
};

/// A lot that one car drove through, mapped.
struct MappedLot {
  SyntheticScene scene = MakeLot();
  SyntheticDrive drive{scene, MakeTestRig(),
                       DriveAlong(scene, {-18, 0, 0}, 0, {{10, 0}}, MakeTestRig()), true};
  GroundObservation seen = ObserveGround(drive, drive.trajectory(), {}, 0);
  DrivenPath path = MakeDrivenPath(0, drive.rig(), drive.trajectory(), seen.body_from_ground);
  std::vector<PosedGroundPatch> patches;
  SurfaceMap surface;
  TriangleMesh mesh;

  MappedLot() {
    for (const GroundPatch& patch : seen.patches)
      patches.push_back({patch, *drive.trajectory().At(patch.time)});
    surface = FuseSurface(patches, std::span(&path, 1));
    mesh = MeshSurface(surface);
  }
};

const MappedLot& Lot() {
  static const MappedLot lot;
  return lot;
}

TEST(PaintTexture, ManyDrivesCostHardlyMoreDecodingThanOneAndTheLatestShows) {
  const MappedLot& lot = Lot();
  TextureOptions options;
  options.texel_size = 0.05;
  const CountedDrive alone(lot.drive);
  const std::vector<TextureSource> one{{&alone, &lot.path}};
  const GroundTexture of_one =
      PaintTexture(lot.mesh, lot.surface, PatchesInMemory(lot.patches), one, options);
  ASSERT_FALSE(of_one.empty());
  EXPECT_GT(alone.count(), 20);
  EXPECT_LE(alone.count(), 2 * std::ssize(lot.patches)) << "once for their light, once to paint";

  std::vector<PosedGroundPatch> patches;
  std::vector<DrivenPath> paths;
  for (int drive = 0; drive < 4; ++drive) {
    paths.push_back(lot.path);
    paths.back().drive = drive;
    for (PosedGroundPatch patch : lot.patches) {
      patch.patch.drive = drive;
      patches.push_back(std::move(patch));
    }
  }
  const CountedDrive early(lot.drive), late(lot.drive);
  std::vector<TextureSource> four;
  for (size_t drive = 0; drive < 4; ++drive)
    four.push_back({drive < 3 ? &early : &late, &paths[drive]});
  const GroundTexture of_four =
      PaintTexture(lot.mesh, lot.surface, PatchesInMemory(patches), four, options);

  EXPECT_EQ(late.count(), alone.count());
  EXPECT_LT(early.count(), alone.count())
      << "only where the latest drive saw a place fewer than four times";
  ASSERT_EQ(of_four.charts.size(), of_one.charts.size());
  for (size_t i = 0; i < of_one.charts.size(); ++i)
    EXPECT_EQ(of_four.charts[i].triangles, of_one.charts[i].triangles);
}

TEST(PaintTexture, ThePartsLeaveNoTrace) {
  const MappedLot& lot = Lot();
  TextureOptions options;
  options.texel_size = 0.05;
  options.chart_size = 8;
  const PatchesInMemory patches(lot.patches);
  const CountedDrive log(lot.drive), log_of_parts(lot.drive);
  const std::vector<TextureSource> source{{&log, &lot.path}},
      source_of_parts{{&log_of_parts, &lot.path}};
  const GroundTexture whole = PaintTexture(lot.mesh, lot.surface, patches, source, options);
  options.max_texels = 60e3;  // two charts or three

  const GroundTexture parts =
      PaintTexture(lot.mesh, lot.surface, patches, source_of_parts, options);

  EXPECT_TRUE(whole.pixels.empty());
  EXPECT_GT(parts.pixels.size(), 2u);
  EXPECT_GT(log_of_parts.count(), log.count());
  ASSERT_EQ(parts.charts.size(), whole.charts.size());
  for (size_t i = 0; i < whole.charts.size(); ++i) {
    const TextureChart &a = whole.charts[i], &b = parts.charts[i];
    EXPECT_EQ(a.triangles, b.triangles);
    EXPECT_TRUE(a.column == b.column && a.row == b.row && a.layer == b.layer && a.left == b.left &&
                a.top == b.top);
    EXPECT_EQ(cv::norm(a.image, b.image, cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(a.mask, b.mask, cv::NORM_INF), 0);
  }
}

/// How much one texture's light against another's differs from place to place: standard deviation
/// of the log-ratio.
double SpreadOfLight(const GroundTexture& texture, const GroundTexture& plain) {
  std::vector<double> logs;
  for (size_t i = 0; i < texture.charts.size(); ++i) {
    cv::Mat blurred, plain_blurred;
    cv::blur(texture.charts[i].image, blurred, {9, 9});
    cv::blur(plain.charts[i].image, plain_blurred, {9, 9});
    for (int row = 0; row < blurred.rows; ++row)
      for (int column = 0; column < blurred.cols; ++column)
        if (texture.charts[i].mask.at<std::uint8_t>(row, column) == TextureChart::kPainted)
          logs.push_back(std::log((1.0 + blurred.at<cv::Vec3b>(row, column)[1]) /
                                  (1.0 + plain_blurred.at<cv::Vec3b>(row, column)[1])));
  }
  cv::Scalar mean, deviation;
  cv::meanStdDev(logs, mean, deviation);
  return deviation[0];
}

TEST(PaintTexture, ExposuresAndLensesLeaveNoSeams) {
  const MappedLot& lot = Lot();
  TextureOptions options;
  options.texel_size = 0.05;
  const DimmedDrive dimmed(lot.drive);
  const std::vector<TextureSource> source{{&lot.drive, &lot.path}},
      dimmed_source{{&dimmed, &lot.path}};
  const PatchesInMemory patches(lot.patches);

  const GroundTexture plain = PaintTexture(lot.mesh, lot.surface, patches, source, options);
  const GroundTexture balanced =
      PaintTexture(lot.mesh, lot.surface, patches, dimmed_source, options);

  EXPECT_LT(SpreadOfLight(balanced, plain), 0.05)
      << "exposures differ by 1.7, lenses lose two fifths at their rims";
}

TEST(PaintTexture, RejectsChartsThatAreNone) {
  TextureOptions options;
  options.chart_size = 0.1;
  EXPECT_THROW(options.Validate(), Error);
}

}  // namespace
}  // namespace parkade
