// Answers goals with routes on the live map, and again when the map changes.
#pragma once

#include <cstdint>
#include <optional>

#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/map_update.h"
#include "topogeo/msg/planning.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/planning/route_planner.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/map_mirror.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/topomap/global_map.hpp"

namespace topogeo::planner {

/// The answer to a goal, without header. `map` and `pose` are empty while there is none.
msg::Route answer(const msg::Goal& goal, const std::optional<topomap::GlobalMap>& map,
                  const std::optional<service::LivePose>& pose,
                  const planning::PlanningConfig& config);

/// Lives in the loop of its service.
class PlannerService {
 public:
  explicit PlannerService(service::Service& service);

 private:
  void on_element(const msg::MapElement& message, const messaging::SampleInfo& info);
  void on_pose(const msg::LivePose& message);
  void on_goal(const msg::Goal& message);
  /// Takes the mirrored map over, if it is whole and has changed, and plans again.
  void take_map();
  void plan();

  service::Service& service_;
  service::MapMirror mirror_;
  bool map_changed_ = false;
  std::optional<topomap::GlobalMap> map_;
  std::optional<service::LivePose> pose_;
  std::optional<msg::Goal> goal_;  // active
  std::uint64_t sent_ = 0;
  bool waits_for_pose_ = false;

  messaging::Reader<msg::MapElement> elements_;
  messaging::Reader<msg::LivePose> poses_;
  messaging::Reader<msg::Goal> goals_;
  messaging::Writer<msg::Route> routes_;
};

}  // namespace topogeo::planner
