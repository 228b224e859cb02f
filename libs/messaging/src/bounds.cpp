#include "bounds.hpp"

#include <cstddef>

namespace topogeo::messaging {

namespace {

/// The first defect that the checks of one message find.
class Check {
 public:
  template <class Message>
  explicit Check(const Message& message) {
    if (message.schema_version() != msg::kSchemaVersion) {
      defect_ = "schema_version " + std::to_string(message.schema_version()) + ", allowed is " +
                std::to_string(msg::kSchemaVersion);
    }
  }

  Check& size(const char* field, std::size_t size, std::size_t bound) {
    if (!defect_ && size > bound) {
      defect_ = std::string(field) + " has " + std::to_string(size) + " entries, allowed are " +
                std::to_string(bound);
    }
    return *this;
  }

  /// An enumeration that a peer may have filled with any number.
  Check& value(const char* field, std::uint32_t value, std::uint32_t last) {
    if (!defect_ && value > last) {
      defect_ = std::string(field) + " is " + std::to_string(value) + ", allowed is 0 to " +
                std::to_string(last);
    }
    return *this;
  }

  [[nodiscard]] const Defect& defect() const { return defect_; }

 private:
  Defect defect_;
};

}  // namespace

Defect find_defect(const msg::Scan& message) {
  return Check(message).size("ranges_m", message.ranges_m().size(), msg::kMaxBeams).defect();
}

Defect find_defect(const msg::Odometry& message) {
  return Check(message).defect();
}

Defect find_defect(const msg::Sonar& message) {
  return Check(message).size("echoes", message.echoes().size(), msg::kMaxSonars).defect();
}

Defect find_defect(const msg::BaseStatus& message) {
  return Check(message).value("state", message.state(), msg::kBaseMotorsOff).defect();
}

Defect find_defect(const msg::LaserStatus& message) {
  return Check(message)
      .size("drops", message.drops().size(), msg::kMaxFaultKinds)
      .value("state", message.state(), msg::kLaserFault)
      .defect();
}

Defect find_defect(const msg::StreamEnd& message) {
  return Check(message).defect();
}

Defect find_defect(const msg::LocalMap& message) {
  Check check(message);
  check.size("nodes", message.nodes().size(), msg::kMaxLocalNodes)
      .size("branches", message.branches().size(), msg::kMaxLocalBranches)
      .size("points", message.points().size(), msg::kMaxScanPoints)
      .size("track", message.track().size(), msg::kMaxTrackedScans);
  for (const msg::LocalNode& node : message.nodes()) {
    check.size("nodes.base_groups", node.base_groups().size(), msg::kMaxBaseGroups)
        .value("nodes.kind", node.kind(), msg::kNodeHallCorridor);
  }
  for (const msg::LocalBranch& branch : message.branches()) {
    check.size("branches.points", branch.points().size(), msg::kMaxBranchPoints);
  }
  return check.defect();
}

Defect find_defect(const msg::TrackedPose& message) {
  return Check(message).defect();
}

Defect find_defect(const msg::MatchTask& message) {
  return Check(message)
      .size("initial_individuals", message.initial_individuals().size(),
            msg::kMaxInitialIndividuals)
      .value("fitness_form", message.fitness_form(), msg::kFitnessCombined)
      .defect();
}

Defect find_defect(const msg::MatchResult& message) {
  return Check(message)
      .size("solutions", message.solutions().size(), msg::kMaxSolutions)
      .value("status", message.status(), msg::kMatchFailed)
      .value("verdict", message.verdict(), msg::kVerdictRejected)
      .value("reason", message.reason(), msg::kReasonSecondSolution)
      .defect();
}

Defect find_defect(const msg::MapRequest& message) {
  return Check(message).defect();
}

Defect find_defect(const msg::MapCopy& message) {
  const Defect of_copy = Check(message).defect();
  return of_copy ? of_copy : find_defect(message.local_map());
}

Defect find_defect(const msg::WorkerStatus& message) {
  return Check(message).defect();
}

Defect find_defect(const msg::ServiceStatus& message) {
  return Check(message)
      .size("counters", message.counters().size(), msg::kMaxCounters)
      .size("faults", message.faults().size(), msg::kMaxFaultKinds)
      .value("state", message.state(), msg::kServiceStopped)
      .defect();
}

Defect find_defect(const msg::LivePose& message) {
  return Check(message)
      .value("state", message.state(), msg::kStateLost)
      .value("mode", message.mode(), msg::kModeLocalization)
      .defect();
}

Defect find_defect(const msg::TrajectorySegment& message) {
  return Check(message).size("stops", message.stops().size(), msg::kSegmentStops).defect();
}

Defect find_defect(const msg::LoopClosures& message) {
  return Check(message).size("closures", message.closures().size(), msg::kMaxLoopClosures).defect();
}

Defect find_defect(const msg::LoopDecisions& message) {
  Check check(message);
  check.size("decisions", message.decisions().size(), msg::kSegmentDecisions);
  for (const msg::LoopDecision& decision : message.decisions()) {
    check.value("decisions.outcome", decision.outcome(), msg::kLoopOutvoted)
        .value("decisions.reason", decision.reason(), msg::kReasonSecondSolution);
  }
  return check.defect();
}

Defect find_defect(const msg::LocalizationCommand& message) {
  return Check(message).value("kind", message.kind(), msg::kCommandSwitchToMapping).defect();
}

Defect find_defect(const msg::LocalizationReply& message) {
  return Check(message).defect();
}

Defect find_defect(const msg::MapElement& message) {
  return Check(message)
      .size("points", message.points().size(), msg::kMaxBranchPoints)
      .value("kind", message.kind(), msg::kElementSummary)
      .value("node_kind", message.node_kind(), msg::kNodeHallCorridor)
      .defect();
}

Defect find_defect(const msg::Goal& message) {
  return Check(message).value("kind", message.kind(), msg::kGoalResume).defect();
}

Defect find_defect(const msg::Route& message) {
  Check check(message);
  check.size("zones", message.zones().size(), msg::kMaxRouteNodes)
      .size("node_ids", message.node_ids().size(), msg::kMaxRouteNodes)
      .size("points", message.points().size(), msg::kMaxRoutePoints)
      .size("primitives", message.primitives().size(), msg::kMaxRoutePrimitives)
      .value("status", message.status(), msg::kRouteNoPose);
  for (const msg::MotionPrimitive& primitive : message.primitives()) {
    check.value("primitives.kind", primitive.kind(), msg::kMotionTurnRight);
  }
  return check.defect();
}

Defect find_defect(const msg::Blockages& message) {
  return Check(message).size("points", message.points().size(), msg::kMaxBlockedPoints).defect();
}

Defect find_defect(const msg::NavigatorStatus& message) {
  return Check(message)
      .value("state", message.state(), msg::kNavigatorStopped)
      .value("reason", message.reason(), msg::kHaltBaseStuck)
      .defect();
}

Defect find_defect(const msg::GridTile& message) {
  return Check(message)
      .size("states", message.states().size(), msg::kTileArea)
      .size("zones", message.zones().size(), msg::kTileArea)
      .defect();
}

Defect find_defect(const msg::HybridMap& message) {
  return Check(message)
      .size("tile_versions", message.tile_versions().size(), msg::kMaxTiles)
      .size("zones", message.zones().size(), msg::kMaxZones)
      .size("places", message.places().size(), msg::kMaxPlaces)
      .size("nodes", message.nodes().size(), msg::kMaxBorderNodes)
      .size("edges", message.edges().size(), msg::kMaxHybridEdges)
      .defect();
}

Defect find_defect(const msg::MotionCommand& message) {
  return Check(message).defect();
}

Defect find_defect(const msg::BaseCommand& message) {
  return Check(message).value("kind", message.kind(), msg::kBaseSetLimits).defect();
}

Defect find_defect(const msg::GroundTruth& message) {
  return Check(message).defect();
}

Defect find_defect(const msg::SimulatorCommand& message) {
  return Check(message)
      .value("fault", message.fault(), msg::kSimulatedEmergencyStop)
      .value("device", message.device(), msg::kSimulatedBase)
      .defect();
}

}  // namespace topogeo::messaging
