#include "server/ingest/schemas/mapped_source.h"

#include <cmath>
#include <deque>

#include "core/error.h"
#include "server/ingest/schemas/message_schema.h"
#include "server/ingest/schemas/sensor_signals.h"

namespace parkade {
namespace {

enum class Sensor { kImu, kWheels, kGnss };

struct MappedSensor {
  Sensor sensor = Sensor::kImu;
  int topic = 0;  ///< of the mapped source
  FieldSignals signals;
};

/// What all passes share.
struct FieldPlan {
  VehicleCalibration vehicle;
  std::vector<MappedSensor> sensors;
  std::vector<TopicInfo> topics;                                ///< of the source
  std::map<int, std::shared_ptr<const MessageSchema>> schemas;  ///< of the topics with signals
};

Timestamp TimeOf(const SignalValues& values, const MessageTree& message, Timestamp log_time) {
  const auto stamp = values.find("stamp");
  constexpr double kLatest = 9e9;  // [s]
  if (stamp != values.end())
    return stamp->second > 0 && stamp->second < kLatest
               ? Timestamp{static_cast<std::int64_t>(std::llround(stamp->second * 1e9))}
               : log_time;
  const Timestamp own = StampIn(message);
  return own.ns == 0 ? log_time : own;
}

/// Turns messages of one pass into those of one sensor.
class SensorMaker {
 public:
  SensorMaker(const MappedSensor& sensor, const FieldPlan& plan)
      : sensor_(sensor), reader_(sensor.signals, plan.topics), wheels_(plan.vehicle) {}

  bool Wants(int topic) const { return reader_.topics().contains(topic); }
  const std::set<int>& topics() const { return reader_.topics(); }

  std::optional<RawMessage> Take(const RawMessage& message, const MessageTree& tree) {
    const std::optional<SignalValues> values = reader_.Take(message.topic, tree);
    if (!values) return std::nullopt;
    auto data = Convert(*values, TimeOf(*values, tree, message.log_time));
    if (!data) return std::nullopt;
    return RawMessage{sensor_.topic, message.log_time, std::move(*data), message.place};
  }

  /// Counts as damaged.
  RawMessage Damaged(const RawMessage& message) const {
    return {sensor_.topic, message.log_time, {}, message.place};
  }

 private:
  std::optional<std::vector<std::uint8_t>> Convert(const SignalValues& values, Timestamp time) {
    if (sensor_.sensor == Sensor::kImu) return ImuFromSignals(values, time);
    if (sensor_.sensor == Sensor::kGnss) return FixFromSignals(values, time);
    return wheels_.Convert(values, time);
  }

  MappedSensor sensor_;
  SignalReader reader_;
  WheelSignals wheels_;
};

class MappedStream : public MessageStream {
 public:
  MappedStream(const MessageSource& source, std::shared_ptr<const FieldPlan> plan,
               const std::vector<bool>& wanted)
      : plan_(std::move(plan)), wanted_(wanted) {
    std::vector<bool> needed(wanted.begin(),
                             wanted.begin() + static_cast<std::ptrdiff_t>(plan_->topics.size()));
    for (const MappedSensor& sensor : plan_->sensors) {
      if (!wanted[static_cast<std::size_t>(sensor.topic)]) continue;
      makers_.emplace_back(sensor, *plan_);
      for (const int topic : makers_.back().topics())
        needed[static_cast<std::size_t>(topic)] = true;
    }
    stream_ = source.Read(needed);
  }

  std::optional<RawMessage> Next() override {
    while (ready_.empty()) {
      std::optional<RawMessage> message = stream_->Next();
      if (!message) return std::nullopt;
      Make(*message);
      if (wanted_[static_cast<std::size_t>(message->topic)]) ready_.push_back(std::move(*message));
    }
    RawMessage next = std::move(ready_.front());
    ready_.pop_front();
    return next;
  }

  const DamageReport& damage() const override { return stream_->damage(); }

 private:
  void Make(const RawMessage& message) {
    std::optional<MessageTree> tree;
    for (SensorMaker& maker : makers_) {
      if (!maker.Wants(message.topic)) continue;
      try {
        if (!tree) tree = plan_->schemas.at(message.topic)->Decode(message.data);
        if (auto made = maker.Take(message, *tree)) ready_.push_back(std::move(*made));
      } catch (const Error&) {
        ready_.push_back(maker.Damaged(message));
      }
    }
  }

  std::shared_ptr<const FieldPlan> plan_;
  std::vector<bool> wanted_;
  std::vector<SensorMaker> makers_;
  std::deque<RawMessage> ready_;
  std::unique_ptr<MessageStream> stream_;
};

/// What messages have at a path where they lack what is wanted, for a person.
class WhatThereIs {
 public:
  void Include(const std::string& topic, const MessageTree& tree, const FieldSignals& signals) {
    last_[topic] = tree;
    for (const auto& [name, signal] : signals) {
      if (!topic.ends_with(signal.topic)) continue;
      for (const std::string& other : MessagePath(signal.path).NamesInstead(tree))
        if (names_[name].size() < kMaxNames) names_[name].insert(other);
    }
  }

