#include "foxglove/foxglove_view.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include <openssl/evp.h>

#include "topogeo/service/conversions.hpp"
#include "topogeo/support/host.hpp"

#include "foxglove/foxglove_json.hpp"

namespace topogeo::web {
namespace {

using geometry::Pose2;

constexpr const char* kOdometryFrame = "odom";
constexpr const char* kRobotFrame = "base_link";
constexpr const char* kLaserFrame = "laser";
/// Number of odometry messages kept: more than arrive between a scan and its pose.
constexpr std::size_t kKeptOdometry = 256;
/// Scans and odometry arrive on two topics, hence possibly out of order.
constexpr std::int64_t kDisorder_ns = 5'000'000'000;
/// 4 MB; larger maps are sent with larger cells.
constexpr std::size_t kMostGridCells = 1'000'000;
// Type numbers of packed fields.
constexpr int kUint8 = 1;
constexpr int kFloat32 = 7;

std::string base64(std::string_view bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int size = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                   reinterpret_cast<const unsigned char*>(bytes.data()),
                                   static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(size));
  return text;
}

Json packed_fields(const std::vector<const char*>& names, int type, std::size_t bytes) {
  Json fields = Json::array();
  for (std::size_t i = 0; i < names.size(); ++i) {
    fields.push_back({{"name", names[i]}, {"offset", i * bytes}, {"type", type}});
  }
  return fields;
}

void append_float(std::string& bytes, double value) {
  static_assert(std::endian::native == std::endian::little);
  const auto number = std::bit_cast<std::array<char, sizeof(float)>>(static_cast<float>(value));
  bytes.append(number.data(), number.size());
}

}  // namespace

std::string frame_transforms(const std::vector<FrameTransform>& transforms) {
  Json list = Json::array();
  for (const FrameTransform& transform : transforms) {
    const Pose2& T = transform.T_parent_child;
    list.push_back({{"timestamp", foxglove_time(transform.stamp_ns)},
                    {"parent_frame_id", transform.parent},
                    {"child_frame_id", transform.child},
                    {"translation", foxglove_vector(T.x_m, T.y_m)},
                    {"rotation", foxglove_rotation(T.theta_rad)}});
  }
  return text_of(Json{{"transforms", std::move(list)}});
}

std::string pose_in_frame(std::int64_t stamp_ns, const Pose2& T_map_robot) {
  return text_of(
      Json{{"timestamp", foxglove_time(stamp_ns)},
           {"frame_id", kMapFrame},
           {"pose", foxglove_pose(T_map_robot.x_m, T_map_robot.y_m, T_map_robot.theta_rad)}});
}

std::string point_cloud(const navigation::ScanPoints& scan) {
  std::string bytes;
  bytes.reserve(3 * sizeof(float) * scan.points_m.size());
  for (const Eigen::Vector2d& point_m : scan.points_m) {
    append_float(bytes, point_m.x());
    append_float(bytes, point_m.y());
    append_float(bytes, 0.0);
  }
  return text_of(Json{{"timestamp", foxglove_time(scan.stamp_ns)},
                      {"frame_id", kRobotFrame},
                      {"pose", foxglove_pose(0.0, 0.0)},
                      {"point_stride", 3 * sizeof(float)},
                      {"fields", packed_fields({"x", "y", "z"}, kFloat32, sizeof(float))},
                      {"data", base64(bytes)}});
}

std::string colored_grid(const MapPicture& picture, Layer layer, std::int64_t stamp_ns) {
  const ColorImage image = picture.colors(layer, kMostGridCells);
  const Pose2& corner = picture.frame().T_map_grid;
  constexpr int kParts = 4;
  return text_of(Json{{"timestamp", foxglove_time(stamp_ns)},
                      {"frame_id", kMapFrame},
                      {"pose", foxglove_pose(corner.x_m, corner.y_m, corner.theta_rad)},
                      {"column_count", image.columns},
                      {"cell_size", {{"x", image.pixel_m}, {"y", image.pixel_m}}},
                      {"row_stride", kParts * image.columns},
                      {"cell_stride", kParts},
                      {"fields", packed_fields({"red", "green", "blue", "alpha"}, kUint8, 1)},
                      {"data", base64(image.rgba)}});
}

void FoxgloveView::take(const navigation::ScanPoints& scan) {
  add_odometry(scan.stamp_ns, scan.T_odom_robot);
  feed_.set(LiveTopic::kScan, [scan] { return point_cloud(scan); });
}

void FoxgloveView::take(const msg::Odometry& odometry) {
  add_odometry(odometry.stamp_ns(), service::from_msg(odometry.T_odom_robot()));
}

void FoxgloveView::take(const msg::LivePose& pose) {
  if (pose.state() != msg::kStateTracking && pose.state() != msg::kStateAmbiguous) {
    T_map_odom_.reset();
    return;
  }
  const Pose2 T_map_robot = service::from_msg(pose.T_map_robot());
  feed_.set(LiveTopic::kPose, [stamp_ns = pose.stamp_ns(), T_map_robot] {
    return pose_in_frame(stamp_ns, T_map_robot);
  });
  // A pose belongs to a scan or to an odometry message.
  const auto at = std::ranges::find(odometry_, pose.stamp_ns(), &Stamped::stamp_ns);
  if (at == odometry_.end()) return;
  T_map_odom_ = Stamped{pose.stamp_ns(), T_map_robot * inverse(at->T)};
  show_frames();
}

void FoxgloveView::take(const std::shared_ptr<const MapPicture>& picture) {
  const std::int64_t now_ns = support::wall_clock_ns();
  for (const auto& [topic, layer] :
       {std::pair{LiveTopic::kMap, Layer::kGrid}, std::pair{LiveTopic::kRoomMap, Layer::kRooms}}) {
    feed_.set(topic,
              [picture, layer = layer, now_ns] { return colored_grid(*picture, layer, now_ns); });
  }
}

void FoxgloveView::add_odometry(std::int64_t stamp_ns, const Pose2& T_odom_robot) {
  if (newest_ && stamp_ns < newest_->stamp_ns - kDisorder_ns) {  // another source or a restart
    odometry_.clear();
    newest_.reset();
    T_map_odom_.reset();
  }
  odometry_.push_back({stamp_ns, T_odom_robot});
  if (odometry_.size() > kKeptOdometry) odometry_.pop_front();
  if (newest_ && stamp_ns <= newest_->stamp_ns) return;
  newest_ = odometry_.back();
  show_frames();
}

void FoxgloveView::show_frames() {
  std::vector<FrameTransform> transforms;
  if (T_map_odom_) {
    transforms.push_back({T_map_odom_->stamp_ns, kMapFrame, kOdometryFrame, T_map_odom_->T});
  }
  transforms.push_back({newest_->stamp_ns, kOdometryFrame, kRobotFrame, newest_->T});
  transforms.push_back({newest_->stamp_ns, kRobotFrame, kLaserFrame, T_robot_laser_});
  feed_.set(LiveTopic::kTransforms,
            [transforms = std::move(transforms)] { return frame_transforms(transforms); });
}

}  // namespace topogeo::web
