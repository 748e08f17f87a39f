#include "server/ingest/drive/folder_rig.h"

#include "core/error.h"
#include "server/ingest/drive/euroc_rig.h"
#include "server/ingest/drive/kitti_rig.h"

namespace parkade {

Rig ReadFolderRig(const DriveFolder& folder) {
  switch (folder.layout) {
    case FolderLayout::kEuroc: return ReadEurocRig(folder.path);
    case FolderLayout::kKitti: return ReadKittiRig(folder.path);
    case FolderLayout::kPlain: break;
  }
  Require(std::filesystem::exists(folder.path / "imu.csv"), ErrorCode::kInvalidInput,
          "the log has no IMU data (imu.csv)");
  throw Error(ErrorCode::kInvalidInput,
              "no rig: a folder of images and tables brings none, bring a rig of Kalibr's files");
}

}  // namespace parkade
