#include "logs/recorder.hpp"

#include <chrono>
#include <iostream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "topogeo/messaging/topics.hpp"
#include "topogeo/pipeline/laser_mounting.hpp"
#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/ros_conversions/grid.hpp"
#include "topogeo/ros_conversions/markers.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/cpu_time.hpp"

namespace topogeo::cli {
namespace {

using std::chrono::milliseconds;

/// After this time without a message since the end of the stream, no more will come.
constexpr double kPatience_s = 5.0;
constexpr milliseconds kRecordTick{50};
/// Discovery takes a second.
constexpr std::chrono::seconds kWithoutGateway{2};
/// Recording period of a growing grid, because a grid is large.
constexpr std::chrono::seconds kGridPeriod{5};
/// Scans whose poses may still arrive: a minute or two.
constexpr std::size_t kRecentScans = 2048;

recording::LogWriter open_log(const RecordRequest& request) {
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

ros::GraphDrawing drawing_of(const map_client::Map& map) {
  ros::GraphDrawing graph;
  for (const auto& [id, node] : map.nodes) {
    const msg::BranchPoint& at = node->node_position();
    graph.nodes.push_back({static_cast<std::int32_t>(id), {at.x_m(), at.y_m()}});
  }
  for (const auto& [id, branch] : map.branches) {
    ros::GraphDrawing::Branch& drawn = graph.branches.emplace_back();
    drawn.id = static_cast<std::int32_t>(id);
    drawn.is_virtual = branch->is_virtual();
    for (const msg::BranchPoint& point : branch->points()) {
      drawn.points_m.emplace_back(point.x_m(), point.y_m());
    }
  }
  return graph;
}

}  // namespace

Recorder::Recorder(const RecordRequest& request)
    : request_(request),
      log_(open_log(request)),
      participant_(join_for(request.view, "topogeo/record", request.robot_id, /*observe=*/true)),
      // Slows a replay down rather than losing scans.
      scans_(participant_, {std::string(messaging::kReplayRole), {}}),
      ends_(participant_),
      poses_(participant_),
      elements_(participant_),
      follower_(request.robot_id),
      hybrid_(participant_, loop_,
              [this](const auto& message, const auto& use) {
                if (message.robot_id() == request_.robot_id.c_str()) use(message);
              }),
      patience_(kPatience_s, support::monotonic_s()) {
  listen();
}

void Recorder::listen() {
  using messaging::SampleInfo;
  loop_.add<msg::Scan>(scans_, [this](const msg::Scan& scan, const SampleInfo&) {
    if (scan.robot_id() == request_.robot_id.c_str()) take(scan);
  });
  loop_.add<msg::StreamEnd>(ends_, [this](const msg::StreamEnd& end, const SampleInfo&) {
    if (end.robot_id() == request_.robot_id.c_str()) take_end(end);
  });
  if (log_.holds_poses()) {
    loop_.add<msg::LivePose>(poses_, [this](const msg::LivePose& pose, const SampleInfo&) {
      if (pose.robot_id() == request_.robot_id.c_str()) take_pose(pose);
    });
    loop_.add<msg::MapElement>(
        elements_,
        [this](const msg::MapElement& element, const SampleInfo& info) {
          if (follower_.put(element, info.instance.bytes, info.writer.bytes)) {
            graph_is_new_ = true;
            record_graph();
          }
        },
        [this](const SampleInfo& info) {
          if (info.state != messaging::InstanceState::kDisposed) return;
          if (!follower_.remove(info.instance.bytes, info.writer.bytes)) return;
          graph_is_new_ = true;
          record_graph();
        });
    loop_.add_timer(kGridPeriod, [this] { take_grid(); });
  }
  loop_.add_timer(kRecordTick, [this] { stop_at_end(); });
  loop_.add_timer(kWithoutGateway, [this] { say_elsewhere(); });
}

void Recorder::say_elsewhere() {
  if (said_elsewhere_ || recorded_ > 0 || scans_.matched() > 0) return;
  said_elsewhere_ = true;
  std::cerr << "topogeo: "
            << nothing_alive(request_.view, "sensor gateway of robot '" + request_.robot_id + "'",
                             participant_.discovered())
            << '\n';
}

void Recorder::run() {
  loop_.run();
  if (log_.holds_poses()) take_grid();
  log_.close();
  report();
  std::uint64_t missing = missing_;
  if (expected_ && *expected_ > next_) missing += *expected_ - next_;
  if (missing > 0) throw std::runtime_error(std::to_string(missing) + " scans are missing");
  if (recorded_ == 0) throw std::runtime_error("received no scan");
}

void Recorder::report() {
  std::cerr << "topogeo: " << recorded_ << " scans";
  if (log_.holds_poses()) {
    std::cerr << ", " << with_pose_ << " of them with poses, the graph " << graphs_
              << " times and the grid " << grids_ << " times";
  }
  std::cerr << " recorded in " << request_.out.string() << '\n';
  if (first_ > 0) {
    std::cerr << "topogeo: the first of them is number " << first_
              << " of its source: the recording started late\n";
  }
  if (poses_came_ > 0 && next_pose_ < next_) {
    std::cerr << "topogeo: received no pose of the last " << next_ - next_pose_ << " scans\n";
  }
  if (log_.holds_poses() && mapped_ && !has_graph()) {
    std::cerr << "topogeo: received no finished graph\n";
  }
  if (log_.holds_poses() && mapped_ && !has_grid()) {
    std::cerr << "topogeo: received no finished grid\n";
  }
}

void Recorder::take(const msg::Scan& message) {
  patience_.begin_again(support::monotonic_s());
  const std::uint64_t number = message.sequence_number();
  if (recorded_ > 0 && number < next_) {
    // A log read again, because its gateway or its mapper was away.
    if (message.odometry_epoch() == odometry_epoch_ && message.stamp_ns() <= last_stamp_ns_) return;
    throw std::runtime_error("scan " + std::to_string(number) + " came after scan " +
                             std::to_string(next_ - 1) +
                             ": the source has changed, or there are two sources");
  }
  odometry_epoch_ = message.odometry_epoch();
  if (recorded_ == 0) first_ = number;
  if (recorded_ > 0) missing_ += number - next_;
  scan::Scan scan = service::from_msg(message);
  log_.write(scan);
  last_stamp_ns_ = scan.stamp_ns;
  scan.ranges_m.clear();
  recent_[number] = {std::move(scan)};
  if (recent_.size() > kRecentScans) recent_.erase(recent_.begin());
  next_ = number + 1;
  if (recorded_++ == 0) record_graph();
}

void Recorder::take_pose(const msg::LivePose& pose) {
  patience_.begin_again(support::monotonic_s());
  ++poses_came_;
  next_pose_ = pose.sequence_number() + 1;
  const auto scan = recent_.find(pose.sequence_number());
  const bool located = pose.state() == msg::kStateTracking || pose.state() == msg::kStateAmbiguous;
  if (!located || scan == recent_.end() || scan->second.scan.stamp_ns != pose.stamp_ns()) {
    return;
  }
  log_.write_pose(scan->second.scan, service::from_msg(pose.T_map_robot()),
                  service::from_msg(pose.covariance()));
  if (!std::exchange(scan->second.has_pose, true)) ++with_pose_;
}

void Recorder::take_end(const msg::StreamEnd& end) {
  patience_.begin_again(support::monotonic_s());
  if (end.stage() == msg::kStageGateway) expected_ = end.count();
  if (end.stage() == msg::kStageLocalizer) localized_ = true;
  if (end.stage() == msg::kStageMapStore) mapped_ = end;
}

void Recorder::record_graph() {
  patience_.begin_again(support::monotonic_s());
  if (!graph_is_new_ || recorded_ == 0) return;
  graph_is_new_ = false;
  (void)follower_.take_changes();  // the whole map is drawn
  log_.write_graph(last_stamp_ns_, drawing_of(*follower_.map()));
  ++graphs_;
}

void Recorder::take_grid() {
  const auto map = hybrid_.map();
  if (!map || recorded_ == 0 || hybrid_.version() == grid_version_) return;
  grid_version_ = hybrid_.version();
  const planning::GridFrame& frame = map->frame();
  std::vector<std::int8_t> cells;
  cells.reserve(frame.size());
  for (const planning::CellState state : map->space().seen().cells()) {
    cells.push_back(ros::cell_of(static_cast<std::uint8_t>(state)));
  }
  log_.write_grid(last_stamp_ns_,
                  {static_cast<std::uint32_t>(frame.columns),
                   static_cast<std::uint32_t>(frame.rows), frame.resolution_m, frame.T_map_grid},
                  std::move(cells));
  ++grids_;
}

bool Recorder::has_graph() const {
  return follower_.map() && follower_.map()->version == mapped_->version();
}

bool Recorder::has_grid() {
  (void)hybrid_.map();  // takes the tiles that have arrived
  return hybrid_.version() >= mapped_->last_id();
}

bool Recorder::is_complete() {
  if (!expected_ || next_ < *expected_) return false;
  if (!log_.holds_poses()) return true;
  const bool has_localizer = localized_ || poses_.matched() > 0;
  if (has_localizer && !(localized_ && next_pose_ >= *expected_)) return false;
  const bool has_store = mapped_ || elements_.matched() > 0;
  return !has_store || (mapped_ && has_graph() && has_grid());
}

void Recorder::stop_at_end() {
  if (is_complete()) loop_.stop();
  if (!expected_) return;
  // A connected localizer or map store that has not ended still has work to do.
  const bool works = (poses_.matched() > 0 && !localized_) || (elements_.matched() > 0 && !mapped_);
  if (log_.holds_poses() && works && next_ >= *expected_) return;
  if (patience_.is_over(support::monotonic_s())) loop_.stop();
}

}  // namespace topogeo::cli
