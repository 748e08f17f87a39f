#include "server/ingest/containers/message_packing.h"

#include "core/error.h"
#include "server/ingest/containers/chunk_codec.h"
#include "server/ingest/containers/damage.h"
#include "server/ingest/containers/log_record.h"

namespace parkade {

bool UnpackMessage(const TopicInfo& topic, RawMessage& message, DamageReport& damage) {
  if (topic.encoding != MessageEncoding::kCdr || !IsZstd(message.data)) return true;
  try {
    message.data = UnpackZstd(message.data, kMaxMessageSize);
    return true;
  } catch (const Error& error) {
    AddLoss(damage, {error.what(), topic.topic, {message.log_time, message.log_time}, 1});
    return false;
  }
}

}  // namespace parkade
