// Connects localization::SlamSession, which maps or localizes in a finished map, to topics: local
// maps in; corrected trajectory, closed loops, loop decisions and live pose out. RemotePool does
// the matching.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/local_map.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/stream.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/service/service.hpp"
#include "topogeo/session/odometry_chain.hpp"
#include "topogeo/session/slam_session.hpp"

#include "background_optimizer.hpp"
#include "command_channel.hpp"
#include "live_pose_estimate.hpp"
#include "missing_stops.hpp"
#include "pose_memory.hpp"
#include "remote_pool.hpp"
#include "resume.hpp"
#include "stop_queue.hpp"
#include "stop_table.hpp"
#include "trajectory_publisher.hpp"
#include "watched_pool.hpp"

namespace topogeo::localizer {

struct LocalizerOptions {
  std::uint32_t wait_workers = 0;                  ///< workers to wait for before the first step
  double wait_s = 5.0;                             ///< longest wait for them, > 0
  std::optional<std::filesystem::path> map;        ///< map to localize in; none: a map is made
  std::optional<std::filesystem::path> continued;  ///< map to extend; none: a new one
  std::optional<geometry::Pose2> initial_pose;     ///< in either map; none: it is searched for
  std::optional<std::filesystem::path> csv;        ///< localization.csv, written at the end
  std::optional<std::filesystem::path> memory;     ///< of the last place in the map (PoseMemory)
  bool standalone = false;  ///< there is no map store: a new map is begun at once
  bool replay = false;      ///< stops from a log: no process death may change the map
};

/// Lives in the loop of its service.
class LocalizerService {
 public:
  LocalizerService(service::Service& service, const LocalizerOptions& options);

 private:
  void resume(ResumeFrom from);
  void on_map(const msg::LocalMap& message);
  void on_odometry(const msg::Odometry& message);
  void send_pose();
  [[nodiscard]] std::size_t stops_in_map() const;
  void on_stream_end(const msg::StreamEnd& message);
  /// Schedules the work outside of message handlers, as the pool requires.
  void schedule();
  void work();
  void wait_for_workers();
  void carry_out_commands();
  CommandAnswer carry_out(const service::LocalizationCommand& command);
  void step(const StopQueue::MapPointer& map);
  /// In a stored map, resumes where the previous localizer was killed, if it was.
  void recall();
  /// Stores the robot's place, if it is known, for the next localizer.
  void remember() const;
  void finish();
  void publish(bool whole);
  void count();
  /// In a stored map, reports the help that a robot without a pose needs.
  void report_need();

  service::Service& service_;
  LocalizerOptions options_;
  RemotePool pool_;
  WatchedPool watched_;
  BackgroundOptimizer optimizer_;
  std::optional<localization::SlamSession> slam_;
  CommandChannel commands_;
  TrajectoryPublisher trajectory_;
  messaging::Writer<msg::LivePose> poses_;
  messaging::Writer<msg::RunSummary> summaries_;
  messaging::Writer<msg::StreamEnd> ends_out_;

  std::optional<Resume> resume_;  // until the place to resume is known
  StopQueue queue_;
  std::optional<MissingStops> missing_;  // unless it is standalone
  localization::OdometryChain odometry_;
  std::size_t known_stops_ = 0;  // to be added again: readers have their poses already
  LivePoseEstimate live_;
  std::optional<StopTable> table_;
  std::optional<PoseMemory> memory_;
  StopQueue::MapPointer last_map_;  // of the last stop, as it was sent
  bool stops_are_stored_ = false;   // by a map store
  bool ready_ = false;              // the place to resume is known
  bool scheduled_ = false;
  bool waited_ = false;
  bool finished_ = false;
};

}  // namespace topogeo::localizer
