// Transforms between the frames of a robot, as /tf and /tf_static state them, without their times:
// for what is fixed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "topogeo/recording/ros_types.hpp"

namespace topogeo::recording {

class TransformTree {
 public:
  struct Edge {
    std::string parent;
    std::string child;
    Eigen::Isometry3d T_parent_child = Eigen::Isometry3d::Identity();
    bool is_static = false;
    std::uint64_t count = 0;  ///< how often it was stated
  };

  /// Of a static transform the last one holds, of another the first. Transforms that are not finite
  /// are passed over.
  void add(const ros::TfMessage& message, bool is_static);

  /// Takes coordinates of `to` into those of `from`, over as few edges as possible, static ones
  /// alone where these suffice; empty where no edges connect the two.
  [[nodiscard]] std::optional<Eigen::Isometry3d> find(const std::string& from,
                                                      const std::string& to) const;

  [[nodiscard]] const std::vector<Edge>& edges() const { return edges_; }

 private:
  [[nodiscard]] std::optional<Eigen::Isometry3d> find(const std::string& from,
                                                      const std::string& to,
                                                      bool static_only) const;

  std::vector<Edge> edges_;
};

}  // namespace topogeo::recording
