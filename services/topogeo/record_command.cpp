// topogeo record: writes the scans that a gateway publishes as a log that can be replayed.
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/map_client/map_follower.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/messaging/topics.hpp"
#include "topogeo/msg/map_update.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/stream.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/pipeline/laser_mounting.hpp"
#include "topogeo/recording/log_writer.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/service_options.hpp"

#include "commands.hpp"
#include "domain_view.hpp"

namespace topogeo::cli {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

/// Scans that a stream end counts and that have not come by then will not come any more.
constexpr std::chrono::seconds kPatience{5};
constexpr milliseconds kRecordTick{50};
/// Scans whose poses may still come: a minute or two.
constexpr std::size_t kRecentScans = 2048;

struct RecordRequest {
  DomainView view;
  std::string robot_id = "robot";
  std::filesystem::path out;
  std::optional<std::string> laser;  ///< see pipeline::parse_mounting
};

recording::LogWriter open(const RecordRequest& request) {
  geometry::Pose2 T_robot_laser;
  try {
    if (request.laser) T_robot_laser = pipeline::parse_mounting(*request.laser);
  } catch (const std::invalid_argument& error) {
    throw service::UsageError(std::string("--laser: ") + error.what());
  }
  try {
    return recording::LogWriter(request.out, T_robot_laser);
  } catch (const std::runtime_error& error) {
    throw service::BadInputError(error.what());
  }
}

class Recorder {
 public:
  explicit Recorder(const RecordRequest& request)
      : request_(request),
        log_(open(request)),
        participant_(join(request.view, "topogeo/record")),
        // Slows a replay down rather than lose scans.
        scans_(participant_, {std::string(messaging::kReplayRole), {}}),
        ends_(participant_),
        poses_(participant_),
        elements_(participant_),
        follower_(request.robot_id) {
    loop_.add<msg::Scan>(scans_, [this](const msg::Scan& scan, const messaging::SampleInfo&) {
      if (scan.robot_id() == request_.robot_id.c_str()) take(scan);
    });
    loop_.add<msg::StreamEnd>(
        ends_, [this](const msg::StreamEnd& end, const messaging::SampleInfo&) {
          if (end.robot_id() != request_.robot_id.c_str() || end.stage() != msg::kStageGateway)
            return;
          expected_ = end.count();
          last_news_ = Clock::now();
        });
    loop_.add<msg::LivePose>(poses_,
                             [this](const msg::LivePose& pose, const messaging::SampleInfo&) {
                               if (pose.robot_id() == request_.robot_id.c_str()) take_pose(pose);
                             });
    using messaging::SampleInfo;
    loop_.add<msg::MapElement>(
        elements_,
        [this](const msg::MapElement& element, const SampleInfo& info) {
          if (follower_.put(element, info.instance.bytes, info.writer.bytes)) take_map();
        },
        [this](const SampleInfo& info) {
          if (info.state != messaging::InstanceState::kDisposed) return;
          if (follower_.remove(info.instance.bytes, info.writer.bytes)) take_map();
        });
    loop_.add_timer(kRecordTick, [this] { stop_at_end(); });
  }

  /// Until the end of the stream or a signal. Throws std::runtime_error when the log cannot be
  /// written or scans are missing.
  void run() {
    {
      const messaging::SignalStop signals([this](int) { loop_.stop(); });
      loop_.run();
    }
    log_.close();
    std::cerr << "topogeo: " << recorded_ << " scans recorded in " << request_.out.string() << '\n';
    if (first_ > 0) {
      std::cerr << "topogeo: the first of them is number " << first_
                << " of its source: the recording was started after it\n";
    }
    std::uint64_t missing = missing_;
    if (expected_ && *expected_ > next_) missing += *expected_ - next_;
    if (missing > 0) throw std::runtime_error(std::to_string(missing) + " scans are missing");
    if (recorded_ == 0) throw std::runtime_error("no scan came");
  }

