// What has come of a robot's map so far, in whatever order it comes.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/msg/stream.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/service/trajectory_assembly.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::map_store {

class MapInput {
 public:
  enum class Arrival : std::uint8_t {
    kNew,
    kKnown,     ///< the same map came before
    kDifferent  ///< another map came before under this id; that one stays
  };
  Arrival add(topomap::LocalMap map);

  /// Older segments and closures than those held are passed over. They throw std::invalid_argument
  /// like service::from_msg.
  void add(const msg::TrajectorySegment& message);
  void add(const msg::LoopClosures& message);
  /// The end of the localizer's stream; the last one counts.
  void set_end(const msg::StreamEnd& message) { end_ = message; }

  /// Local maps without gaps from id 0.
  [[nodiscard]] const std::vector<topomap::LocalMap>& local_maps() const { return local_maps_; }
  /// Maps that wait for one before them.
  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }
  /// The newest trajectory, as far as it can be used: stops without gaps whose maps are here.
  [[nodiscard]] topomap::Trajectory newest_trajectory() const;
  /// The newest closures between stops whose maps are here.
  [[nodiscard]] std::vector<topomap::LoopClosure> usable_closures() const;
  [[nodiscard]] std::uint64_t version() const { return trajectory_.version(); }

  /// The final trajectory, when everything that the end of the stream names is here: all maps, all
  /// segments and the closures of the final version.
  [[nodiscard]] std::optional<topomap::Trajectory> final_trajectory() const;

 private:
  std::vector<topomap::LocalMap> local_maps_;
  std::map<std::uint32_t, topomap::LocalMap> waiting_;
  service::TrajectoryAssembly trajectory_;
  std::vector<topomap::LoopClosure> closures_;
  std::optional<std::uint64_t> closures_version_;
  std::optional<msg::StreamEnd> end_;
};

}  // namespace topogeo::map_store
