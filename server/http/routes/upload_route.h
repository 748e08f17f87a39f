#pragma once

#include <httplib.h>

#include "server/http/routes/route_context.h"
#include "server/store/receive_upload.h"

namespace parkade {

/// Checks an upload before its first byte is taken. Returns what it says about itself; throws
/// HttpError or Error.
NewDrive CheckUpload(const httplib::Request& request, const RouteContext& context);

}  // namespace parkade
