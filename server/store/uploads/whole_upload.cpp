#include "server/store/uploads/whole_upload.h"

#include "core/log.h"
#include "server/store/disk/durable_file.h"

namespace parkade {

void MakeDriveOf(const ArrivedLog& log, Store& store, const NewDrive& drive,
                 const UploadOptions& options,
                 const std::function<void(Connection&, const Drive&)>& note,
                 const std::string& by) {
  MakeReadOnly(log.path);
  const ReceivedDrive received = ReceiveDrive(store, drive, log, options.merge_drives, note);
  std::error_code ignored;
  std::filesystem::remove(log.path, ignored);
  LogInfo("received drive=" + received.drive.id + " bytes=" + std::to_string(log.bytes) +
          " site=" + received.drive.site + " job=" + received.job.id + " " + by);
  options.on_received(received);
}

}  // namespace parkade
