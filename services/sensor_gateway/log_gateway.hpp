// Replays a log: publishes scans and odometry at the wanted pace, and at the end their number.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/stream.h"
#include "topogeo/recording/log_reader.hpp"
#include "topogeo/service/log_feed.hpp"
#include "topogeo/service/service.hpp"

#include "reader_wait.hpp"
#include "replay_pace.hpp"

namespace topogeo::sensor_gateway {

struct GatewayOptions {
  std::filesystem::path log;
  recording::TopicChoice topics;  ///< for a ROS recording
  service::ReplayRate rate;       ///< empty: lossless
  std::optional<int> readers;     ///< scan readers to wait for before the first scan, >= 0; none: 1
  int odometry_readers = 0;       ///< the same for odometry
  bool exit_at_end = false;
};

/// Lives in the loop of its service. The replay begins when the awaited readers are connected: they
/// get every message from the first on, also on the other topics that they read with it. Every rate
/// uses the replay QoS, so a slow reader slows the replay and no message is lost. A local mapper
/// that was away has the log read again from its first missing scan; other readers get those scans
/// twice.
class LogGateway {
 public:
  /// `scans_total` is shown to people.
  LogGateway(service::Service& service, const GatewayOptions& options, service::LogFeed feed,
             std::uint64_t scans_total);

 private:
  using Clock = std::chrono::steady_clock;

  void begin();
  /// Reads the log again if that provides the requested scans.
  void on_request(const msg::ScanRequest& request);
  /// Makes the scan of that number the next one to send, and continues from it at the log's pace.
  /// Throws std::runtime_error when the log no longer has that many.
  void go_back_to(std::uint64_t number);
  /// Schedules the next step after `delay`: scans, or the end.
  void go_on_after(Clock::duration delay);
  /// Sends the messages that are due and schedules the next ones.
  void replay();
  /// Reads the next scan of the log for sending; false at the end.
  bool read_next();
  bool send_pending();
  void count();
  void finish();

  service::Service& service_;
  GatewayOptions options_;
  service::LogFeed feed_;
  ReplayPace pace_;
  messaging::Writer<msg::Scan> scans_;
  messaging::Writer<msg::Odometry> odometry_;
  messaging::Writer<msg::StreamEnd> stream_end_;
  ReaderWait readers_;

  Clock::time_point start_;
  Clock::time_point due_;  // time of the pending messages
  std::optional<msg::Scan> pending_scan_;
  std::optional<msg::Odometry> pending_odometry_;
  msg::Odometry last_odometry_;
  std::uint64_t sent_ = 0;  // scans of the log; also the number of the next one
  bool all_read_ = false;
  bool end_sent_ = false;
  std::uint64_t ends_sent_ = 0;
  std::uint64_t timer_ = 0;  // of go_on_after
};

}  // namespace topogeo::sensor_gateway
