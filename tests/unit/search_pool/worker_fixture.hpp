// Local maps of a small room and tasks on them, for the parts of a worker.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/matching/place_field.hpp"
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

/// The id of the task serves as its ticket.
inline MatchJob job(const MapPointer& reference, const MapPointer& query, std::uint64_t id,
                    const std::string& client_id = "client") {
  return {id, client_id, "robot", 0, task(*reference, *query, id)};
}

inline ReadyJob ready_job(const MapPointer& reference, const MapPointer& query, std::uint64_t id,
                          const std::string& client_id = "client") {
  return {job(reference, query, id, client_id), reference, query, {}};
}

/// A whole map of one square room and a row of free cells in its middle, which is sent in two
/// pieces.
inline std::shared_ptr<const localization::PlaceField> place_field(double margin_m = 2.0) {
  std::vector<topomap::ScanPoint> walls;
  for (int i = 0; i < 60; ++i) {
    const float t = 0.05F * static_cast<float>(i);
    walls.insert(walls.end(), {{t, 0.0F}, {t, 3.0F}, {0.0F, t}, {3.0F, t}});
  }
  auto field = std::make_shared<localization::PlaceField>(walls, margin_m);
  const auto columns = static_cast<std::size_t>(field->grid().columns());
  std::vector<std::uint8_t> free(columns * static_cast<std::size_t>(field->grid().rows()), 0);
  const auto row = static_cast<std::size_t>(field->grid().row(1.5));
  const auto first = static_cast<std::size_t>(field->grid().column(1.2));
  for (std::size_t i = 0; i < 3; ++i) free[row * columns + first + i] = 1;
  field->set_free(free);
  return field;
}

/// A part of a search in it.
inline MatchJob place_job(const localization::PlaceField& field, std::uint64_t id,
                          const std::string& client_id = "client") {
  MatchJob result{id, client_id, "robot", 0, {}};
  result.task.task_id = id;
  const std::vector<Eigen::Vector2d> seen{{0.2, -1.4}, {-0.2, -1.4}};
  result.task.places = field.questions(seen).front();
  return result;
}

inline bool same(const localization::MatchSolution& a, const localization::MatchSolution& b) {
  return a.T_reference_query == b.T_reference_query && a.fitness == b.fitness;
}

/// Equal to the last bit.
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
