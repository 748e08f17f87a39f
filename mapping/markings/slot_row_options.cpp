#include "mapping/markings/slot_row_options.h"

#include "core/error.h"

namespace parkade {

void SlotMeasures::Validate() const {
  Require(min_pitch > 0 && max_pitch > min_pitch, ErrorCode::kUsage,
          "slots: 0 < min_pitch < max_pitch");
  Require(min_length > 0 && max_length > min_length, ErrorCode::kUsage,
          "slots: 0 < min_length < max_length");
  Require(usual_length >= min_length && usual_length <= max_length, ErrorCode::kUsage,
          "slots: usual_length must be in min_length..max_length");
}

void SlotRowOptions::Validate() const {
  beside.Validate();
  behind.Validate();
  Require(max_missing >= 0, ErrorCode::kUsage, "slots: max_missing must not be negative");
  Require(min_confidence >= 0 && min_confidence <= 1, ErrorCode::kUsage,
          "slots: min_confidence must be in 0..1");
}

}  // namespace parkade
