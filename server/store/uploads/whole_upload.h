#pragma once

#include <functional>
#include <string>

#include "server/store/uploads/upload_options.h"

namespace parkade {

/// Makes a drive of what arrived in parts, a log that was hashed and checked, and tells the
/// service. `note` is done in the same transaction. Its file goes: the drive has the log. `by` says
/// in the service's log what it was, "upload=ID".
void MakeDriveOf(const ArrivedLog& log, Store& store, const NewDrive& drive,
                 const UploadOptions& options,
                 const std::function<void(Connection&, const Drive&)>& note, const std::string& by);

}  // namespace parkade
