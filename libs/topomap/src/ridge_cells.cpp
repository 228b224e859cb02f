#include "ridge_cells.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

namespace topogeo::topomap {
namespace {

constexpr std::array<CellIndex, 8> kAround = {
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

// For each pattern of the eight neighbours: true if removing the cell between them neither splits
// nor joins anything (Yokoi number 1) and the cell is not the end of a curve. Two neighbours that
// touch count as an end too: otherwise a curve two cells wide would be eroded from its end.
std::array<bool, 256> removable_patterns() {
  std::array<bool, 256> removable{};
  for (unsigned p = 0; p < 256; ++p) {
    const auto empty = [p](unsigned k) { return (p >> (k % 8) & 1U) == 0U; };
    int joins = 0;
    for (unsigned k = 0; k < 8; k += 2) {
      if (empty(k) && !(empty(k + 1) && empty(k + 2))) ++joins;
    }
    removable[p] = joins == 1 && std::popcount(p) > 2;
  }
  return removable;
}

// In cells.
std::size_t largest_hole(const GlobalMapConfig& config) {
  return static_cast<std::size_t>(std::floor(config.hole_m2 / (config.cell_m * config.cell_m)));
}

}  // namespace

RidgeCells::RidgeCells(const VoteGrid& grid, const GlobalMapConfig& config) {
  if (grid.chunks().empty()) return;
  lay_out(grid, config);
  collect(grid, config);
  drop_unsupported(config);
  fill_holes(grid, config);
  link_neighbours();
  thin();
}

void RidgeCells::lay_out(const VoteGrid& grid, const GlobalMapConfig& config) {
  // A border as wide as the longest walk of fill_holes makes bounds checks unnecessary.
  const std::int32_t border =
      1 + static_cast<std::int32_t>(largest_hole(config)) / VoteGrid::kChunk;
  std::int32_t high_x = grid.chunks().begin()->first.second;
  low_x_ = high_x;
  for (const auto& [at, chunk] : grid.chunks()) {
    low_x_ = std::min(low_x_, at.second);
    high_x = std::max(high_x, at.second);
  }
  low_x_ -= border;
  low_y_ = grid.chunks().begin()->first.first - border;
  width_ = high_x + 1 + border - low_x_;
  height_ = grid.chunks().rbegin()->first.first + 1 + border - low_y_;
  tile_of_chunk_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_),
                        kNone);
}

std::int32_t* RidgeCells::slot(std::int32_t x, std::int32_t y) {
  const std::int32_t cx = x >> VoteGrid::kChunkBits;
  const std::int32_t cy = y >> VoteGrid::kChunkBits;
  std::int32_t& tile =
      tile_of_chunk_[static_cast<std::size_t>(cy - low_y_) * static_cast<std::size_t>(width_) +
                     static_cast<std::size_t>(cx - low_x_)];
  if (tile == kNone) {
    tile = static_cast<std::int32_t>(tiles_.size());
    tiles_.emplace_back(std::make_unique<Tile>())->fill(kNone);
  }
  return &(*tiles_[static_cast<std::size_t>(tile)])[VoteGrid::cell_in_chunk({x, y})];
}

void RidgeCells::add(const VoteGrid& grid, CellIndex at, std::int32_t& slot_of_cell) {
  slot_of_cell = static_cast<std::int32_t>(cells_.size());
  Cell& added = cells_.emplace_back();
  added.at = at;
  const auto chunk =
      grid.chunks().find({at.y >> VoteGrid::kChunkBits, at.x >> VoteGrid::kChunkBits});
  if (chunk == grid.chunks().end()) return;
  const VoteGrid::Block* const block = chunk->second.find(at);
  if (block == nullptr) return;
  added.votes = block->cells[VoteGrid::cell_in_block(at)];
  added.first_seen = block->first_seen;
}

void RidgeCells::collect(const VoteGrid& grid, const GlobalMapConfig& config) {
  for (const auto& [at, chunk] : grid.chunks()) {
    for (std::int32_t i = 0; i < VoteGrid::kChunk * VoteGrid::kChunk; ++i) {
      const CellIndex cell{at.second * VoteGrid::kChunk + i % VoteGrid::kChunk,
                           at.first * VoteGrid::kChunk + i / VoteGrid::kChunk};
      const VoteGrid::Block* const block = chunk.find(cell);
      if (block == nullptr) continue;
      const VoteCell& votes = block->cells[VoteGrid::cell_in_block(cell)];
      if (votes.views < config.min_observations || votes.share() < config.bridge_share) continue;
      add(grid, cell, *slot(cell.x, cell.y));
    }
  }
}

