#include "ros_watcher.hpp"

#include <iostream>

#include "diagnostic_msgs.h"
#include "map_msgs.h"
#include "nav_msgs.h"
#include "ros_messages.hpp"
#include "rosgraph_msgs.h"
#include "sensor_msgs.h"
#include "tf2_msgs.h"
#include "visualization_msgs.h"

namespace topogeo::test {
namespace {

void print_map(const nav_msgs_msg_dds__OccupancyGrid_& map) {
  std::uint32_t free = 0;
  std::uint32_t occupied = 0;
  for (std::uint32_t i = 0; i < map.data_._length; ++i) {
    free += map.data_._buffer[i] == 0 ? 1 : 0;
    occupied += map.data_._buffer[i] == 100 ? 1 : 0;
  }
  std::cout << "map " << map.header_.frame_id_ << ' ' << map.info_.width_ << ' '
            << map.info_.height_ << ' ' << map.info_.resolution_ << ' ' << free << ' ' << occupied
            << ' ' << (map.data_._length == map.info_.width_ * map.info_.height_ ? "whole" : "cut")
            << '\n';
}

void print_transforms(const tf2_msgs_msg_dds__TFMessage_& message) {
  for (std::uint32_t i = 0; i < message.transforms_._length; ++i) {
    const auto& transform = message.transforms_._buffer[i];
    std::cout << "tf " << transform.header_.frame_id_ << ' ' << transform.child_frame_id_ << ' '
              << transform.transform_.translation_.x_ << ' ' << transform.transform_.translation_.y_
              << ' ' << yaw(transform.transform_.rotation_) << '\n';
  }
}

void print_diagnostics(const diagnostic_msgs_msg_dds__DiagnosticArray_& array) {
  for (std::uint32_t i = 0; i < array.status_._length; ++i) {
    std::cout << "diagnostics " << array.status_._buffer[i].name_ << ' '
              << static_cast<int>(array.status_._buffer[i].level_) << '\n';
  }
}

}  // namespace

Watcher::Watcher(std::uint32_t domain) : peer_(domain) {
  maps_ = peer_.reader(nav_msgs_msg_dds__OccupancyGrid__desc, "/map", PeerQos::kLatched);
  updates_ =
      peer_.reader(map_msgs_msg_dds__OccupancyGridUpdate__desc, "/map_updates", PeerQos::kReliable);
  transforms_ = peer_.reader(tf2_msgs_msg_dds__TFMessage__desc, "/tf", PeerQos::kReliable);
  poses_ = peer_.reader(geometry_msgs_msg_dds__PoseWithCovarianceStamped__desc, "/pose",
                        PeerQos::kReliable);
  plans_ = peer_.reader(nav_msgs_msg_dds__Path__desc, "/plan", PeerQos::kReliable);
  graphs_ =
      peer_.reader(visualization_msgs_msg_dds__MarkerArray__desc, "/graph", PeerQos::kLatched);
  diagnostics_ = peer_.reader(diagnostic_msgs_msg_dds__DiagnosticArray__desc, "/diagnostics",
                              PeerQos::kReliable);
  velocities_ = peer_.reader(geometry_msgs_msg_dds__Twist__desc, "/cmd_vel", PeerQos::kReliable);
}

void Watcher::print() {
  take<nav_msgs_msg_dds__OccupancyGrid_>(maps_, print_map);
  take<map_msgs_msg_dds__OccupancyGridUpdate_>(
      updates_, [](const map_msgs_msg_dds__OccupancyGridUpdate_& update) {
        std::cout << "map_update " << update.width_ << ' ' << update.height_ << '\n';
      });
  take<tf2_msgs_msg_dds__TFMessage_>(transforms_, print_transforms);
  take<PoseMessage>(poses_, [](const PoseMessage& pose) {
    const auto& at = pose.pose_.pose_;
    std::cout << "pose " << pose.header_.frame_id_ << ' ' << at.position_.x_ << ' '
              << at.position_.y_ << ' ' << yaw(at.orientation_) << ' ' << pose.pose_.covariance_[0]
              << '\n';
  });
  take<nav_msgs_msg_dds__Path_>(plans_, [](const nav_msgs_msg_dds__Path_& path) {
    std::cout << "plan " << path.poses_._length << '\n';
  });
  take<visualization_msgs_msg_dds__MarkerArray_>(
      graphs_, [](const visualization_msgs_msg_dds__MarkerArray_& array) {
        std::cout << "graph " << array.markers_._length << '\n';
      });
  take<diagnostic_msgs_msg_dds__DiagnosticArray_>(diagnostics_, print_diagnostics);
  take<geometry_msgs_msg_dds__Twist_>(velocities_, [](const geometry_msgs_msg_dds__Twist_& twist) {
    std::cout << "velocity " << twist.linear_.x_ << ' ' << twist.angular_.z_ << '\n';
  });
  std::cout << std::flush;
}

void print_sensors(std::uint32_t domain) {
  const RosPeer peer(domain);
  const dds_entity_t scans =
      peer.reader(sensor_msgs_msg_dds__LaserScan__desc, "/scan", PeerQos::kSensor);
  const dds_entity_t odometry =
      peer.reader(nav_msgs_msg_dds__Odometry__desc, "/odom", PeerQos::kSensor);
  const dds_entity_t transforms =
      peer.reader(tf2_msgs_msg_dds__TFMessage__desc, "/tf", PeerQos::kReliable);
  const dds_entity_t fixed =
      peer.reader(tf2_msgs_msg_dds__TFMessage__desc, "/tf_static", PeerQos::kLatched);
  const dds_entity_t clock =
      peer.reader(rosgraph_msgs_msg_dds__Clock__desc, "/clock", PeerQos::kReliable);
  const auto print_transforms = [](const tf2_msgs_msg_dds__TFMessage_& message) {
    for (std::uint32_t i = 0; i < message.transforms_._length; ++i) {
      const auto& transform = message.transforms_._buffer[i];
      std::cout << "tf " << transform.header_.frame_id_ << ' ' << transform.child_frame_id_ << ' '
                << transform.transform_.translation_.x_ << '\n';
    }
  };
  std::cout << "ready" << std::endl;
  for (;; pause_ms(20)) {
    take<sensor_msgs_msg_dds__LaserScan_>(scans, [](const sensor_msgs_msg_dds__LaserScan_& scan) {
      std::cout << "scan " << scan.header_.frame_id_ << ' ' << scan.ranges_._length << ' '
                << stamp_ns(scan.header_) << '\n';
    });
    take<nav_msgs_msg_dds__Odometry_>(odometry, [](const nav_msgs_msg_dds__Odometry_& message) {
      std::cout << "odom " << message.header_.frame_id_ << ' ' << message.child_frame_id_ << ' '
                << message.pose_.pose_.position_.x_ << '\n';
    });
    take<tf2_msgs_msg_dds__TFMessage_>(transforms, print_transforms);
    take<tf2_msgs_msg_dds__TFMessage_>(fixed, print_transforms);
    take<rosgraph_msgs_msg_dds__Clock_>(clock, [](const rosgraph_msgs_msg_dds__Clock_& message) {
      std::cout << "clock " << message.clock_.sec_ * kSecond_ns + message.clock_.nanosec_ << '\n';
    });
    std::cout << std::flush;
  }
}

}  // namespace topogeo::test
