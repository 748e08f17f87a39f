#pragma once

#include "server/ingest/inspection/log_inspection.h"

namespace parkade {

/// Reads a source to its end for what is told of its topics and of damage, and for the span, where
/// `inspection` has none yet. Decodes images on all cores.
/// \param max_images  of each topic, that are decoded
void InspectTopics(const MessageSource& source, LogInspection& inspection,
                   std::uint64_t max_images = UINT64_MAX);

}  // namespace parkade
