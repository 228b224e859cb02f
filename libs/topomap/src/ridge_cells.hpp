// The set of cells on branches, thinned to curves one cell wide.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "topogeo/topomap/global_map_builder.hpp"

#include "vote_grid.hpp"

namespace topogeo::topomap {

class RidgeCells {
 public:
  static constexpr std::int32_t kNone = -1;

  struct Cell {
    CellIndex at;
    VoteCell votes;
    std::uint32_t first_seen = 0;
    bool kept = false;  ///< on the thinned ridge
  };
  /// Indices of cells: 0 east, then counter-clockwise to 7 south-east; kNone if the neighbour is
  /// not in the set.
  using Neighbours = std::array<std::int32_t, 8>;

  /// Collects cells above the thresholds of `config`, fills small holes and thins them.
  RidgeCells(const VoteGrid& grid, const GlobalMapConfig& config);

  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }
  [[nodiscard]] const Neighbours& neighbours(std::int32_t index) const {
    return neighbours_[static_cast<std::size_t>(index)];
  }

  /// Kept neighbours of a kept cell, in the order of Neighbours.
  [[nodiscard]] std::vector<std::int32_t> kept_neighbours(std::int32_t index) const;

 private:
  using Tile =
      std::array<std::int32_t, static_cast<std::size_t>(VoteGrid::kChunk* VoteGrid::kChunk)>;

  void lay_out(const VoteGrid& grid, const GlobalMapConfig& config);
  void collect(const VoteGrid& grid, const GlobalMapConfig& config);
  void drop_unsupported(const GlobalMapConfig& config);
  void fill_holes(const VoteGrid& grid, const GlobalMapConfig& config);
  void link_neighbours();
  void thin();
  [[nodiscard]] unsigned pattern(std::int32_t index) const;
  [[nodiscard]] std::int32_t* slot(std::int32_t x, std::int32_t y);
  void add(const VoteGrid& grid, CellIndex at, std::int32_t& slot);

  std::vector<Cell> cells_;
  std::vector<Neighbours> neighbours_;        // of cells_
  std::vector<std::unique_ptr<Tile>> tiles_;  // until neighbours_ is filled
  std::vector<std::int32_t> tile_of_chunk_;   // over the bounding box of the chunks, kNone: no tile
  std::int32_t low_x_ = 0;                    // of that box, chunks
  std::int32_t low_y_ = 0;
  std::int32_t width_ = 0;
  std::int32_t height_ = 0;
};

}  // namespace topogeo::topomap
