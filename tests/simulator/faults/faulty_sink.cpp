#include "tests/simulator/faults/faulty_sink.h"

namespace parkade::simulator {
namespace {

constexpr size_t kMaxCameras = 4;

}  // namespace

FaultySink::FaultySink(DriveSink& sink, const FaultOptions& faults, Timestamp epoch,
                       std::uint64_t seed)
    : sink_(sink),
      faults_(faults),
      epoch_(epoch),
      imu_{"imu", Random(seed, 0xfa0), {}},
      wheels_{"wheels", Random(seed, 0xfa1), {}},
      gnss_{"gnss", Random(seed, 0xfa2), {}} {
  for (size_t camera = 0; camera < kMaxCameras; ++camera)
    cameras_.push_back({"cam" + std::to_string(camera), Random(seed, 0xfb0 + camera), {}});
}

void FaultySink::Write(const ImuSample& sample) { Pass(sample, imu_); }
void FaultySink::Write(const WheelSample& sample) { Pass(sample, wheels_); }
void FaultySink::Write(const GnssFix& fix) { Pass(fix, gnss_); }

void FaultySink::WriteImage(size_t camera, Timestamp time, std::span<const std::uint8_t> jpeg) {
  Image image{camera, time, {jpeg.begin(), jpeg.end()}};
  Stream& stream = cameras_.at(camera);
  if (stream.random.Chance(faults_.corrupt_jpegs)) Damage(image.file, stream.random);
  Pass(std::move(image), stream);
}

void FaultySink::WriteSemantic(size_t camera, Timestamp time, std::span<const std::uint8_t> png) {
  Mask mask{{camera, time, {png.begin(), png.end()}}};
  const double since_start = SinceStart(time);
  if (IsInGap(mask, since_start)) return;
  sink_.ArriveAt(time);
  mask.time = time + StampError(mask, cameras_.at(camera).name, since_start);
  Deliver(mask);
}

/// Draws the same random numbers whatever happens, so that one fault leaves the others where they
/// are.
void FaultySink::Pass(Record record, Stream& stream) {
  const bool is_twice = stream.random.Chance(faults_.duplicates),
             is_late = stream.random.Chance(faults_.unordered);
  Timestamp& stamp = std::visit([](auto& content) -> Timestamp& { return content.time; }, record);
  const double time = SinceStart(stamp);
  sink_.ArriveAt(stamp);
  if (IsInGap(record, time)) {
    ++counts_["gap." + stream.name];
    return;
  }
  if (const double error = StampError(record, stream.name, time); error != 0) stamp = stamp + error;
  if (is_late && !stream.held) {
    ++counts_["unordered." + stream.name];
    stream.held = std::move(record);
    return;
  }
  Deliver(record);
  if (is_twice) {
    ++counts_["duplicates." + stream.name];
    Deliver(record);
  }
  if (stream.held) Deliver(*std::exchange(stream.held, std::nullopt));
}

void FaultySink::Deliver(const Record& record) {
  std::visit(
      [&]<typename Content>(const Content& content) {
        if constexpr (std::is_same_v<Content, Mask>) {
          sink_.WriteSemantic(content.camera, content.time, content.file);
        } else if constexpr (std::is_same_v<Content, Image>) {
          sink_.WriteImage(content.camera, content.time, content.file);
        } else {
          sink_.Write(content);
        }
      },
      record);
}

bool FaultySink::IsInGap(const Record& record, double time) const {
  if (std::holds_alternative<ImuSample>(record)) return faults_.imu_gap.Contains(time);
  if (std::holds_alternative<WheelSample>(record)) return faults_.wheel_gap.Contains(time);
  if (std::holds_alternative<GnssFix>(record)) return faults_.gnss_gap.Contains(time);
  const ImageGap& gap = faults_.image_gap;
  const Image* image = std::get_if<Image>(&record);
  if (!image) image = std::get_if<Mask>(&record);
  const bool is_concerned = gap.camera < 0 || static_cast<size_t>(gap.camera) == image->camera;
  return is_concerned && gap.begin <= time && time < gap.end;
}

double FaultySink::StampError(const Record& record, const std::string& stream, double time) {
  double error = 0;
  const Image* image = std::get_if<Image>(&record);
  if (!image) image = std::get_if<Mask>(&record);
  if (image) error -= OfCamera(faults_.time_offsets, image->camera);
  const TimeJump& jump = faults_.time_jump;
  const bool is_concerned = jump.stream == "all" || jump.stream == stream;
  if (is_concerned && jump.begin <= time && time < jump.end) {
    if (!std::holds_alternative<Mask>(record)) ++counts_["time_jump." + stream];
    error += jump.seconds;
  }
  return error;
}

/// Some images end early, in others a burst of bytes is wrong.
void FaultySink::Damage(std::vector<std::uint8_t>& jpeg, Random& random) {
  ++counts_["corrupt_jpegs"];
  if (jpeg.size() < 200) return;
  const int size = static_cast<int>(jpeg.size());
  if (random.Chance(0.5)) {
    jpeg.resize(static_cast<size_t>(size / 4 + random.Index(size / 2)));
    return;
  }
  const int begin = size / 4 + random.Index(size / 2);
  for (int i = begin; i < std::min(size, begin + 40); ++i)
    jpeg[static_cast<size_t>(i)] = static_cast<std::uint8_t>(random.Bits());
}

void FaultySink::Close() {
  for (Stream* stream : {&imu_, &wheels_, &gnss_})
    if (stream->held) Deliver(*std::exchange(stream->held, std::nullopt));
  for (Stream& stream : cameras_)
    if (stream.held) Deliver(*std::exchange(stream.held, std::nullopt));
  sink_.Close();
}

}  // namespace parkade::simulator
