#include "channels/robot_view.hpp"

#include <string>
#include <utility>

#include "topogeo/service/conversions.hpp"
#include "topogeo/service/navigation_conversions.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/host.hpp"

#include "channels/event_log.hpp"
#include "channels/protocol_names.hpp"
#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

bool is_located(msg::LocalizationState state) {
  return state == msg::kStateTracking || state == msg::kStateAmbiguous;
}

using Level = EventLog::Level;

constexpr double kPoseAge_s = 0.5;  // keeps a scan from being drawn at a former pose

std::string scan_text(const navigation::ScanPoints& scan, std::uint64_t sequence,
                      const std::optional<geometry::Pose2>& T_map_robot, std::optional<bool> fits) {
  Json json = {{"stamp_s", seconds(scan.stamp_ns)}, {"sequence", sequence}};
  Json points = Json::array();
  for (const Eigen::Vector2d& point_m : scan.points_m) {
    points.push_back(rounded(point_m.x()));
    points.push_back(rounded(point_m.y()));
  }
  json["points_robot_m"] = std::move(points);
  if (T_map_robot) set_pose(json, *T_map_robot);
  if (fits) json["fits"] = *fits;
  return text_of(json);
}

/// Whether a person must go to the robot, or find out why. A halt is an operator's own order.
bool is_alarming(msg::BaseState state, const std::optional<msg::BaseState>& before) {
  switch (state) {
    case msg::kBaseEmergencyStop:
    case msg::kBaseWatchdogExpired:
    case msg::kBaseBumped:
    case msg::kBaseMotorsOff:
      return true;
    case msg::kBaseOffline:
      return before && *before != msg::kBaseStarting;
    default:
      return false;
  }
}

}  // namespace

RobotView::RobotView(service::Service& service, ChannelHub& hub, EventLog& events, RobotHooks hooks)
    : hub_(hub), events_(events), hooks_(std::move(hooks)), service_(service) {
  service.subscribe<msg::LivePose>(
      [this](const msg::LivePose& pose, const messaging::SampleInfo& info) {
        on_pose(pose, info.stamp_ns);
      },
      {.main_input = true});
  service.subscribe<msg::Scan>([this](const msg::Scan& scan) { on_scan(scan); });
  service.subscribe<msg::NavigatorStatus>(
      [this](const msg::NavigatorStatus& status, const messaging::SampleInfo& info) {
        on_navigator(status, info);
      });
  service.subscribe<msg::Route>([this](const msg::Route& route) { on_route(route); });
  service.subscribe<msg::BaseStatus>([this](const msg::BaseStatus& base) { on_base(base); });
  service.subscribe<msg::LaserStatus>([this](const msg::LaserStatus& laser) { on_laser(laser); });
  service.subscribe<msg::GroundTruth>([this](const msg::GroundTruth& truth) { on_truth(truth); });
}

void RobotView::on_pose(const msg::LivePose& pose, std::int64_t sent_ns) {
  if (hooks_.on_pose) hooks_.on_pose(pose);
  if (!pose_ || pose_->state() != pose.state()) {
    const std::string text = std::string(name_of(pose.state())) + ": " + reason_of(pose.state());
    if (pose.state() == msg::kStateLost) {
      events_.alarm(Level::kError, "localizer", text);
    } else {
      events_.add(pose.state() == msg::kStateTracking ? Level::kInfo : Level::kWarning, "localizer",
                  text);
    }
  }
  pose_ = pose;
  pose_came_s_ = support::monotonic_s();
  Json json = {{"stamp_s", seconds(pose.stamp_ns())},
               {"sequence", pose.sequence_number()},
               {"state", name_of(pose.state())},
               {"mode", pose.mode() == msg::kModeMapping ? "mapping" : "localization"},
               {"confidence", rounded(pose.confidence())}};
  set_pose(json, service::from_msg(pose.T_map_robot()));
  Json covariance = Json::array();
  for (const double value : pose.covariance()) covariance.push_back(exact(value));
  json["covariance"] = std::move(covariance);
  json["reason"] = reason_of(pose.state());
  Json outline = Json::array();
  for (const auto& corner_m : service_.setup().config.config.navigator.guard.footprint.corners_m) {
    outline.push_back({corner_m.x(), corner_m.y()});
  }
  if (!outline.empty()) json["footprint_m"] = std::move(outline);
  json["sent_s"] = seconds(sent_ns);
  json["heard_s"] = seconds(support::wall_clock_ns());
  hub_.set(Channel::kPose, text_of(json));
  show_scan();
}

