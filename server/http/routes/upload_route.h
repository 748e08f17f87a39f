#pragma once

#include <httplib.h>

#include "server/http/routes/route_context.h"
#include "server/store/receive_upload.h"

namespace parkade {

/// Checks an upload before its first byte is taken. Returns what it says about itself; throws
/// HttpError or Error.
NewDrive CheckUpload(const httplib::Request& request, const RouteContext& context);

/// Throws unless the file looks like a drive log. The check speaks of the file that it is given,
/// the sentence of the name that the user knows.
void CheckLog(const ServeOptions& options, const std::filesystem::path& file,
              const std::string& filename);

/// Tells listeners, the inspector and the queue that a drive has come.
void AnnounceDrive(const ReceivedDrive& received, EventHub& events, JobRunner& jobs,
                   DriveInspector* inspector);

}  // namespace parkade
