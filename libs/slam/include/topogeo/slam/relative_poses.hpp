// Poses of some stops relative to one of them: as many as a search along the graph reached.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "topogeo/matching/odometry_model.hpp"

namespace topogeo::localization {

class RelativePoses {
 public:
  struct Stop {
    std::uint32_t id = 0;
    UncertainPose T_origin_stop;
  };

  RelativePoses() = default;
  /// `stops`: ascending ids.
  explicit RelativePoses(std::vector<Stop> stops) : stops_(std::move(stops)) {}

  [[nodiscard]] std::span<const Stop> stops() const { return stops_; }
  /// Null for a stop that was not reached.
  [[nodiscard]] const UncertainPose* find(std::uint32_t id) const {
    const auto found =
        std::lower_bound(stops_.begin(), stops_.end(), id,
                         [](const Stop& stop, std::uint32_t wanted) { return stop.id < wanted; });
    return found != stops_.end() && found->id == id ? &found->T_origin_stop : nullptr;
  }
  /// Throws std::out_of_range for a stop that was not reached.
  [[nodiscard]] const UncertainPose& at(std::uint32_t id) const;

  /// Poses of the stops 0 to count - 1; one that was not reached is a thousand kilometres away.
  [[nodiscard]] std::vector<UncertainPose> by_id(std::size_t count) const;

  /// Adds to every covariance.
  void widen(const Eigen::Matrix3d& covariance) {
    for (Stop& stop : stops_) stop.T_origin_stop.covariance += covariance;
  }

 private:
  std::vector<Stop> stops_;
};

}  // namespace topogeo::localization
