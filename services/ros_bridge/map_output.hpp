// Publishes the map: occupancy grid with its updates, graph, names of rooms.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/service/live_graph.hpp"

#include "grid_mirror.hpp"
#include "ros_side.hpp"

namespace topogeo::ros_bridge {

/// Lives in the loop of its service.
class MapOutput {
 public:
  explicit MapOutput(RosSide& ros);
  MapOutput(const MapOutput&) = delete;
  MapOutput& operator=(const MapOutput&) = delete;
  ~MapOutput();

 private:
  void tick();
  void publish_grid();
  void publish_whole();
  void publish_graph();

  RosSide& ros_;
  GridMirror mirror_;
  std::optional<messaging::Writer<ros::OccupancyGrid>> grids_;
  std::optional<messaging::Writer<ros::OccupancyGridUpdate>> updates_;
  std::optional<messaging::Writer<ros::MarkerArray>> graphs_;
  std::optional<messaging::Writer<ros::MarkerArray>> rooms_;
  std::optional<service::LiveGraph> live_graph_;
  std::shared_ptr<const topomap::GlobalMap> graph_;
  int readers_ = 0;            // of the grid
  bool whole_is_old_ = false;  // the last whole grid lacks later updates
  std::int64_t whole_ns_ = 0;  // steady clock: when the last whole grid was sent
  std::uint64_t timer_ = 0;
};

}  // namespace topogeo::ros_bridge
