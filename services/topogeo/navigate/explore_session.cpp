#include "navigate/explore_session.hpp"

#include <iostream>
#include <stdexcept>
#include <utility>

#include "topogeo/render/route_picture.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/navigation_conversions.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/progress_bar.hpp"

namespace topogeo::cli {
namespace {

/// Step of the driven path in the picture; smaller steps are not visible.
constexpr double kPathStep_m = 0.1;

std::int64_t monotonic_ns() {
  return static_cast<std::int64_t>(1e9 * support::monotonic_s());
}

}  // namespace

ExploreSession::ExploreSession(const messaging::Participant& participant,
                               messaging::EventLoop& loop, const std::string& robot_id,
                               const navigation::TourConfig& config)
    : robot_id_(robot_id),
      client_(participant, loop, robot_id),
      progress_(std::cerr, support::stderr_is_terminal(), supervision::terminal_columns()),
      tour_(config),
      follower_(robot_id),
      elements_(participant),
      segments_(participant),
      poses_(participant) {
  listen(loop);
}

// Ignores invalid messages, which the services count.
void ExploreSession::listen(messaging::EventLoop& loop) {
  using messaging::SampleInfo;
  loop.add<msg::MapElement>(
      elements_,
      [this](const msg::MapElement& element, const SampleInfo& info) {
        graph_changed_ |= follower_.put(element, info.instance.bytes, info.writer.bytes);
      },
      [this](const SampleInfo& info) {
        if (info.state != messaging::InstanceState::kDisposed) return;
        graph_changed_ |= follower_.remove(info.instance.bytes, info.writer.bytes);
      });
  loop.add<msg::TrajectorySegment>(
      segments_, [this](const msg::TrajectorySegment& segment, const SampleInfo&) {
        if (!is_own(segment)) return;
        try {
          trajectory_.add(segment);
        } catch (const std::invalid_argument&) {
          return;
        }
      });
  loop.add<msg::LivePose>(poses_, [this](const msg::LivePose& pose, const SampleInfo&) {
    if (is_own(pose)) pose_ = pose;
  });
}

void ExploreSession::take_map() {
  map_ = client_.map();
  if (std::exchange(graph_changed_, false)) {
    try {
      graph_ = std::make_shared<const topomap::GlobalMap>(service::from_elements(*follower_.map()));
    } catch (const std::invalid_argument&) {  // keep the previous map
    }
  }
  tour_.follow(graph_, map_, [this] {
    std::vector<geometry::Pose2> T_map_stops;
    for (const topomap::StopPose& stop : trajectory_.newest().stops) {
      if (stop.located) T_map_stops.push_back(stop.T_map_robot);
    }
    return T_map_stops;
  });
}

navigation::NavigatorStatus ExploreSession::navigator() const {
  navigation::NavigatorStatus status;
  if (client_.status() && client_.taken()) {
    status = *client_.status();
    status.goal_id = goal_id_;
  }
  const bool tracked = pose_ && pose_->state() == msg::kStateTracking;
  status.T_map_robot.reset();
  if (tracked) status.T_map_robot = service::from_msg(pose_->T_map_robot());
  return status;
}

void ExploreSession::record_path() {
  if (!pose_ || pose_->state() != msg::kStateTracking) return;
  const Eigen::Vector2d at_m = service::from_msg(pose_->T_map_robot()).position_m();
  const double step_m = path_m_.empty() ? 0.0 : (at_m - path_m_.back()).norm();
  if (!path_m_.empty() && step_m < kPathStep_m) return;
  driven_m_ += step_m;
  path_m_.push_back(at_m);
}

void ExploreSession::tick() {
  take_map();
  record_path();
  // A robot that another program has taken must not get the next target.
  if (!trouble().empty()) return;
  const std::int64_t now_ns = monotonic_ns();
  const std::int64_t last_ns = std::exchange(ticked_ns_, now_ns);
  if (paused()) {
    if (last_ns != 0) paused_ns_ += now_ns - last_ns;
    progress_.show(*client_.status(), support::monotonic_s());
    return;
  }
  const auto goal = tour_.step(navigator(), now_ns - paused_ns_);
  if (goal) {
    goal_id_ = goal->goal_id;
    service::Goal order;
    order.kind = msg::kGoalPosition;
    order.target = goal->T_map_goal.position_m();
    order.heading_rad = goal->T_map_goal.theta_rad;
    client_.send(order);
    progress_.print(fmt::format("{:.1f} m driven: {}", driven_m_, tour_.message()));
  }
  if (client_.status()) progress_.show(*client_.status(), support::monotonic_s());
}

std::string ExploreSession::trouble() const {
  if (pose_ && pose_->mode() == msg::kModeLocalization) {
    return "the localizer does not map: topogeo localizer mode mapping";
  }
  if (client_.was_taken_away()) return "another program replaced or cancelled the robot's goal";
  return {};
}

std::string ExploreSession::summary() const {
  return fmt::format("{} targets in {:.1f} m, {} of them given up; {}", tour_.targets(), driven_m_,
                     tour_.given_up(), tour_.message());
}

void ExploreSession::write_picture(const std::filesystem::path& file) const {
  if (!map_) throw std::runtime_error("no picture: there was no map");
  planning::HybridRoute path;
  path.status = planning::RouteStatus::kFound;
  path.points_m = path_m_;
  support::write_file_atomically(
      file, render::route_picture(*map_, path, fmt::format("explored in {:.1f} m", driven_m_),
                                  render::picture_format(file)));
}

}  // namespace topogeo::cli
