#include "server/ingest/drive/arrival_stream.h"

#include <algorithm>

#include "core/error.h"

namespace parkade {
namespace {

/// The difference of stamps outside does not fit 64 bits, and no drive has such times.
bool IsTime(Timestamp time) { return time.ns >= 0 && time.ns < 4'300'000'000'000'000'000; }

bool IsPlausible(const Arrival& arrival) {
  return std::visit(
      [](const auto& content) {
        if constexpr (std::is_same_v<std::decay_t<decltype(content)>, EncodedImage>)
          return true;
        else
          return parkade::IsPlausible(content);
      },
      arrival.content);
}

void SetTime(Timestamp time, Arrival& arrival) {
  arrival.time = time;
  std::visit(
      [&](auto& content) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(content)>, EncodedImage>)
          content.time = time;
      },
      arrival.content);
}

bool IsStuck(Timestamp time, const SensorStream& stream) {
  return std::any_of(stream.stuck.begin(), stream.stuck.end(),
                     [&](const TimeSpan& span) { return span.Contains(time); });
}

}  // namespace

ArrivalStream::ArrivalStream(const MessageSource& source, const std::vector<SensorStream>& streams,
                             std::vector<bool> wanted, Filter filter, int stretch)
    : streams_(streams),
      wanted_(std::move(wanted)),
      filter_(std::move(filter)),
      stretch_(stretch),
      num_taken_(streams.size(), 0),
      run_(streams.size(), 0),
      stream_of_topic_(source.topics().size(), -1),
      images_(streams.size()) {
  std::vector<bool> wanted_topics(source.topics().size(), false);
  for (std::size_t i = 0; i < streams_.size(); ++i) {
    const bool is_imu = streams_[i].kind == StreamKind::kImu;
    const auto topic = static_cast<std::size_t>(streams_[i].topic);
    stream_of_topic_[topic] = static_cast<int>(i);
    wanted_topics[topic] = wanted_[i] || is_imu;
    guards_.emplace_back(is_imu);
    health_.emplace_back();
    health_.back().topic = streams_[i].topic_name;
    health_.back().role = streams_[i].role;
  }
  messages_ = source.Read(wanted_topics);
}

std::optional<Arrival> ArrivalStream::Next() {
  while (ready_.empty() && !is_finished_) {
    if (std::optional<RawMessage> message = messages_->Next()) {
      Take(std::move(*message));
      continue;
    }
    is_finished_ = true;
    for (std::size_t i = 0; i < guards_.size(); ++i)
      Release(guards_[i].Finish(imu_front_, health_[i]));
    if (std::optional<Arrival> last = spikes_.Finish()) Deliver(std::move(*last));
  }
  if (ready_.empty()) return std::nullopt;
  Arrival arrival = std::move(ready_.front());
  ready_.pop_front();
  return arrival;
}

ClockRun ArrivalStream::NextRun(std::size_t stream) {
  const std::vector<ClockRun>& clock = streams_[stream].clock;
  const std::uint64_t message = num_taken_[stream]++;
  if (clock.empty()) return {};
  while (run_[stream] + 1 < clock.size() && clock[run_[stream] + 1].begin <= message)
    ++run_[stream];
  return clock[run_[stream]];
}

void ArrivalStream::Take(RawMessage message) {
  const int stream = stream_of_topic_[static_cast<std::size_t>(message.topic)];
  if (stream < 0) return;
  StreamHealth& health = health_[static_cast<std::size_t>(stream)];
  const ClockRun run = NextRun(static_cast<std::size_t>(stream));
  // An image of another stretch may be what those of a video refer to.
  const bool is_image = streams_[static_cast<std::size_t>(stream)].camera >= 0;
  if (run.stretch != stretch_ && !is_image) return;
  std::optional<Arrival> arrival;
  try {
    arrival = Decode(std::move(message), stream);
  } catch (const Error&) {
    if (run.stretch == stretch_) ++health.Dropped(DropReason::kDamaged);
    return;
  }
  if (!arrival || run.stretch != stretch_) return;
  if (IsTime(arrival->time)) SetTime(arrival->time + run.correction, *arrival);
  if (!IsTime(arrival->time)) {
    ++health.Dropped(DropReason::kOffClock);
  } else if (!IsPlausible(*arrival)) {
    ++health.Dropped(DropReason::kNotFinite);
  } else {
    Release(
        guards_[static_cast<std::size_t>(stream)].Push(std::move(*arrival), imu_front_, health));
  }
}

void ArrivalStream::Release(std::vector<Arrival> arrivals) {
  for (Arrival& arrival : arrivals) {
    const auto stream = static_cast<std::size_t>(arrival.stream);
    if (streams_[stream].kind != StreamKind::kImu) {
      Deliver(std::move(arrival));
      continue;
    }
    imu_front_ = arrival.time;
    if (IsStuck(arrival.time, streams_[stream])) {
      ++health_[stream].Dropped(DropReason::kStuck);
      continue;
    }
    SpikeFilter::Result result = spikes_.Push(std::move(arrival));
    if (result.is_spike) ++health_[stream].Dropped(DropReason::kNotFinite);
    if (result.good) Deliver(std::move(*result.good));
  }
}

void ArrivalStream::Deliver(Arrival arrival) {
  const auto stream = static_cast<std::size_t>(arrival.stream);
  ++health_[stream].num_delivered;
  if (wanted_[stream] && (!filter_ || filter_(arrival))) ready_.push_back(std::move(arrival));
}

std::optional<Arrival> ArrivalStream::Decode(RawMessage message, int index) {
  const SensorStream& stream = streams_[static_cast<std::size_t>(index)];
  switch (stream.kind) {
    case StreamKind::kImu: {
      ImuSample sample = ReadImuSample(message, stream);
      sample.angular_velocity *= stream.rate_scale;
      sample.linear_acceleration *= stream.acceleration_scale;
      if (IsTime(sample.time)) sample.time = sample.time + stream.time_shift;
      return Arrival{sample.time, index, sample};
    }
    case StreamKind::kWheels: {
      std::optional<WheelSample> sample = wheel_reader_.Read(message, stream);
      if (!sample) return std::nullopt;
      sample->forward_speed *= stream.speed_scale;
      if (IsTime(sample->time)) sample->time = sample->time + stream.time_shift;
      return Arrival{sample->time, index, *sample};
    }
    case StreamKind::kGnss: {
      const std::optional<GnssFix> fix = ReadGnssFix(message, stream);
      if (fix) return Arrival{fix->time, index, *fix};
      ++health_[static_cast<std::size_t>(index)].Dropped(DropReason::kNoFix);
      return std::nullopt;
    }
    case StreamKind::kImage:
    case StreamKind::kSemantic: break;
  }
  const Timestamp time = StampOf(message, stream.encoding, stream.type);
  return Arrival{IsTime(time) ? time + stream.time_shift : time, index,
                 images_[static_cast<std::size_t>(index)].Take(std::move(message), stream)};
}

}  // namespace parkade
