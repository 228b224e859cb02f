#include "topogeo/messaging/topics.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "topogeo/msg/hybrid_mapPubSubTypes.h"
#include "topogeo/msg/local_mapPubSubTypes.h"
#include "topogeo/msg/map_updatePubSubTypes.h"
#include "topogeo/msg/matchPubSubTypes.h"
#include "topogeo/msg/motionPubSubTypes.h"
#include "topogeo/msg/planningPubSubTypes.h"
#include "topogeo/msg/sensorPubSubTypes.h"
#include "topogeo/msg/simulationPubSubTypes.h"
#include "topogeo/msg/statusPubSubTypes.h"
#include "topogeo/msg/streamPubSubTypes.h"
#include "topogeo/msg/trajectoryPubSubTypes.h"

#include "bounds.hpp"

namespace topogeo::messaging {

namespace {

/// What the history allocates for a sample before it knows how large it is, bytes.
constexpr std::uint32_t kInitialPayload = 1024;

/// A generated type support whose histories start small and grow with the samples. The generated
/// one makes histories allocate the maximum of a bounded type for each sample, which is 50 MB for a
/// local map.
template <class Generated>
class GrowingTypeSupport final : public Generated {
 public:
  GrowingTypeSupport() { this->m_typeSize = std::min(this->m_typeSize, kInitialPayload); }
  [[nodiscard]] bool is_bounded() const override { return false; }
  [[nodiscard]] bool is_plain() const override { return false; }
};

template <class Generated>
eprosima::fastdds::dds::TopicDataType* make_type() {
  return new GrowingTypeSupport<Generated>;  // NOLINT: the caller hands it to a dds::TypeSupport
}

template <class T>
std::optional<std::string> find_defect_of(const void* message) {
  return find_defect(*static_cast<const T*>(message));
}

template <class T, class TypeSupport>
TopicInfo make_info(std::string_view name, std::string_view role, std::string_view replay_role = {},
                    std::string_view addressee = {}) {
  return {name, role, replay_role, addressee, make_type<TypeSupport>, find_defect_of<T>};
}

}  // namespace

// One line for each topic: type, name, role, role in replay, addressee.
#define TOPOGEO_TOPIC(Type, name, ...)                                                             \
  template <>                                                                                      \
  const TopicInfo& TopicTraits<msg::Type>::info() {                                                \
    static const TopicInfo topic = make_info<msg::Type, msg::Type##PubSubType>(name, __VA_ARGS__); \
    return topic;                                                                                  \
  }

TOPOGEO_TOPIC(Scan, kScan, "sensor_live", kReplayRole)
TOPOGEO_TOPIC(Odometry, kOdometry, "motion_live", kReplayRole)
TOPOGEO_TOPIC(Sonar, kSonar, "sensor_live", kReplayRole)
TOPOGEO_TOPIC(BaseStatus, kBaseStatus, "sensor_live", kReplayRole)
TOPOGEO_TOPIC(LaserStatus, kLaserStatus, "sensor_live", kReplayRole)
TOPOGEO_TOPIC(StreamEnd, kStreamEnd, "state")
TOPOGEO_TOPIC(LocalMap, kLocalMap, "state")
TOPOGEO_TOPIC(TrackedPose, kTrackedPose, "motion_live")
TOPOGEO_TOPIC(MatchTask, kMatchTask, "task", {}, "worker_id")
TOPOGEO_TOPIC(MatchResult, kMatchResult, "result", {}, "client_id")
TOPOGEO_TOPIC(MapRequest, kMapRequest, "result", {}, "client_id")
TOPOGEO_TOPIC(MapCopy, kMapCopy, "task", {}, "worker_id")
TOPOGEO_TOPIC(WorkerStatus, kWorkerStatus, "status")
TOPOGEO_TOPIC(ServiceStatus, kServiceStatus, "status")
TOPOGEO_TOPIC(LivePose, kLivePose, "motion_live")
TOPOGEO_TOPIC(TrajectorySegment, kTrajectorySegment, "state")
TOPOGEO_TOPIC(LoopClosures, kLoopClosures, "state")
TOPOGEO_TOPIC(LoopDecisions, kLoopDecisions, "state")
TOPOGEO_TOPIC(LocalizationCommand, kLocalizationCommand, "request")
TOPOGEO_TOPIC(LocalizationReply, kLocalizationReply, "request")
TOPOGEO_TOPIC(MapElement, kMapElement, "state")
TOPOGEO_TOPIC(Goal, kGoal, "state")
TOPOGEO_TOPIC(Route, kRoute, "state")
TOPOGEO_TOPIC(Blockages, kBlockages, "state")
TOPOGEO_TOPIC(NavigatorStatus, kNavigatorStatus, "state")
TOPOGEO_TOPIC(GridTile, kGridTile, "state")
TOPOGEO_TOPIC(HybridMap, kHybridMap, "state")
TOPOGEO_TOPIC(MotionCommand, kMotionCommand, "command")
TOPOGEO_TOPIC(BaseCommand, kBaseCommand, "request")
TOPOGEO_TOPIC(GroundTruth, kGroundTruth, "motion_live")
TOPOGEO_TOPIC(SimulatorCommand, kSimulatorCommand, "request")

#undef TOPOGEO_TOPIC

std::span<const TopicInfo* const> all_topics() {
  static const std::array<const TopicInfo*, 31> topics = {
      &TopicTraits<msg::BaseCommand>::info(),
      &TopicTraits<msg::BaseStatus>::info(),
      &TopicTraits<msg::Blockages>::info(),
      &TopicTraits<msg::Goal>::info(),
      &TopicTraits<msg::GridTile>::info(),
      &TopicTraits<msg::GroundTruth>::info(),
      &TopicTraits<msg::HybridMap>::info(),
      &TopicTraits<msg::LaserStatus>::info(),
      &TopicTraits<msg::LocalMap>::info(),
      &TopicTraits<msg::LocalizationCommand>::info(),
      &TopicTraits<msg::LocalizationReply>::info(),
      &TopicTraits<msg::LoopClosures>::info(),
      &TopicTraits<msg::LoopDecisions>::info(),
      &TopicTraits<msg::MapElement>::info(),
      &TopicTraits<msg::MapCopy>::info(),
      &TopicTraits<msg::MapRequest>::info(),
      &TopicTraits<msg::MatchResult>::info(),
      &TopicTraits<msg::MatchTask>::info(),
      &TopicTraits<msg::MotionCommand>::info(),
      &TopicTraits<msg::NavigatorStatus>::info(),
      &TopicTraits<msg::Odometry>::info(),
      &TopicTraits<msg::LivePose>::info(),
      &TopicTraits<msg::Route>::info(),
      &TopicTraits<msg::Scan>::info(),
      &TopicTraits<msg::ServiceStatus>::info(),
      &TopicTraits<msg::SimulatorCommand>::info(),
      &TopicTraits<msg::Sonar>::info(),
      &TopicTraits<msg::StreamEnd>::info(),
      &TopicTraits<msg::TrackedPose>::info(),
      &TopicTraits<msg::TrajectorySegment>::info(),
      &TopicTraits<msg::WorkerStatus>::info()};
  return topics;
}

}  // namespace topogeo::messaging