 private:
  void take(const msg::Scan& message) {
    last_news_ = Clock::now();
    const std::uint64_t number = message.sequence_number();
    if (recorded_ > 0 && number < next_) {
      throw std::runtime_error("scan " + std::to_string(number) + " came after scan " +
                               std::to_string(next_ - 1) +
                               ": another source has begun, or there are two of them");
    }
    if (recorded_ == 0) first_ = number;
    if (recorded_ > 0) missing_ += number - next_;
    scan::Scan scan = service::from_msg(message);
    log_.write(scan);
    scan.ranges_m.clear();
    recent_[scan.sequence] = std::move(scan);
    if (recent_.size() > kRecentScans) recent_.erase(recent_.begin());
    next_ = number + 1;
    ++recorded_;
  }

  /// Of a robot that knows where it is; poses come after their scans.
  void take_pose(const msg::LivePose& pose) {
    const auto scan = recent_.find(pose.sequence_number());
    const bool located =
        pose.state() == msg::kStateTracking || pose.state() == msg::kStateAmbiguous;
    next_pose_ = pose.sequence_number() + 1;
    if (log_.holds_poses()) last_news_ = Clock::now();
    if (!located || scan == recent_.end() || scan->second.stamp_ns != pose.stamp_ns()) return;
    log_.write_pose(scan->second, service::from_msg(pose.T_map_robot()),
                    service::from_msg(pose.covariance()));
  }

  void take_map() {
    (void)follower_.take_changes();  // the whole is drawn
    const map_client::Map& map = *follower_.map();
    recording::GraphDrawing graph;
    for (const auto& [id, node] : map.nodes) {
      graph.nodes.emplace_back(node->node_position().x_m(), node->node_position().y_m());
    }
    for (const auto& [id, branch] : map.branches) {
      std::vector<Eigen::Vector2d>& line = graph.branches.emplace_back();
      for (const msg::BranchPoint& point : branch->points()) {
        line.emplace_back(point.x_m(), point.y_m());
      }
    }
    log_.write_graph(map.stamp_ns, graph);
  }

  /// The stream has ended, and the poses of its scans have come where they are recorded.
  void stop_at_end() {
    if (!expected_) return;
    const bool scans_came = next_ >= *expected_;
    const bool poses_came = !log_.holds_poses() || next_pose_ >= *expected_;
    if ((scans_came && poses_came) || Clock::now() - last_news_ > kPatience) loop_.stop();
  }

  RecordRequest request_;
  recording::LogWriter log_;
  messaging::Participant participant_;
  messaging::Reader<msg::Scan> scans_;
  messaging::Reader<msg::StreamEnd> ends_;
  messaging::Reader<msg::LivePose> poses_;
  messaging::Reader<msg::MapElement> elements_;
  messaging::EventLoop loop_;
  map_client::MapFollower follower_;
  std::map<std::uint64_t, scan::Scan> recent_;  // by number, without ranges
  std::uint64_t first_ = 0;                     // number of the first scan recorded
  std::uint64_t next_ = 0;                      // number of the scan that is expected
  std::uint64_t next_pose_ = 0;                 // after the last scan of which a pose came
  std::uint64_t recorded_ = 0;
  std::uint64_t missing_ = 0;              // between the scans recorded
  std::optional<std::uint64_t> expected_;  // scans in the whole stream
  Clock::time_point last_news_;
};

}  // namespace

void add_record_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("record",
                         "Write the scans that a sensor gateway gives as a log, with poses and "
                         "graph if it holds them");
  auto request = std::make_shared<RecordRequest>();
  request->view.partition = messaging::kDefaultPartition;
  command
      ->add_option("--out", request->out,
                   "log to write, by its name: .mcap, .db3, .bag, else CARMEN (.gz: gzip)")
      ->required()
      ->type_name("FILE");
  command->add_option("--robot,--robot-id", request->robot_id, "whose scans")
      ->capture_default_str();
  command
      ->add_option("--laser", request->laser,
                   "mounting of the laser, m and rad, which the log is to state (default: 0,0,0)")
      ->type_name("X,Y,YAW");
  add_domain_options(*command, request->view);
  command->footer(
      "Ends with the stream of the gateway or with Ctrl-C. Numbers are written with every digit, "
      "so "
      "that\na replay of the log gives the map of the recorded run, byte for byte.");
  command->callback([request, &exit_code] {
    Recorder(*request).run();
    exit_code = service::kOk;
  });
}

}  // namespace topogeo::cli
