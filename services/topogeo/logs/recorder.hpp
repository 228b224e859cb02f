// Records a robot's measurements, and its poses on the map, as a log.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "topogeo/map_client/map_follower.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/msg/map_update.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/stream.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/recording/log_writer.hpp"
#include "topogeo/service/live_hybrid_map.hpp"
#include "topogeo/support/patience.hpp"

#include "common/domain_view.hpp"

namespace topogeo::cli {

struct RecordRequest {
  DomainView view;
  std::string robot_id = "robot";
  std::filesystem::path out;
  std::optional<std::string> laser;  ///< see pipeline::parse_mounting
};

/// Records the scans of a gateway and, in formats that hold them, the poses of the localizer and
/// the graph and grid of the map store, as far as these services are there.
class Recorder {
 public:
  /// Throws service::UsageError or service::BadInputError for a faulty request.
  explicit Recorder(const RecordRequest& request);

  /// Runs until the gateway's stream has ended and with it those of localizer and map store, or
  /// until stop(). Throws std::runtime_error when the log cannot be written or scans are missing.
  void run();
  /// Makes run() return, even if it has not begun. Thread-safe.
  void stop() { loop_.stop(); }

 private:
  void listen();
  void take(const msg::Scan& message);
  /// Takes the pose of a localized robot; poses come after their scans.
  void take_pose(const msg::LivePose& pose);
  void take_end(const msg::StreamEnd& end);
  /// Records the current graph at the time of the newest scan, once there is one.
  void record_graph();
  /// Records the current grid unless it is the same as the last one.
  void take_grid();
  /// Whether each connected stage has ended and all messages that it counts have arrived.
  [[nodiscard]] bool is_complete();
  /// Whether the final graph or grid of the map store has arrived.
  [[nodiscard]] bool has_graph() const;
  [[nodiscard]] bool has_grid();
  void stop_at_end();
  /// Reports once that no gateway is found.
  void say_elsewhere();
  void report();

  RecordRequest request_;
  recording::LogWriter log_;
  messaging::Participant participant_;
  messaging::Reader<msg::Scan> scans_;
  messaging::Reader<msg::StreamEnd> ends_;
  messaging::Reader<msg::LivePose> poses_;
  messaging::Reader<msg::MapElement> elements_;
  messaging::EventLoop loop_;
  map_client::MapFollower follower_;
  service::LiveHybridMap hybrid_;
  struct RecentScan {
    scan::Scan scan;  // without ranges
    bool has_pose = false;
  };
  std::map<std::uint64_t, RecentScan> recent_;  // by number
  std::uint64_t odometry_epoch_ = 0;            // epoch of the last scan
  std::uint64_t first_ = 0;                     // number of the first scan recorded
  std::uint64_t next_ = 0;                      // number of the scan that is expected
  std::uint64_t next_pose_ = 0;                 // after the last scan with a pose
  std::uint64_t recorded_ = 0;
  std::uint64_t missing_ = 0;  // among the scans recorded
  std::uint64_t poses_came_ = 0;
  std::uint64_t with_pose_ = 0;  // scans
  bool graph_is_new_ = false;
  std::uint64_t graphs_ = 0;
  std::uint64_t grids_ = 0;
  std::uint64_t grid_version_ = 0;
  std::int64_t last_stamp_ns_ = 0;
  std::optional<std::uint64_t> expected_;  // scans in the whole stream
  bool localized_ = false;                 // the localizer's stream has ended
  std::optional<msg::StreamEnd> mapped_;   // end of the map store's
  support::Patience patience_;             // since the last message
  bool said_elsewhere_ = false;
};

}  // namespace topogeo::cli