void RobotView::on_scan(const msg::Scan& message) {
  const geometry::Pose2& T_robot_laser = service_.setup().config.config.local_mapper.T_robot_laser;
  scan_ = service::to_scan_points(service::from_msg(message), T_robot_laser);
  scan_sequence_ = message.sequence_number();
  if (hooks_.on_scan) hooks_.on_scan(*scan_);
  const bool waits = pose_ && is_located(pose_->state()) &&
                     pose_->sequence_number() < scan_sequence_ &&
                     support::monotonic_s() - pose_came_s_ < kPoseAge_s;
  if (!waits) show_scan();
}

// The localizer publishes the pose of a scan a few milliseconds after the scan. Until then the scan
// waits, and the next one replaces it.
void RobotView::show_scan() {
  if (!scan_) return;
  std::optional<geometry::Pose2> T_map_robot;
  std::optional<bool> fit;
  if (!pose_ || !is_located(pose_->state())) {
    fit_.forget();
  } else if (support::monotonic_s() - pose_came_s_ < kPoseAge_s) {
    T_map_robot = service::from_msg(pose_->T_map_robot());
    fit = fits(*scan_, *T_map_robot);
  } else {
    fit = fit_.last();  // a scan without its pose proves nothing new
  }
  hub_.set_later(Channel::kScan, [scan = std::move(*scan_), sequence = scan_sequence_, T_map_robot,
                                  fit] { return scan_text(scan, sequence, T_map_robot, fit); });
  scan_.reset();
}

// While the robot maps, new floor is not on the map.
std::optional<bool> RobotView::fits(const navigation::ScanPoints& scan,
                                    const geometry::Pose2& T_map_robot) {
  const auto map = hooks_.map ? hooks_.map() : nullptr;
  if (!map || pose_->mode() == msg::kModeMapping) {
    fit_.forget();
    return std::nullopt;
  }
  if (const auto fit = scan_fit(*map, T_map_robot, scan.points_m)) fit_.add(*fit);
  return fit_.last();
}

void RobotView::on_navigator(const msg::NavigatorStatus& status,
                             const messaging::SampleInfo& info) {
  if (hooks_.on_navigator) hooks_.on_navigator(status, info);
  const std::string message = text_of_message(status.message());
  if (navigator_state_ != status.state()) {
    if (navigator_state_) {
      // Each goal waits for its route, and an operator's pause or cancel is none either.
      const bool wanted = status.reason() == msg::kHaltWaitsForRoute ||
                          status.reason() == msg::kHaltPaused ||
                          status.reason() == msg::kHaltCancelled;
      const bool trouble = !wanted && (status.state() == msg::kNavigatorBlocked ||
                                       status.state() == msg::kNavigatorStopped ||
                                       status.state() == msg::kNavigatorRelocalizing);
      const std::string text = with_reason(name_of(status.state()), message);
      if (trouble && status.reason() == msg::kHaltBaseStuck) {
        events_.alarm(Level::kWarning, "navigator", text);
      } else {
        events_.add(trouble ? Level::kWarning : Level::kInfo, "navigator", text);
      }
    }
    navigator_state_ = status.state();
  }
  if (service::goal_has_ended(status)) hub_.set(Channel::kRoute, "null");
  const Json json = {{"state", name_of(status.state())},
                     {"reason", name_of(status.reason())},
                     {"message", message},
                     {"goal_id", std::to_string(status.goal_id())},
                     {"driven_m", rounded(status.driven_m())},
                     {"rest_m", rounded(status.rest_m())},
                     {"rest_s", rounded(status.rest_s())},
                     {"linear_mps", rounded(status.linear_mps())},
                     {"angular_radps", rounded(status.angular_radps())},
                     {"free_ahead_m", rounded(status.free_ahead_m())},
                     {"detours", status.detours()},
                     {"routes", status.routes()},
                     {"guard_stops", status.guard_stops()}};
  hub_.set(Channel::kNavigator, text_of(json));
}