  std::string Describe(const std::string& name, const FieldSignal& signal) const {
    if (const auto names = names_.find(name); names != names_.end() && !names->second.empty()) {
      std::string list;
      for (const std::string& other : names->second)
        list.append(list.empty() ? "" : ", ").append(other);
      return "the names " + list;
    }
    for (const auto& [topic, tree] : last_)
      if (topic.ends_with(signal.topic)) return "numbers at " + ListNumbers(tree);
    return "no message that can be read";
  }

 private:
  static constexpr std::size_t kMaxNames = 40;

  std::map<std::string, MessageTree> last_;             ///< by topic
  std::map<std::string, std::set<std::string>> names_;  ///< by signal
};

/// Reads messages of a sensor's topics until each of its signals was found.
void RequireFields(const MessageSource& source, const MappedSensor& sensor, const FieldPlan& plan) {
  constexpr int kMaxMessages = 1000;
  SignalReader reader(sensor.signals, plan.topics);
  std::vector<bool> wanted(plan.topics.size(), false);
  for (const int topic : reader.topics()) wanted[static_cast<std::size_t>(topic)] = true;
  WhatThereIs there_is;
  const auto stream = source.Read(wanted);
  for (int i = 0; i < kMaxMessages && !reader.Missing().empty(); ++i) {
    const std::optional<RawMessage> message = stream->Next();
    if (!message) break;
    try {
      const MessageTree tree = plan.schemas.at(message->topic)->Decode(message->data);
      reader.Take(message->topic, tree);
      there_is.Include(plan.topics[static_cast<std::size_t>(message->topic)].topic, tree,
                       sensor.signals);
    } catch (const Error&) {
      continue;  // the survey counts what is damaged
    }
  }
  const std::vector<std::string> missing = reader.Missing();
  if (missing.empty()) return;
  const FieldSignal& signal = sensor.signals.at(missing.front());
  throw Error(ErrorCode::kInvalidInput, "the field map of vehicle.yaml wants '" + missing.front() +
                                            "' at '" + signal.path + "' of " + signal.topic +
                                            ", which has " +
                                            there_is.Describe(missing.front(), signal));
}

class MappedSource : public MessageSource {
 public:
  MappedSource(std::shared_ptr<const MessageSource> source, const VehicleCalibration& vehicle)
      : source_(std::move(source)), topics_(source_->topics()) {
    FieldPlan plan;
    plan.vehicle = vehicle;
    plan.topics = source_->topics();
    Add(Sensor::kImu, vehicle.fields.imu, {kImuFields, "sensor_msgs/Imu"}, plan);
    Add(Sensor::kWheels, vehicle.fields.wheels, {kWheelFields, "geometry_msgs/TwistStamped"}, plan);
    Add(Sensor::kGnss, vehicle.fields.gnss, {kGnssFields, "sensor_msgs/NavSatFix"}, plan);
    for (const MappedSensor& sensor : plan.sensors) RequireFields(*source_, sensor, plan);
    plan_ = std::make_shared<const FieldPlan>(std::move(plan));
  }

  const std::vector<TopicInfo>& topics() const override { return topics_; }
  std::string format() const override { return source_->format(); }
  std::unique_ptr<MessageStream> Read(const std::vector<bool>& wanted) const override {
    return std::make_unique<MappedStream>(*source_, plan_, wanted);
  }
  std::optional<RawMessage> ReadAt(int topic, const MessagePlace& place) const override {
    if (topic >= static_cast<int>(plan_->topics.size())) return std::nullopt;
    return source_->ReadAt(topic, place);
  }

 private:
  void Add(Sensor sensor, const FieldSignals& signals, TopicInfo info, FieldPlan& plan) {
    if (signals.empty()) return;
    info.encoding = MessageEncoding::kCdr;
    plan.sensors.push_back({sensor, static_cast<int>(topics_.size()), signals});
    const SignalReader reader(signals, plan.topics);
    for (const int topic : reader.topics()) {
      const TopicInfo& own = plan.topics[static_cast<std::size_t>(topic)];
      if (!plan.schemas.contains(topic)) plan.schemas[topic] = ReadSchema(own);
      info.num_messages = std::max(info.num_messages, own.num_messages);
    }
    topics_.push_back(std::move(info));
  }

  std::shared_ptr<const MessageSource> source_;
  std::vector<TopicInfo> topics_;
  std::shared_ptr<const FieldPlan> plan_;
};

}  // namespace

std::shared_ptr<const MessageSource> MapFields(std::shared_ptr<const MessageSource> source,
                                               Rig& rig) {
  if (!rig.vehicle || rig.vehicle->fields.IsEmpty()) return source;
  RequireLengths(*rig.vehicle);
  const FieldMap& fields = rig.vehicle->fields;
  if (!fields.imu.empty()) rig.imu.topic = kImuFields;
  if (!fields.wheels.empty()) rig.vehicle->wheel_topic = kWheelFields;
  if (!fields.gnss.empty()) rig.vehicle->gnss_topic = kGnssFields;
  return std::make_shared<const MappedSource>(std::move(source), *rig.vehicle);
}

}  // namespace parkade
