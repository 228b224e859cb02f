// Finds the parts of the hybrid map to send so that readers have the newest state.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/msg/hybrid_map.h"
#include "topogeo/planning/hybrid_map.hpp"

namespace topogeo::map_store {

/// Remembers the parts sent of one robot's hybrid map.
class HybridUpdates {
 public:
  /// All versions will be larger than `version`.
  HybridUpdates(std::string robot_id, std::uint64_t version)
      : robot_id_(std::move(robot_id)), version_(version) {}

  struct Update {
    std::vector<msg::GridTile> gone;        ///< to be disposed
    std::vector<msg::GridTile> changed;     ///< to be written, before the summary
    std::optional<msg::HybridMap> summary;  ///< nothing: the map is as it was sent

    [[nodiscard]] bool empty() const { return gone.empty() && !summary; }
  };
  /// Unchanged tiles are left out. Every update has its own version, so that a tile of a partly
  /// sent update cannot be mistaken for one of the next. `stamp_ns` is that of the last stop in the
  /// map. Report each part with sent() or disposed(). Throws std::invalid_argument like
  /// service::to_messages.
  Update update_to(const planning::HybridMap& map, std::int64_t stamp_ns);

  void sent(const msg::GridTile& tile);
  void sent(const msg::HybridMap& summary);
  void disposed(const msg::GridTile& tile) { sent_.erase(tile.tile()); }
  /// Version of the last summary sent; 0 before the first.
  [[nodiscard]] std::uint64_t sent_version() const {
    return sent_summary_ ? sent_summary_->version() : 0;
  }
  /// Tiles sent so far.
  [[nodiscard]] std::uint64_t count() const { return count_; }

 private:
  std::string robot_id_;
  std::uint64_t version_;
  struct SentTile {
    std::uint64_t version = 0;
    std::uint64_t content = 0;  // hash of its cells: those of a large map take ten megabytes
  };
  std::map<std::uint32_t, SentTile> sent_;
  std::optional<msg::HybridMap> sent_summary_;
  std::uint64_t count_ = 0;
  std::uint64_t summaries_ = 0;
};

}  // namespace topogeo::map_store