void RobotView::on_route(const msg::Route& route) {
  const bool found = route.status() == msg::kRouteFound;
  Json json = {{"goal_id", std::to_string(route.goal_id())},
               {"found", found},
               {"message", text_of_message(route.message())}};
  Json points = Json::array();
  for (const msg::BranchPoint& point : route.points()) {
    points.push_back(rounded(point.x_m()));
    points.push_back(rounded(point.y_m()));
  }
  json["length_m"] = rounded(route.length_m());
  json["min_clearance_m"] = rounded(route.min_clearance_m());
  json["points_m"] = std::move(points);
  if (route.has_nearest_reachable()) {
    json["nearest_reachable"] = {{"x_m", rounded(route.nearest_reachable().x_m())},
                                 {"y_m", rounded(route.nearest_reachable().y_m())}};
  }
  if (!found) {
    events_.add(Level::kWarning, "planner", "no route: " + text_of_message(route.message()));
  }
  hub_.set(Channel::kRoute, text_of(json));
}

void RobotView::on_base(const msg::BaseStatus& status) {
  const std::string reason = text_of_message(status.reason());
  const bool moves = status.state() == msg::kBaseReady || status.state() == msg::kBaseMoving;
  const bool moved =
      base_state_ && (*base_state_ == msg::kBaseReady || *base_state_ == msg::kBaseMoving);
  if (base_state_ != status.state() && !(moves && moved)) {
    const std::string text = with_reason(name_of(status.state()), reason);
    if (is_alarming(status.state(), base_state_)) {
      events_.alarm(Level::kError, "base", text);
    } else {
      events_.add(moves ? Level::kInfo : Level::kWarning, "base", text);
    }
  }
  base_state_ = status.state();
  if (!std::exchange(battery_low_, status.battery_low()) && battery_low_) {
    events_.alarm(Level::kWarning, "base", "the battery is low");
  }
  const auto percent = hooks_.battery_percent ? hooks_.battery_percent() : std::optional<double>();
  hub_.set(Channel::kBase,
           text_of(Json{{"state", name_of(status.state())},
                        {"reason", reason},
                        {"commands_taken", status.commands_taken()},
                        {"stands", status.stands()},
                        {"battery_v", rounded(status.battery_v())},
                        {"battery_low", status.battery_low()},
                        {"battery_percent", percent ? rounded(*percent) : nullptr}}));
}

void RobotView::on_laser(const msg::LaserStatus& status) {
  const std::string reason = text_of_message(status.reason());
  if (laser_state_ != status.state()) {
    const bool runs = status.state() == msg::kLaserRunning;
    const bool lost = status.state() == msg::kLaserFault || laser_state_ == msg::kLaserRunning;
    const std::string text = with_reason(name_of(status.state()), reason);
    if (!runs && lost) {
      events_.alarm(Level::kError, "laser", text);
    } else {
      events_.add(runs ? Level::kInfo : Level::kWarning, "laser", text);
    }
  }
  laser_state_ = status.state();
  hub_.set(Channel::kLaser, text_of(Json{{"state", name_of(status.state())},
                                         {"reason", reason},
                                         {"scans_per_s", rounded(status.scans_per_s())}}));
}

void RobotView::on_truth(const msg::GroundTruth& truth) {
  Json json = Json::object();
  set_pose(json, service::from_msg(truth.T_world_robot()));
  json["collisions"] = truth.collisions();
  hub_.set(Channel::kTruth, text_of(json));
}

}  // namespace topogeo::web
