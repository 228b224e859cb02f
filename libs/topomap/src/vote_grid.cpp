#include "vote_grid.hpp"

#include <algorithm>
#include <cmath>

namespace topogeo::topomap {
namespace {

std::int32_t to_cell(double coordinate_m, double cell_m) {
  return static_cast<std::int32_t>(std::floor(coordinate_m / cell_m));
}

}  // namespace

void VoteGrid::add(const LocalMap& map, const geometry::Pose2& T_map_robot, const SeenRegion& view,
                   const Sighting& sighting) {
  const ViewWindow window = draw(map, T_map_robot, view);
  vote_for(window, sighting);
  vote_against(window, inverse(T_map_robot), view);
}

VoteGrid::ViewWindow VoteGrid::draw(const LocalMap& map, const geometry::Pose2& T_map_robot,
                                    const SeenRegion& view) const {
  // The window covers everything that the view could see: its scan points and its branches.
  Eigen::Vector2d low = T_map_robot.position_m();
  Eigen::Vector2d high = low;
  const auto extend = [&](const Eigen::Vector2d& point_robot_m) {
    const Eigen::Vector2d p = T_map_robot * point_robot_m;
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  };
  for (const ScanPoint& p : map.points) extend({p.x_m, p.y_m});
  for (const LocalBranch& b : map.branches) {
    for (const BranchPoint& p : b.points) extend(p.position_m);
  }
  const double margin = 2.0 * config_.vote_radius_m;
  ViewWindow window;
  window.low = {to_cell(low.x() - margin, config_.cell_m),
                to_cell(low.y() - margin, config_.cell_m)};
  window.width = to_cell(high.x() + margin, config_.cell_m) - window.low.x + 1;
  window.height = to_cell(high.y() + margin, config_.cell_m) - window.low.y + 1;
  window.cells.resize(static_cast<std::size_t>(window.width) *
                      static_cast<std::size_t>(window.height));
  for (const LocalBranch& b : map.branches) draw_branch(b, T_map_robot, view, window);
  return window;
}

void VoteGrid::draw_branch(const LocalBranch& branch, const geometry::Pose2& T_map_robot,
                           const SeenRegion& view, ViewWindow& window) const {
  const bool votes = branch.in_main_graph && !branch.is_virtual;
  const double step = 0.5 * config_.cell_m;
  for (std::size_t i = 0; i < branch.points.size(); ++i) {
    const BranchPoint& b = branch.points[i];
    const BranchPoint& a = branch.points[i == 0 ? 0 : i - 1];
    const bool certain =
        votes && view.certain(b.position_m, std::max(0.0, b.clearance_m - config_.cell_m));
    const Eigen::Vector2d a_map = T_map_robot * a.position_m;
    const Eigen::Vector2d b_map = T_map_robot * b.position_m;
    const int pieces = std::max(1, static_cast<int>(std::ceil((b_map - a_map).norm() / step)));
    for (int k = 1; k <= pieces; ++k) {
      const double t = static_cast<double>(k) / pieces;
      draw_point({a_map + t * (b_map - a_map), a.clearance_m + t * (b.clearance_m - a.clearance_m)},
                 certain, votes, window);
    }
  }
}

void VoteGrid::draw_point(const BranchPoint& point_map, bool certain, bool votes,
                          ViewWindow& window) const {
  // Cells just beyond the reach of the vote are neutral: the branch may only be shifted.
  const double reach = 1.5 * config_.vote_radius_m;
  const auto n = static_cast<std::int32_t>(std::ceil(reach / config_.cell_m));
  const std::int32_t cx = to_cell(point_map.position_m.x(), config_.cell_m);
  const std::int32_t cy = to_cell(point_map.position_m.y(), config_.cell_m);
  for (std::int32_t y = cy - n; y <= cy + n; ++y) {
    const double dy = (y + 0.5) * config_.cell_m - point_map.position_m.y();
    for (std::int32_t x = cx - n; x <= cx + n; ++x) {
      const double dx = (x + 0.5) * config_.cell_m - point_map.position_m.x();
      const auto d2 = static_cast<float>(dx * dx + dy * dy);
      if (d2 > static_cast<float>(reach * reach)) continue;
      ViewCell& c = window.cells[static_cast<std::size_t>(y - window.low.y) *
                                     static_cast<std::size_t>(window.width) +
                                 static_cast<std::size_t>(x - window.low.x)];
      c.neutral = true;
      if (votes && d2 < c.distance2_m2) {
        c.distance2_m2 = d2;
        c.clearance_m = static_cast<float>(point_map.clearance_m);
        c.certain = certain;
      }
    }
  }
}

void VoteGrid::vote_for(const ViewWindow& window, const Sighting& sighting) {
  const auto radius2 = static_cast<float>(config_.vote_radius_m * config_.vote_radius_m);
  std::size_t index = 0;
  for (std::int32_t y = 0; y < window.height; ++y) {
    for (std::int32_t x = 0; x < window.width; ++x, ++index) {
      const ViewCell& seen = window.cells[index];
      if (seen.distance2_m2 >= radius2) continue;
      const float weight = seen.certain ? 1.0F : static_cast<float>(config_.uncertain_weight);
      if (weight <= 0.0F) continue;
      VoteCell& c = cell({window.low.x + x, window.low.y + y});
      const float falloff = 1.0F - seen.distance2_m2 / radius2;
      const float vote = weight * falloff * falloff;
      c.support += vote;
      c.for_views += weight;
      c.clearance_weight += vote;
      c.clearance_m += (seen.clearance_m - c.clearance_m) * vote / c.clearance_weight;
      c.views += sighting.views;
      c.last_seen_ns = std::max(c.last_seen_ns, sighting.last_ns);
      fade(c);
    }
  }
}

void VoteGrid::vote_against(const ViewWindow& window, const geometry::Pose2& T_robot_map,
                            const SeenRegion& view) {
  const std::int32_t chunk_y0 = window.low.y >> kChunkBits;
  const std::int32_t chunk_y1 = (window.low.y + window.height - 1) >> kChunkBits;
  const std::int32_t chunk_x0 = window.low.x >> kChunkBits;
  const std::int32_t chunk_x1 = (window.low.x + window.width - 1) >> kChunkBits;
  for (std::int32_t cy = chunk_y0; cy <= chunk_y1; ++cy) {
    for (std::int32_t cx = chunk_x0; cx <= chunk_x1; ++cx) {
      const auto found = chunks_.find({cy, cx});
      if (found == chunks_.end()) continue;
      for (std::int32_t i = 0; i < kChunk * kChunk; ++i) {
        const CellIndex at{cx * kChunk + i % kChunk, cy * kChunk + i / kChunk};
        Block* const block = found->second.find(at);
        if (block == nullptr) {
          i += kBlock - 1;  // its other cells of this row
          continue;
        }
        VoteCell& c = block->cells[cell_in_block(at)];
        if (c.views == 0) continue;
        const std::int32_t wx = at.x - window.low.x;
        const std::int32_t wy = at.y - window.low.y;
        if (wx < 0 || wy < 0 || wx >= window.width || wy >= window.height) continue;
        if (window
                .cells[static_cast<std::size_t>(wy) * static_cast<std::size_t>(window.width) +
                       static_cast<std::size_t>(wx)]
                .neutral) {
          continue;
        }
        const Eigen::Vector2d centre((at.x + 0.5) * config_.cell_m, (at.y + 0.5) * config_.cell_m);
        if (!view.certain(T_robot_map * centre, static_cast<double>(c.clearance_m))) continue;
        c.against += 1.0F;
        fade(c);
      }
    }
  }
}

VoteCell& VoteGrid::cell(CellIndex at) {
  Block& block = chunks_[{at.y >> kChunkBits, at.x >> kChunkBits}].block(at);
  if (block.first_seen == 0) block.first_seen = ++blocks_seen_;
  return block.cells[cell_in_block(at)];
}

VoteGrid::Block& VoteGrid::Chunk::block(CellIndex at) {
  std::uint8_t& slot = slots_[block_in_chunk(at)];
  if (slot == 0) {
    blocks_.emplace_back();
    slot = static_cast<std::uint8_t>(blocks_.size());
  }
  return blocks_[slot - 1U];
}

void VoteGrid::fade(VoteCell& c) const {
  const auto limit = static_cast<float>(config_.memory_views);
  const float all = c.for_views + c.against;
  if (all <= limit) return;
  const float keep = limit / all;
  c.support *= keep;
  c.for_views *= keep;
  c.against *= keep;
  c.clearance_weight *= keep;
}

}  // namespace topogeo::topomap
