// Local maps of a small room and tasks on them, for the parts of a worker.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/search_pool/match_job.hpp"

namespace topogeo::search_pool {

/// The robot in a room of 6 m by 4 m with a pillar, `shift_m` to the right of its middle.
inline MapPointer room(std::uint32_t id, double shift_m, const std::string& robot_id = "robot") {
  topomap::LocalMap map;
  map.robot_id = robot_id;
  map.id = id;
  for (int i = 0; i < 180; ++i) {
    const auto direction =
        geometry::sincos(std::numbers::pi * (static_cast<double>(i) / 180.0 - 0.5));
    const double to_front_m = (3.0 - shift_m) / direction.cos;
    const double to_side_m = 2.0 / std::max(1e-9, std::abs(direction.sin));
    const double range_m = i > 80 && i < 95 ? 1.5 - shift_m : std::min(to_front_m, to_side_m);
    map.points.push_back(
        {static_cast<float>(range_m * direction.cos), static_cast<float>(range_m * direction.sin)});
  }
  return std::make_shared<const topomap::LocalMap>(std::move(map));
}

inline localization::MatchTask task(const topomap::LocalMap& reference,
                                    const topomap::LocalMap& query, std::uint64_t id) {
  localization::MatchTask result;
  result.task_id = id;
  result.reference_map_id = reference.id;
  result.query_map_id = query.id;
  result.reference_hash = topomap::content_hash(reference);
  result.query_hash = topomap::content_hash(query);
  result.T_reference_query = {0.1, 0.0, 0.0};
  result.covariance = Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal();
  result.half_width = Eigen::Vector3d(0.5, 0.5, 0.3);
  result.seed = id + 1;
  return result;
}

/// The ticket is the id of the task.
inline MatchJob job(const MapPointer& reference, const MapPointer& query, std::uint64_t id,
                    const std::string& client_id = "client") {
  return {id, client_id, "robot", 0, task(*reference, *query, id)};
}

inline ReadyJob ready_job(const MapPointer& reference, const MapPointer& query, std::uint64_t id,
                          const std::string& client_id = "client") {
  return {job(reference, query, id, client_id), reference, query};
}

inline bool same(const localization::MatchSolution& a, const localization::MatchSolution& b) {
  return a.T_reference_query == b.T_reference_query && a.fitness == b.fitness;
}

/// The same to the last bit.
inline bool same(const localization::MatchResult& a, const localization::MatchResult& b) {
  const auto solutions_are = [](const auto& x, const auto& y) { return same(x, y); };
  return a.task_id == b.task_id && a.status == b.status && a.seed == b.seed &&
         a.evaluations == b.evaluations && a.verdict == b.verdict && a.reason == b.reason &&
         a.T_reference_query == b.T_reference_query && a.covariance == b.covariance &&
         a.fitness == b.fitness && a.overlap == b.overlap && a.inliers == b.inliers &&
         a.violations == b.violations && a.residual_rms_m == b.residual_rms_m &&
         same(a.second, b.second) &&
         std::equal(a.solutions.begin(), a.solutions.end(), b.solutions.begin(), b.solutions.end(),
                    solutions_are);
}

}  // namespace topogeo::search_pool
