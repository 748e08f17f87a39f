#include "core/drive_log.h"

namespace parkade {

Timestamp TimeOf(const SensorRecord& record) {
  return std::visit([](const auto& sample) { return sample.time; }, record);
}

}  // namespace parkade
