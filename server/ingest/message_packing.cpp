#include "server/ingest/message_packing.h"

#include "core/error.h"
#include "server/ingest/chunk_codec.h"
#include "server/ingest/damage.h"
#include "server/ingest/log_record.h"

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
