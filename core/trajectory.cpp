#include "core/trajectory.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <string_view>
#include <system_error>

#include "core/error.h"
#include "core/files/appended_file.h"
#include "core/files/file.h"

namespace parkade {
namespace {

/// The first word of a line, which is taken off; empty where there is none.
std::string_view TakeWord(std::string_view& line) {
  constexpr std::string_view kSpaces = " \t\r";
  line.remove_prefix(std::min(line.find_first_not_of(kSpaces), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kSpaces));
  line.remove_prefix(word.size());
  return word;
}

}  // namespace

Trajectory::Trajectory(std::vector<TrajectoryState> states) {
  for (size_t i = 0; i < states.size(); ++i) {
    const TrajectoryState& state = states[i];
    Require(state.world_from_body.translation.allFinite() &&
                state.world_from_body.rotation.coeffs().allFinite() &&
                state.velocity_in_world.allFinite(),
            ErrorCode::kInternal, "a trajectory holds a pose that is not finite");
    Require(i == 0 || states[i - 1].time < state.time, ErrorCode::kInternal,
            "the times of a trajectory do not increase");
  }
  states_ = std::make_shared<const std::vector<TrajectoryState>>(std::move(states));
}

const std::vector<TrajectoryState>& Trajectory::states() const {
  static const std::vector<TrajectoryState> none;
  return states_ ? *states_ : none;
}

TimeSpan Trajectory::span() const {
  return empty() ? TimeSpan{} : TimeSpan{states().front().time, states().back().time};
}

double Trajectory::Length() const {
  double length = 0;
  for (size_t i = 1; i < states().size(); ++i)
    length +=
        (states()[i].world_from_body.translation - states()[i - 1].world_from_body.translation)
            .norm();
  return length;
}

std::optional<Rigid3> Trajectory::At(Timestamp time) const {
  if (!span().Contains(time)) return std::nullopt;
  const auto after =
      std::lower_bound(states().begin(), states().end(), time,
                       [](const TrajectoryState& state, Timestamp t) { return state.time < t; });
  if (after->time == time) return after->world_from_body;
  const auto before = std::prev(after);
  return Interpolate(before->world_from_body, after->world_from_body,
                     (time - before->time) / (after->time - before->time));
}

Trajectory Trajectory::Transformed(const Rigid3& target_from_world) const {
  std::vector<TrajectoryState> moved = states();
  const Eigen::Matrix3d rotation = target_from_world.rotation.toRotationMatrix();
  for (TrajectoryState& state : moved) {
    state.world_from_body = target_from_world * state.world_from_body;
    state.velocity_in_world = rotation * state.velocity_in_world;
    Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Identity();
    turn.bottomRightCorner<3, 3>() = rotation;
    state.covariance = turn * state.covariance * turn.transpose();
  }
  return Trajectory(std::move(moved));
}

std::vector<TimedPose> ReadTum(const std::filesystem::path& file) {
  const std::string text = ReadFile(file);
  std::vector<TimedPose> poses;
  std::string_view rest = text;
  for (int number = 1; !rest.empty(); ++number) {
    std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    const std::string_view time = TakeWord(line);
    if (time.empty() || time.front() == '#') continue;
    const auto where = [&] {
      return "'" + file.filename().string() + "', line " + std::to_string(number);
    };
    std::array<double, 7> values{};
    for (double& value : values) {
      std::string_view word = TakeWord(line);
      if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
      const char* end = word.data() + word.size();
      const std::from_chars_result result = std::from_chars(word.data(), end, value);
      if (result.ec != std::errc() || result.ptr != end)
        throw Error(ErrorCode::kInvalidInput, where() + " is not 't x y z qx qy qz qw'");
    }
    TimedPose pose;
    Eigen::Vector3d& p = pose.world_from_frame.translation;
    Eigen::Quaterniond& q = pose.world_from_frame.rotation;
    p = {values[0], values[1], values[2]};
    q = {values[6], values[3], values[4], values[5]};
    if (!p.allFinite() || !(std::abs(q.norm() - 1) < 1e-2))
      throw Error(ErrorCode::kInvalidInput,
                  where() + " holds no finite pose with a unit quaternion");
    q.normalize();
    pose.time = ParseSeconds(std::string(time));
    poses.push_back(pose);
  }
  return poses;
}

void WriteTum(const std::vector<TimedPose>& poses, const std::filesystem::path& file) {
  WriteFileAtomically(file, [&](const std::filesystem::path& temporary) {
    AppendedFile text(temporary);
    text.Append("# t x y z qx qy qz qw\n");
    for (const TimedPose& pose : poses) {
      const Eigen::Vector3d& p = pose.world_from_frame.translation;
      const Eigen::Quaterniond& q = pose.world_from_frame.rotation;
      char line[256];
      std::snprintf(line, sizeof line, "%s %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n",
                    ToDecimalSeconds(pose.time).c_str(), p.x(), p.y(), p.z(), q.x(), q.y(), q.z(),
                    q.w());
      text.Append(line);
    }
    text.Flush();
  });
}

}  // namespace parkade
