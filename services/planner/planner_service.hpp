// Answers goals with routes on the live hybrid map, and again when the map, the blockages, or
// whether the pose is known has changed.
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
#include "topogeo/service/live_hybrid_map.hpp"
#include "topogeo/service/service.hpp"

namespace topogeo::planner {

/// Lives in the loop of its service.
class PlannerService {
 public:
  explicit PlannerService(service::Service& service);

 private:
  void on_pose(const msg::LivePose& message);
  void on_goal(const msg::Goal& message);
  void on_blockages(const msg::Blockages& message);
  /// Takes the mirrored map over, if it is whole and has changed, and plans again.
  void take_map();
  void note_what_is_missing();
  /// Plans for the goal at hand, if there is one, and sends the answer.
  void plan();

  service::Service& service_;
  std::shared_ptr<const planning::HybridMap> map_;
  std::uint64_t map_version_ = 0;
  std::optional<service::LivePose> pose_;
  navigation::BlockageReport blockages_;
  std::optional<msg::Goal> goal_;              // active
  std::optional<geometry::Pose2> refused_at_;  // where the last answer was a refusal
  std::uint64_t sent_ = 0;

  service::LiveHybridMap live_map_;
  messaging::Writer<msg::Route> routes_;
};

}  // namespace topogeo::planner
