// The robot's frames, pose, scan and grid for Foxglove.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/navigation/navigator_inputs.hpp"

#include "channels/map_picture.hpp"
#include "foxglove/foxglove_feed.hpp"

namespace topogeo::web {

/// Frames: map -> odom -> base_link -> laser. map -> odom exists as long as the robot is localized.
/// Lives in the loop of the service.
class FoxgloveView {
 public:
  FoxgloveView(FoxgloveFeed& feed, const geometry::Pose2& T_robot_laser)
      : feed_(feed), T_robot_laser_(T_robot_laser) {}

  void take(const navigation::ScanPoints& scan);
  void take(const msg::Odometry& odometry);
  void take(const msg::LivePose& pose);
  void take(const std::shared_ptr<const MapPicture>& picture);

 private:
  struct Stamped {
    std::int64_t stamp_ns = 0;
    geometry::Pose2 T;
  };

  void add_odometry(std::int64_t stamp_ns, const geometry::Pose2& T_odom_robot);
  void show_frames();

  FoxgloveFeed& feed_;
  geometry::Pose2 T_robot_laser_;
  std::deque<Stamped> odometry_;  // as received: the pose follows its scan later
  std::optional<Stamped> newest_;
  std::optional<Stamped> T_map_odom_;
};

/// foxglove.FrameTransforms with these transforms in turn.
struct FrameTransform {
  std::int64_t stamp_ns = 0;
  const char* parent = "";
  const char* child = "";
  geometry::Pose2 T_parent_child;
};
std::string frame_transforms(const std::vector<FrameTransform>& transforms);

/// foxglove.PoseInFrame, frame "map".
std::string pose_in_frame(std::int64_t stamp_ns, const geometry::Pose2& T_map_robot);

/// foxglove.PointCloud, frame "base_link": x, y and z as 32-bit floats.
std::string point_cloud(const navigation::ScanPoints& scan);

/// foxglove.Grid, frame "map": red, green, blue and alpha of each cell, one byte each.
std::string colored_grid(const MapPicture& picture, Layer layer, std::int64_t stamp_ns);

}  // namespace topogeo::web
