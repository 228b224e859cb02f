// Contents and contradictions of a stored map.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/storage/map_document.hpp"

namespace topogeo::exchange {

struct MapSummary {
  std::string robot_id;
  std::uint64_t seed = 0;
  std::size_t sessions = 0;  ///< drives
  std::size_t stops = 0;
  std::size_t located_stops = 0;
  std::uint64_t views = 0;  ///< represented by the stops: more than stops if places were seen
                            ///< repeatedly
  std::size_t scans = 0;    ///< with a pose, including stops
  std::size_t points = 0;
  std::int64_t first_stamp_ns = 0;  ///< of the stops; 0 without any
  std::int64_t last_stamp_ns = 0;
  double driven_m = 0.0;  ///< along the corrected poses of all scans, without jumps between drives
  bool has_extent = false;
  Eigen::Vector2d low_m = Eigen::Vector2d::Zero();  ///< of everything with a position, map frame
  Eigen::Vector2d high_m = Eigen::Vector2d::Zero();
  std::array<std::size_t, 6> nodes{};  ///< by topomap::NodeKind
  std::size_t branches = 0;
  std::size_t virtual_branches = 0;  ///< included above
  double branches_m = 0.0;           ///< length of the branches that are not virtual
  std::size_t loops = 0;
  std::uint64_t trajectory_version = 0;
  std::uint64_t map_version = 0;  ///< of the trajectory that nodes and branches were made from
  std::size_t places = 0;
  std::size_t zones = 0;
  std::optional<planning::GridFrame> drawn_grid;

  [[nodiscard]] std::size_t node_count() const;
};
MapSummary summarize(const storage::MapDocument& document);

/// Readable text, or JSON with all numbers; `file_bytes` is the size of the file.
std::string summary_text(const MapSummary& summary, std::uint64_t file_bytes);
std::string summary_json(const MapSummary& summary, std::uint64_t file_bytes);

/// One line for each contradiction in a readable map: poses far away, stamps that go back within a
/// drive, invalid covariances, branches that do not begin at their node, loops that end at a stop
/// without a pose. At most `most`.
std::vector<std::string> contradictions(const storage::MapDocument& document,
                                        std::size_t most = 100);

}  // namespace topogeo::exchange
