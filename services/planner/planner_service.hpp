// Answers goals with routes on the live map, its grid and zones or its nodes and branches; answers
// again when the map or the blockages change, or when the pose becomes known. Plans for the goal
// that the navigator has (GoalChoice).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/planning.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/live_graph.hpp"
#include "topogeo/service/live_hybrid_map.hpp"
#include "topogeo/service/service.hpp"

#include "goal_choice.hpp"

namespace topogeo::planner {

/// Lives in the loop of its service.
class PlannerService {
 public:
  explicit PlannerService(service::Service& service);

 private:
  void on_pose(const msg::LivePose& message);
  void on_goal(const msg::Goal& message);
  /// Plans for a goal that has just become the chosen one.
  void begin();
  void on_blockages(const msg::Blockages& message);
  /// Takes changed complete maps from the mirrors and plans again.
  void take_maps();
  bool take_map();
  bool take_graph();
  void note_what_is_missing();
  /// Plans for the current goal, if there is one, and sends the answer.
  void plan();
  /// Completes the answer to a goal and sends it; false when the program must end first.
  bool send(const msg::Goal& goal, msg::Route& route);

  service::Service& service_;
  std::shared_ptr<const planning::HybridMap> map_;
  std::uint64_t map_version_ = 0;
  std::shared_ptr<const topomap::GlobalMap> graph_;
  std::optional<service::LivePose> pose_;
  navigation::BlockageReport blockages_;
  bool on_branches_ = false;  // the last answer
  GoalChoice goal_;
  std::optional<geometry::Pose2> refused_at_;  // place of the last refusal
  std::uint64_t sent_ = 0;

  service::LiveHybridMap live_map_;
  service::LiveGraph live_graph_;
  messaging::Writer<msg::Route> routes_;
};

}  // namespace topogeo::planner
