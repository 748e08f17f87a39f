#pragma once

#include <memory>
#include <vector>

#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// Several logs of one drive as one: split files, or one file per sensor. Topics of equal name,
/// type and encoding become one. Messages are merged by log time; a log is opened when its first
/// message is due. Where the recorder's clock was set back in between, so that logs of the same
/// topics overlap in time, but hold other messages there, they come one after the other, in the
/// order given; so do those of each sensor, where each has as many. `missing`: losses
/// that are known before reading.
std::unique_ptr<MessageSource> JoinSources(std::vector<std::unique_ptr<MessageSource>> parts,
                                           const DamageReport& missing = {});

}  // namespace parkade
