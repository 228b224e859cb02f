// Connects localization::SharedMap to topics: the local maps of several robots in; one trajectory,
// a live pose for each robot, and proposals to join their maps out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/local_map.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/stream.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/service/service.hpp"
#include "topogeo/session/odometry_chain.hpp"
#include "topogeo/session/shared_map.hpp"

#include "live_pose_estimate.hpp"
#include "merge_channel.hpp"
#include "remote_pool.hpp"
#include "shared_resume.hpp"
#include "stop_queue.hpp"
#include "trajectory_publisher.hpp"
#include "watched_pool.hpp"

namespace topogeo::localizer {

/// Lives in the loop of its service.
class SharedLocalizerService {
 public:
  /// `standalone`: there is no map store, so a new map is begun at once.
  SharedLocalizerService(service::Service& service, bool standalone);

 private:
  struct Robot {
    StopQueue queue = {};
    localization::OdometryChain odometry = {};
    LivePoseEstimate live;
    bool ended = false;  // the stream of its local maps has ended
  };

  void resume(SharedResumeFrom from);
  void on_map(const msg::LocalMap& message);
  void on_stream_end(const msg::StreamEnd& message);
  void send_pose(const std::string& robot);
  /// Schedules the work outside of message handlers, as the pool requires.
  void schedule();
  void work();
  void answer_merges();
  /// Adds one waiting stop of each robot; false when none waits.
  bool step_all();
  void finish();
  void publish(bool whole);
  void count();

  service::Service& service_;
  RemotePool pool_;
  WatchedPool watched_;
  std::optional<localization::SharedMap> map_;
  std::map<std::string, Robot> robots_;
  MergeChannel merges_;
  TrajectoryPublisher trajectory_;
  messaging::Writer<msg::LivePose> poses_;
  messaging::Writer<msg::StreamEnd> ends_out_;
  std::optional<SharedResume> resume_;  // until the place to resume is known
  std::int64_t stamp_ns_ = 0;           // of the newest stop
  bool ready_ = false;                  // the place to resume is known
  bool scheduled_ = false;
  bool finished_ = false;
};

}  // namespace topogeo::localizer
