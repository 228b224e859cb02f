// Sparse grid over the map frame in which each view votes for and against branches.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/topomap/global_map_builder.hpp"

#include "seen_region.hpp"

namespace topogeo::topomap {

/// Index of a cell: its centre is (index + 0.5) * cell side.
struct CellIndex {
  std::int32_t x = 0;
  std::int32_t y = 0;
};

struct VoteCell {
  float support = 0.0F;      ///< sum of votes, each falling with the distance from the branch
  float for_views = 0.0F;    ///< weight of the views with a branch near by
  float against = 0.0F;      ///< weight of the views that saw the place without a branch
  float clearance_m = 0.0F;  ///< mean of the branches near by
  float clearance_weight = 0.0F;
  std::uint32_t views = 0;        ///< views with a branch near by; never fades
  std::int64_t last_seen_ns = 0;  ///< stamp of the last of them

  [[nodiscard]] double share() const {
    const float all = for_views + against;
    return all > 0.0F ? static_cast<double>(support / all) : 0.0;
  }
};

class VoteGrid {
 public:
  static constexpr std::int32_t kChunkBits = 5;
  static constexpr std::int32_t kChunk = 1 << kChunkBits;  ///< cells
  static constexpr std::int32_t kBlock = 4;                ///< cells

  /// 4 x 4 cells. Branches are thin, so most blocks of a chunk have no votes and do not exist.
  struct Block {
    std::array<VoteCell, static_cast<std::size_t>(kBlock* kBlock)> cells{};
    /// Order of the first votes, from 1; names places that have no better name.
    std::uint32_t first_seen = 0;
  };
  class Chunk {
   public:
    /// The block of a cell; null if it has no votes.
    [[nodiscard]] const Block* find(CellIndex at) const {
      const std::uint8_t slot = slots_[block_in_chunk(at)];
      return slot == 0 ? nullptr : &blocks_[slot - 1U];
    }
    Block* find(CellIndex at) { return const_cast<Block*>(std::as_const(*this).find(at)); }
    /// Like find(), but creates the block if needed.
    Block& block(CellIndex at);

   private:
    static constexpr std::size_t kBlocks =
        static_cast<std::size_t>(kChunk / kBlock) * static_cast<std::size_t>(kChunk / kBlock);
    std::array<std::uint8_t, kBlocks> slots_{};  // index in blocks_ + 1
    std::vector<Block> blocks_;
  };
  /// Index of a cell in its chunk, row by row, and in Block::cells.
  static std::size_t cell_in_chunk(CellIndex at) {
    return static_cast<std::size_t>(at.y & (kChunk - 1)) * kChunk +
           static_cast<std::size_t>(at.x & (kChunk - 1));
  }
  static std::size_t cell_in_block(CellIndex at) {
    return static_cast<std::size_t>(at.y & (kBlock - 1)) * kBlock +
           static_cast<std::size_t>(at.x & (kBlock - 1));
  }
  static std::size_t block_in_chunk(CellIndex at) {
    return static_cast<std::size_t>(at.y & (kChunk - 1)) / kBlock * (kChunk / kBlock) +
           static_cast<std::size_t>(at.x & (kChunk - 1)) / kBlock;
  }

  using Chunks = std::map<std::pair<std::int32_t, std::int32_t>, Chunk>;

  explicit VoteGrid(const GlobalMapConfig& config) : config_(config) {}

  /// Adds the votes of one view.
  void add(const LocalMap& map, const geometry::Pose2& T_map_robot, const SeenRegion& view,
           const Sighting& sighting);

  [[nodiscard]] const Chunks& chunks() const { return chunks_; }

 private:
  struct ViewCell {
    float distance2_m2 = 1e9F;  // to the nearest branch point of the main graph
    float clearance_m = 0.0F;   // of that point
    bool certain = false;       // of that point
    bool neutral = false;       // a non-voting element passes near by
  };
  struct ViewWindow {
    CellIndex low;
    std::int32_t width = 0;
    std::int32_t height = 0;
    std::vector<ViewCell> cells;
  };

  [[nodiscard]] ViewWindow draw(const LocalMap& map, const geometry::Pose2& T_map_robot,
                                const SeenRegion& view) const;
  void draw_branch(const LocalBranch& branch, const geometry::Pose2& T_map_robot,
                   const SeenRegion& view, ViewWindow& window) const;
  void draw_point(const BranchPoint& point_map, bool certain, bool votes, ViewWindow& window) const;
  void vote_for(const ViewWindow& window, const Sighting& sighting);
  void vote_against(const ViewWindow& window, const geometry::Pose2& T_robot_map,
                    const SeenRegion& view);
  VoteCell& cell(CellIndex at);
  void fade(VoteCell& cell) const;

  GlobalMapConfig config_;
  Chunks chunks_;
  std::uint32_t blocks_seen_ = 0;
};

}  // namespace topogeo::topomap
