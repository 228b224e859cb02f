#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <fastdds/dds/topic/TypeSupport.hpp>

#include "topogeo/map_client/map_follower.hpp"
#include "topogeo/matching/matcher.hpp"
#include "topogeo/matching/place_field.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/topics.hpp"
#include "topogeo/msg/types.h"
#include "topogeo/navigation/navigator.hpp"
#include "topogeo/pipeline/local_mapper.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/planning/zones.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/decision_assembly.hpp"
#include "topogeo/service/drawing_conversions.hpp"
#include "topogeo/service/hybrid_map_messages.hpp"
#include "topogeo/service/hybrid_map_mirror.hpp"
#include "topogeo/service/navigation_conversions.hpp"
#include "topogeo/storage/map_file.hpp"

#include "address_filter.hpp"
#include "checks.hpp"
#include "map_store/drawing_order.hpp"
#include "map_store/map_input.hpp"
#include "payload.hpp"
#include "planner/answer.hpp"

namespace topogeo::fuzz {
namespace {

constexpr std::int64_t kNow_ns = 1'000'000'000'000;
/// A larger search would take most of the time and test nothing else.
constexpr std::uint64_t kMostEvaluations = 4096;

/// A room of 4 x 6 m, seen from inside.
scan::Scan scan_of_room() {
  scan::Scan scan;
  scan.stamp_ns = kNow_ns;
  scan.angle_min_rad = -1.57;
  scan.angle_step_rad = 0.0349;
  for (int i = 0; i < 91; ++i) {
    const double angle_rad = scan.angle_min_rad + i * scan.angle_step_rad;
    const double to_front_m = 4.0 / std::max(1e-3, std::cos(angle_rad));
    const double to_side_m =
        (angle_rad > 0.0 ? 3.5 : 2.5) / std::max(1e-3, std::abs(std::sin(angle_rad)));
    scan.ranges_m.push_back(static_cast<float>(std::min(to_front_m, to_side_m)));
  }
  return scan;
}

topomap::LocalMap map_of_room() {
  pipeline::LocalMapper mapper({}, "robot");
  return mapper.add(scan_of_room()).value();
}

const topomap::LocalMap& room() {
  static const topomap::LocalMap map = map_of_room();
  return map;
}

/// A match task in the room, against a map beside it.
localization::MatchTask task_with(const topomap::LocalMap& query) {
  localization::MatchTask task;
  task.reference_map_id = room().id;
  task.query_map_id = query.id;
  task.reference_hash = topomap::content_hash(room());
  task.query_hash = topomap::content_hash(query);
  task.covariance = Eigen::Vector3d(0.1, 0.1, 0.01).asDiagonal();
  task.half_width = {1.0, 1.0, 0.3};
  task.genetic.individuals = 16;
  task.genetic.generations = 4;
  return task;
}

topomap::LocalMap second_room() {
  topomap::LocalMap map = room();
  map.id = map.stop.number = 1;
  return map;
}

void match(const localization::MatchTask& task, const topomap::LocalMap& query) {
  localization::Matcher matcher;
  matcher.add_map(room());
  matcher.add_map(query);
  const localization::MatchResult result = matcher.solve(task);
  require(std::isfinite(result.fitness) && result.covariance.allFinite() &&
              std::isfinite(result.T_reference_query.x_m),
          "the result of a match is finite");
  require(matcher.verify(task, result).empty(), "what a worker finds it finds right");
}

/// Two rooms with a door between them.
const std::shared_ptr<const planning::HybridMap>& floor_pointer() {
  static const auto map = [] {
    planning::GridFrame frame;
    frame.columns = 40;
    frame.rows = 30;
    planning::OccupancyGrid grid(frame, planning::CellState::kUnknown);
    for (std::int32_t row = 1; row < 29; ++row) {
      for (std::int32_t column = 1; column < 39; ++column) {
        const bool wall = row == 1 || row == 28 || column == 1 || column == 38 ||
                          (column == 20 && (row < 12 || row > 20));
        grid.set({column, row}, wall ? planning::CellState::kOccupied : planning::CellState::kFree);
      }
    }
    const planning::FreeSpace space(std::move(grid), {0.5, false});
    return std::make_shared<const planning::HybridMap>(
        space, planning::zones_by_width(space), std::vector<planning::Place>{{"left", {0.5, 1.0}}});
  }();
  return map;
}

const planning::HybridMap& floor() {
  return *floor_pointer();
}

template <class Input>
void navigate(const Input& input) {
  navigation::Navigator navigator({});
  navigator.set_map(floor_pointer(), 1);
  navigator.set_goal({1, false});
  navigator.add(navigation::OdometrySample{kNow_ns, {}});
  navigator.add(input);
  for (std::int64_t i = 0; i < 3; ++i) {
    const geometry::Velocity velocity = navigator.step(kNow_ns + i * 50'000'000);
    require(std::isfinite(velocity.linear_m_per_s) && std::isfinite(velocity.angular_rad_per_s),
            "velocities are finite");
  }
}

// Handling of valid messages in the receivers. Most throw std::invalid_argument.

template <class Message>
void receive(const Message& /*message*/) {}  // only displayed

/// A floor with any accepted drawing must be usable for planning.
void plan_on_drawing(const storage::MapDrawing& drawing) {
  const planning::FreeSpace space(floor().space().grid(), {0.5, false}, drawing.zones,
                                  drawing.lines);
  const planning::HybridMap map(space, planning::drawn_zones(space, {}));
  const service::HybridMapMessages messages = service::to_messages(map, "robot", kNow_ns, 1);
  require(messages.summary.rules().size() >= drawing.lines.size(), "lines travel with the map");
}

void receive(const msg::DrawingState& message) {
  plan_on_drawing(service::from_msg(message.content()));
}

void receive(const msg::DrawingOrder& message) {
  storage::MapDrawing now;
  now.version = message.version();
  // Cells of a metre, because a floor has no size limit.
  const map_store::DrawingOutcome outcome = map_store::carry_out(message, now, 1.0);
  require(outcome.drawing.has_value() == (outcome.result == msg::kDrawingDone),
          "an order is carried out or refused");
}

void receive(const msg::FloorOrder& message) {
  plan_on_drawing(service::from_msg(message.content()));
}

void receive(const msg::Scan& message) {
  const scan::Scan scan = service::from_msg(message);
  navigate(service::to_scan_points(scan, {}));
  pipeline::LocalMapper mapper({}, "robot");
  static_cast<void>(mapper.add(scan_of_room()));
  static_cast<void>(mapper.add(scan));
  if (const auto map = mapper.finish()) static_cast<void>(service::to_msg(*map));
}

void receive(const msg::Odometry& message) {
  navigate(service::odometry_from_msg(message));
}

void receive(const msg::Sonar& message) {
  navigate(service::sonar_from_msg(message));
}

void receive(const msg::BaseStatus& message) {
  navigate(service::base_from_msg(message));
}

void receive(const msg::LivePose& message) {
  navigate(service::to_pose_fix(service::from_msg(message)));
}

void receive(const msg::NavigatorStatus& message) {
  static_cast<void>(service::from_msg(message));
}

void receive(const msg::TrackedPose& message) {
  static_cast<void>(service::from_msg(message));
}

void receive(const msg::LocalMap& message) {
  const topomap::LocalMap map =
      service::content_from_msg(message);  // no random change keeps the hash
  map_store::MapInput input;
  static_cast<void>(input.add(map));
  topomap::LocalMap query = map;
  query.id = 1;
  match(task_with(query), query);
}

void receive(const msg::MapCopy& message) {
  receive(message.local_map());
}

void receive_task(const msg::MatchTask& message) {
  localization::MatchTask task = service::from_msg(message);
  const topomap::LocalMap query = second_room();
  if (task.places) {
    const std::vector pieces{std::make_shared<const topomap::LocalMap>(room()),
                             std::make_shared<const topomap::LocalMap>(query)};
    const localization::PlaceField field(pieces, *task.places);
    static_cast<void>(field.answer(*task.places));
    return;
  }
  const localization::MatchTask known = task_with(query);
  task.reference_map_id = known.reference_map_id;
  task.query_map_id = known.query_map_id;
  task.reference_hash = known.reference_hash;
  task.query_hash = known.query_hash;
  if (std::uint64_t{task.genetic.individuals} * task.genetic.generations > kMostEvaluations) return;
  match(task, query);
}

void receive(const msg::MatchTasks& message) {
  // One task covers as much as many, in less time.
  if (!message.tasks().empty()) receive_task(message.tasks().front());
}

void receive_result(const msg::MatchResult& message) {
  if (message.status() > msg::kMatchNothingInCommon) return;
  const topomap::LocalMap query = second_room();
  localization::Matcher matcher;
  matcher.add_map(room());
  matcher.add_map(query);
  static_cast<void>(matcher.verify(task_with(query), service::from_msg(message)));
}

void receive(const msg::MatchResults& message) {
  if (!message.results().empty()) receive_result(message.results().front());
}

template <class Message>
void receive_in_store(const Message& message) {
  map_store::MapInput input;
  static_cast<void>(input.add(room()));
  input.add(message);
  const topomap::Trajectory trajectory = input.newest_trajectory();
  require(trajectory.stops.size() <= 1, "a trajectory has the stops whose maps are here");
  static_cast<void>(input.usable_closures());
  static_cast<void>(input.usable_edges());
  static_cast<void>(input.final_trajectory());
}

void receive(const msg::TrajectorySegment& message) {
  receive_in_store(message);
}
void receive(const msg::LoopClosures& message) {
  receive_in_store(message);
}
void receive(const msg::MapEdges& message) {
  receive_in_store(message);
}

void receive(const msg::LoopDecisions& message) {
  service::DecisionAssembly assembly;
  assembly.add(message);
  require(assembly.all().size() <= message.decisions().size(), "no decision is made up");
}

void receive(const msg::MapElement& message) {
  map_client::MapFollower follower(message.robot_id().to_string());
  static_cast<void>(follower.put(message, {1}, {2}));
  if (message.kind() == msg::kElementNode) static_cast<void>(service::node_from_msg(message));
  if (message.kind() == msg::kElementBranch) static_cast<void>(service::branch_from_msg(message));
  if (follower.map() != nullptr) static_cast<void>(service::from_elements(*follower.map()));
}

service::HybridMapMirror mirror_of_floor() {
  service::HybridMapMirror mirror;
  const service::HybridMapMessages messages = service::to_messages(floor(), "robot", kNow_ns, 1);
  for (const msg::GridTile& tile : messages.tiles) {
    messaging::Handle handle;
    handle.bytes[0] = static_cast<std::uint8_t>(tile.tile());
    mirror.put(tile, handle);
  }
  mirror.put(messages.summary);
  return mirror;
}

void receive(const msg::GridTile& message) {
  service::HybridMapMirror mirror = mirror_of_floor();
  mirror.put(message, {});
  static_cast<void>(mirror.map());
}

void receive(const msg::HybridMap& message) {
  service::HybridMapMirror mirror = mirror_of_floor();
  mirror.put(message);
  static_cast<void>(mirror.map());
}

void receive(const msg::Goal& message) {
  static_cast<void>(service::from_msg(message));
  service::LivePose pose;
  pose.status.state = localization::LocalizationState::kTracking;
  pose.T_map_robot = {0.5, 0.5, 0.0};
  static_cast<void>(planner::answer(message, {.hybrid = &floor()}, pose, {}));
}

void receive(const msg::Route& message) {
  const navigation::RoutePlan plan = service::route_plan_from_msg(message, &floor());
  navigation::Navigator navigator({});
  navigator.set_map(floor_pointer(), plan.map_version);
  navigator.set_goal({plan.goal_id, false});
  navigator.set_route(plan);
  navigation::PoseFix fix;
  fix.stamp_ns = kNow_ns;
  fix.tracking = fix.located = true;
  fix.T_map_robot = {0.5, 0.5, 0.0};
  for (std::int64_t i = 0; i < 3; ++i) {
    const std::int64_t now_ns = kNow_ns + i * 50'000'000;
    navigator.add(navigation::OdometrySample{now_ns, {}});
    if (i == 0) navigator.add(fix);
    const geometry::Velocity velocity = navigator.step(now_ns);
    require(std::isfinite(velocity.linear_m_per_s) && std::isfinite(velocity.angular_rad_per_s),
            "velocities are finite");
  }
}

void receive(const msg::Blockages& message) {
  const navigation::BlockageReport report = service::from_msg(message);
  service::LivePose pose;
  pose.status.state = localization::LocalizationState::kTracking;
  pose.T_map_robot = {0.5, 0.5, 0.0};
  msg::Goal goal;
  goal.kind(msg::kGoalPlace);
  messaging::set_text(goal.place(), "left", "place");
  static_cast<void>(planner::answer(goal, {.hybrid = &floor()}, pose, report.points_m));
}

void receive(const msg::LocalizationCommand& message) {
  static_cast<void>(service::from_msg(message));
}

void receive(const msg::SnapshotPiece& message) {
  try {
    static_cast<void>(storage::parse_local_maps(
        std::string(message.bytes().begin(), message.bytes().end()), "snapshot"));
  } catch (const std::runtime_error&) {  // NOLINT(bugprone-empty-catch): what it promises
  }
}

template <class Message>
std::size_t check_bytes(std::string_view bytes) {
  const messaging::TopicInfo& topic = messaging::TopicTraits<Message>::info();
  eprosima::fastdds::dds::TypeSupport type(topic.make_type());
  Arrived input(bytes);
  static_cast<void>(messaging::AddressFilter("worker").evaluate(input.payload, {}, {}));
  Message message;
  require(messaging::detail::read_payload(type, input.payload, &message),
          "a reader is never left with a sample");
  if (topic.find_defect(&message)) return 0;
  messaging::detail::make_key(type, &message);
  const std::string sent = written_payload(message, type);
  Message again;
  Arrived arrived(sent);
  require(messaging::detail::read_payload(type, arrived.payload, &again),
          "what was sent can be read");
  require(written_payload(again, type) == sent, "sending what was read changes nothing");
  try {
    receive(message);
  } catch (const std::invalid_argument&) {
    return 1;
  }
  return 2;
}

// A valid message for each topic; without a special form it is empty.

template <class Message>
void fill(Message& /*message*/) {}

service::MatchAddress sender() {
  service::MatchAddress address;
  address.robot_id = "robot";
  return address;
}

void fill(msg::Scan& message) {
  message = service::to_msg(scan_of_room(), "robot");
}

void fill(msg::Sonar& message) {
  message.echoes().resize(2);
  for (msg::SonarEcho& echo : message.echoes()) {
    echo.range_m(1.5F);
    echo.half_cone_rad(0.2F);
  }
}

void fill(msg::LocalMap& message) {
  message = service::to_msg(room());
}

void fill(msg::MapCopy& message) {
  message.local_map(service::to_msg(room()));
}

void fill(msg::MatchTasks& message) {
  message = service::tasks_for(sender());
  message.tasks().push_back(service::to_msg(task_with(second_room()), kNow_ns));
}

void fill(msg::MatchResults& message) {
  const topomap::LocalMap query = second_room();
  localization::Matcher matcher;
  matcher.add_map(room());
  matcher.add_map(query);
  message = service::results_for(sender());
  message.results().push_back(service::to_msg(matcher.solve(task_with(query))));
}

void fill(msg::TrajectorySegment& message) {
  topomap::Trajectory trajectory;
  trajectory.version = 1;
  topomap::StopPose& stop = trajectory.stops.emplace_back();
  stop.stop = room().stop;
  stop.views = 1;
  message = service::to_segment(trajectory, 0, "robot", 0);
}

void fill(msg::LoopClosures& message) {
  message = service::to_msg(std::vector<topomap::LoopClosure>{{0, 1, {}}}, 1, "robot", kNow_ns, 0);
}

void fill(msg::MapEdges& message) {
  storage::MapEdge edge;
  edge.later_id = 1;
  message = service::to_segment(std::vector{edge}, 0, 1, "robot", kNow_ns, 0);
}

void fill(msg::LoopDecisions& message) {
  localization::LoopDecision decision;
  decision.later_id = 1;
  message = service::to_segment(std::vector{decision}, 0, "robot", kNow_ns, 0);
}

void fill(msg::MapElement& message) {
  message.kind(msg::kElementBranch);
  message.points().resize(2);
}

void fill(msg::GridTile& message) {
  message = service::to_messages(floor(), "robot", kNow_ns, 1).tiles.front();
}

void fill(msg::HybridMap& message) {
  message = service::to_messages(floor(), "robot", kNow_ns, 1).summary;
}

void fill(msg::Goal& message) {
  message.kind(msg::kGoalPlace);
  messaging::set_text(message.place(), "left", "place");
}

void fill(msg::Route& message) {
  service::LivePose pose;
  pose.status.state = localization::LocalizationState::kTracking;
  pose.T_map_robot = {0.5, 0.5, 0.0};
  msg::Goal goal;
  goal.target().x_m(1.5);
  goal.target().y_m(0.5);
  message = planner::answer(goal, {.hybrid = &floor()}, pose, {});
}

msg::DrawingContent sample_drawing_content() {
  storage::MapDrawing drawing;
  drawing.places = {{"left", {0.5, 1.0}}, {"base station", {1.0, 1.0}, 1.5}};
  drawing.zones = {{"wet", {{0.5, 0.5}, {1.0, 0.5}, {1.0, 1.0}}, planning::ZoneKind::kNoGo},
                   {"ramp", {{2.5, 0.5}, {3.0, 0.5}, {3.0, 1.0}}, planning::ZoneKind::kSlow, 0.3}};
  drawing.lines = {{planning::LineKind::kWall, {{0.0, 0.0}, {3.0, 0.0}, {3.0, 2.5}, {0.0, 2.5}}},
                   {planning::LineKind::kOpening, {{3.0, 1.0}, {3.0, 2.0}}},
                   {planning::LineKind::kDoor, {{2.0, 1.2}, {2.0, 2.0}}, "door"}};
  return service::to_msg(drawing);
}

void fill(msg::DrawingState& message) {
  message.version(7);
  message.content(sample_drawing_content());
}

void fill(msg::DrawingOrder& message) {
  message.kind(msg::kDrawingFloor);
  message.version(7);
  message.inside().x_m(1.5);
  message.inside().y_m(1.5);
  message.content(sample_drawing_content());
}

void fill(msg::FloorOrder& message) {
  messaging::set_text(message.name(), "new floor", "name");
  message.content(sample_drawing_content());
}

void fill(msg::LocalizationCommand& message) {
  message.covariance(service::to_msg(Eigen::Matrix3d(Eigen::Matrix3d::Identity())));
}

void fill(msg::Blockages& message) {
  message.points().resize(2);
}

template <class Message>
std::string sample_message() {
  Message message;
  fill(message);
  messaging::set_header(message, "robot", kNow_ns, 0);
  eprosima::fastdds::dds::TypeSupport type(messaging::TopicTraits<Message>::info().make_type());
  return written_payload(message, type);
}

#define TOPOGEO_TOPIC(Type, name, role, replay_role, addressee) \
  {name, check_bytes<msg::Type>, sample_message<msg::Type>},
constexpr MessageKind kTopics[] = {
#include "topogeo/messaging/topics.def"
};

}  // namespace

std::size_t check_message(std::string_view bytes) {
  return check_named(kTopics, bytes);
}

std::vector<std::string> sample_messages() {
  return sample_inputs(kTopics);
}

}  // namespace topogeo::fuzz
