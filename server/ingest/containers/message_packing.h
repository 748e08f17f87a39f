#pragma once

#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// rosbag2 can pack each message with zstd by itself (compression_mode MESSAGE). Unpacks such a
/// message; no CDR message can begin like a zstd frame, so nothing else needs to tell. False when
/// it is damaged; the loss is then counted.
bool UnpackMessage(const TopicInfo& topic, RawMessage& message, DamageReport& damage);

}  // namespace parkade
