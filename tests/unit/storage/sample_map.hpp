// A made-up map with a distinct value in every field, and a scratch directory.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "topogeo/storage/map_document.hpp"

namespace topogeo::storage {

inline topomap::LocalMap sample_local_map(std::uint32_t id) {
  const double d = id;
  topomap::LocalMap map;
  map.robot_id = "robot-1";
  map.id = id;
  map.sequence = std::uint64_t{10} * id;
  map.stamp_ns = 1'000'000'000LL * id + 7;
  map.T_odom_robot = {d, -0.5 * d, 0.1};
  map.T_previous_robot = {1.0, 0.25, -0.2};
  map.T_robot_laser = {0.17, -0.0, 0.01};
  map.nodes = {{0, topomap::NodeKind::kReal, {1.0 + d, 2.0}, 0.8, {0, 3, 65535}, true},
               {1, topomap::NodeKind::kHallCorridor, {3.0, 1.0 / 3.0}, 1.1, {}, false}};
  map.branches = {{0, 0, 1, {2, 5}, true, false, false, {{{1.0, 2.0}, 0.8}, {{3.0, 4.0}, 1.1}}}};
  map.points = {{0.5F, 1.5F}, {-2.25F, 0.1F}, {0.0F, -0.0F}};
  if (id > 0) map.track = {{std::uint64_t{10} * id - 1, 5, {0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}, true}};
  return map;
}

/// The same in the form of a local mapper.
inline topomap::LocalMap sample_stop_of(std::uint64_t session, std::uint32_t number) {
  topomap::LocalMap map = sample_local_map(number);
  map.stop = {session, number};
  map.odometry_epoch = 12;
  return map;
}

inline topomap::StopPose sample_stop(std::uint32_t id, double x_m) {
  topomap::StopPose stop{id, 1'000'000'000LL * id + 7, {x_m, 2.0, -3.0}, Eigen::Matrix3d::Zero()};
  stop.covariance << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  return stop;
}

inline topomap::GlobalMap sample_global_map() {
  topomap::GlobalMap map;
  map.version = 4;
  map.nodes = {{2, topomap::NodeKind::kDoor, {0.1, 0.2}, 0.45, 3},
               {7, topomap::NodeKind::kFictitious, {5.0, 6.0}, 0.7, 1}};
  map.branches = {{1, 2, 7, false, 2, {{{0.1, 0.2}, 0.45}, {{5.0, 6.0}, 0.7}}}};
  return map;
}

inline MapDocument sample_document(std::uint32_t map_count) {
  MapDocument document;
  document.robot_id = "robot-1";
  document.seed = 0xfedcba9876543210ULL;
  for (std::uint32_t id = 0; id < map_count; ++id) {
    document.local_maps.push_back(sample_local_map(id));
    document.trajectory.stops.push_back(sample_stop(id, 0.5 * id));
  }
  document.trajectory.version = 9;
  if (map_count > 2) {
    // Not sorted by ids, because the order of the list must be kept.
    document.loop_closures = {{1, 2, {0.1, 0.2, 0.3}}, {0, 2, {-0.1, 0.0, 3.0}}};
  }
  document.global_map = sample_global_map();
  return document;
}

class ScratchDirectory : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name =
        (std::filesystem::path(::testing::TempDir()) / "topogeo_storage_XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    directory_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  static std::string content(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void write(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
  }

  std::filesystem::path directory_;
};

/// Message of the std::exception from `call`; "" without one.
template <typename Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

}  // namespace topogeo::storage
