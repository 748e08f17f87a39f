#include "export/pose_files.h"

#include <cstdio>

namespace parkade {

std::string EncodeKittiPoses(std::span<const TimedPose> poses) {
  std::string text;
  for (const TimedPose& pose : poses) {
    const Eigen::Matrix4d matrix = pose.world_from_frame.Matrix();
    for (Eigen::Index row = 0; row < 3; ++row)
      for (Eigen::Index column = 0; column < 4; ++column) {
        char number[32];
        std::snprintf(number, sizeof number, "%.9e", matrix(row, column));
        text += number;
        text += row == 2 && column == 3 ? '\n' : ' ';
      }
  }
  return text;
}

std::string EncodeEurocPoses(std::span<const TimedPose> poses) {
  std::string text =
      "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
      "q_RS_z []\n";
  for (const TimedPose& pose : poses) {
    const Eigen::Vector3d& p = pose.world_from_frame.translation;
    const Eigen::Quaterniond& q = pose.world_from_frame.rotation;
    char line[256];
    std::snprintf(line, sizeof line, "%lld,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f\n",
                  static_cast<long long>(pose.time.ns), p.x(), p.y(), p.z(), q.w(), q.x(), q.y(),
                  q.z());
    text += line;
  }
  return text;
}

}  // namespace parkade