// Drops connected sets of cells without a cell above the higher threshold (hysteresis).
void RidgeCells::drop_unsupported(const GlobalMapConfig& config) {
  std::vector<std::int32_t> supported;
  std::vector<char> visited(cells_.size(), 0);
  std::vector<std::int32_t> set;
  for (std::size_t seed = 0; seed < cells_.size(); ++seed) {
    if (visited[seed] != 0) continue;
    visited[seed] = 1;
    set.assign(1, static_cast<std::int32_t>(seed));
    bool enough = false;
    for (std::size_t k = 0; k < set.size(); ++k) {
      const Cell& cell = cells_[static_cast<std::size_t>(set[k])];
      enough = enough || cell.votes.share() >= config.keep_share;
      for (const CellIndex& step : kAround) {
        const std::int32_t next = *slot(cell.at.x + step.x, cell.at.y + step.y);
        if (next == kNone || visited[static_cast<std::size_t>(next)] != 0) continue;
        visited[static_cast<std::size_t>(next)] = 1;
        set.push_back(next);
      }
    }
    if (!enough) continue;
    supported.insert(supported.end(), set.begin(), set.end());
  }
  for (const std::unique_ptr<Tile>& tile : tiles_) tile->fill(kNone);
  std::vector<Cell> cells;
  cells.reserve(supported.size() + supported.size() / 8);  // with room for holes
  for (const std::int32_t k : supported) cells.push_back(cells_[static_cast<std::size_t>(k)]);
  cells_ = std::move(cells);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    *slot(cells_[i].at.x, cells_[i].at.y) = static_cast<std::int32_t>(i);
  }
}

void RidgeCells::fill_holes(const VoteGrid& grid, const GlobalMapConfig& config) {
  const std::size_t largest = largest_hole(config);
  constexpr std::int32_t kOutside = -2;
  constexpr std::int32_t kInHole = -3;
  const std::size_t count = cells_.size();
  std::vector<CellIndex> hole;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < 8; k += 2) {
      const CellIndex start{cells_[i].at.x + kAround[k].x, cells_[i].at.y + kAround[k].y};
      if (*slot(start.x, start.y) != kNone) continue;
      hole.assign(1, start);
      *slot(start.x, start.y) = kInHole;
      bool outside = false;
      for (std::size_t h = 0; h < hole.size() && !outside; ++h) {
        for (std::size_t n = 0; n < 8 && !outside; n += 2) {
          const CellIndex next{hole[h].x + kAround[n].x, hole[h].y + kAround[n].y};
          std::int32_t& state = *slot(next.x, next.y);
          outside = state == kOutside || (state == kNone && hole.size() >= largest);
          if (state != kNone || outside) continue;
          state = kInHole;
          hole.push_back(next);
        }
      }
      for (const CellIndex& cell : hole) {
        if (outside) {
          *slot(cell.x, cell.y) = kOutside;
        } else {
          add(grid, cell, *slot(cell.x, cell.y));
        }
      }
    }
  }
}

void RidgeCells::link_neighbours() {
  neighbours_.resize(cells_.size());
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    Cell& cell = cells_[i];
    cell.kept = true;
    for (std::size_t k = 0; k < 8; ++k) {
      const std::int32_t next = *slot(cell.at.x + kAround[k].x, cell.at.y + kAround[k].y);
      neighbours_[i][k] = next >= 0 ? next : kNone;
    }
  }
  tiles_.clear();
  tile_of_chunk_.clear();
}

unsigned RidgeCells::pattern(std::int32_t index) const {
  unsigned p = 0;
  for (unsigned k = 0; k < 8; ++k) {
    const std::int32_t next = neighbours(index)[k];
    if (next != kNone && cells_[static_cast<std::size_t>(next)].kept) p |= 1U << k;
  }
  return p;
}

// Removes cells in the order of rising support if the shape keeps its connections and ends: the
// crests remain.
void RidgeCells::thin() {
  static const std::array<bool, 256> kRemovable = removable_patterns();
  using Entry = std::pair<float, std::int32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  std::vector<char> queued(cells_.size(), 0);
  const auto consider = [&](std::int32_t i) {
    const Cell& cell = cells_[static_cast<std::size_t>(i)];
    char& waiting = queued[static_cast<std::size_t>(i)];
    if (waiting != 0 || !cell.kept || !kRemovable[pattern(i)]) return;
    waiting = 1;
    queue.emplace(cell.votes.support, i);
  };
  for (std::size_t i = 0; i < cells_.size(); ++i) consider(static_cast<std::int32_t>(i));
  while (!queue.empty()) {
    const std::int32_t lowest = queue.top().second;
    queue.pop();
    queued[static_cast<std::size_t>(lowest)] = 0;
    Cell& cell = cells_[static_cast<std::size_t>(lowest)];
    if (!kRemovable[pattern(lowest)]) continue;
    cell.kept = false;
    for (const std::int32_t next : neighbours(lowest)) {
      if (next != kNone) consider(next);
    }
  }
}

std::vector<std::int32_t> RidgeCells::kept_neighbours(std::int32_t index) const {
  std::vector<std::int32_t> kept;
  for (const std::int32_t next : neighbours(index)) {
    if (next != kNone && cells_[static_cast<std::size_t>(next)].kept) kept.push_back(next);
  }
  return kept;
}

}  // namespace topogeo::topomap
