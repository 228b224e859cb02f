#include "topogeo/navigation/navigator_inputs.hpp"

namespace topogeo::navigation {

std::string_view describe(NavigatorState state) {
  switch (state) {
    case NavigatorState::kIdle:
      return "idle";
    case NavigatorState::kDriving:
      return "driving";
    case NavigatorState::kRelocalizing:
      return "relocalizing";
    case NavigatorState::kBlocked:
      return "blocked";
    case NavigatorState::kArrived:
      return "arrived";
    case NavigatorState::kStopped:
      return "stopped";
  }
  return "unknown";
}

std::string_view describe(HaltReason reason) {
  switch (reason) {
    case HaltReason::kNone:
      return "";
    case HaltReason::kWaitsForRoute:
      return "waits for a route";
    case HaltReason::kNoRoute:
      return "no route";
    case HaltReason::kCancelled:
      return "cancelled";
    case HaltReason::kPaused:
      return "paused";
    case HaltReason::kPoseLost:
      return "the position is not known";
    case HaltReason::kNoMap:
      return "no map";
    case HaltReason::kOutsideMap:
      return "the robot is not on the map";
    case HaltReason::kObstacle:
      return "something is in the way";
    case HaltReason::kNoScan:
      return "no scan";
    case HaltReason::kSonarSilent:
      return "the sonars hear nothing";
    case HaltReason::kNoOdometry:
      return "no odometry";
    case HaltReason::kBaseNotReady:
      return "the drive unit takes no orders";
    case HaltReason::kBaseStuck:
      return "the drive unit does not move";
  }
  return "unknown";
}

}  // namespace topogeo::navigation
