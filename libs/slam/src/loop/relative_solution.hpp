// One relative pose of two local maps, found by a match.
#pragma once

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::localization {

struct RelativeSolution {
  geometry::Pose2 T_earlier_later;
  Eigen::Matrix3d covariance =
      Eigen::Matrix3d::Identity();  ///< of (x, y, theta) in the frame of the earlier map; m, rad
  double fitness = 0.0;             ///< [0, 1]
};

}  // namespace topogeo::localization
