#pragma once

#include <memory>

#include "server/ingest/containers/raw_message.h"

namespace parkade {

/// Wraps a source of files that were unpacked for it, so that it and its passes keep them (`files`
/// deletes them at its end) and report the damage that unpacking found.
std::unique_ptr<MessageSource> KeepUnpacked(std::unique_ptr<MessageSource> source,
                                            std::shared_ptr<const void> files,
                                            const DamageReport& damage);

}  // namespace parkade
