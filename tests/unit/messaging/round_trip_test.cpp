// Every type passes between two participants unchanged.
#include "fixture.hpp"

namespace topogeo::messaging {
namespace {

msg::Pose2 pose(double seed) {
  msg::Pose2 result;
  result.x_m(seed);
  result.y_m(-2.0 * seed);
  result.theta_rad(0.1 * seed);
  return result;
}

msg::BranchPoint branch_point(double seed) {
  msg::BranchPoint result;
  result.x_m(seed);
  result.y_m(seed + 1.0);
  result.clearance_m(0.5);
  return result;
}

msg::Matrix3 matrix() {
  return {1.0, 0.1, 0.2, 0.1, 2.0, 0.3, 0.2, 0.3, 3.0};
}

void fill(msg::Scan& scan) {
  scan.angle_min_rad(-1.5);
  scan.angle_step_rad(0.0001);
  for (std::uint32_t i = 0; i < msg::kMaxBeams; ++i) {
    scan.ranges_m().push_back(static_cast<float>(i) * 0.01F);
  }
  scan.T_odom_robot(pose(3.0));
}

void fill(msg::Odometry& odometry) {
  odometry.T_odom_robot(pose(2.0));
  odometry.linear_mps(0.5);
  odometry.angular_radps(-0.25);
}

void fill(msg::Sonar& sonar) {
  msg::SonarEcho echo;
  echo.T_robot_sonar(pose(0.1));
  echo.range_m(1.5F);
  sonar.echoes().assign(24, echo);
}

void fill(msg::BodySensors& body) {
  msg::InfraredReading reading;
  reading.T_robot_sensor(pose(0.2));
  reading.range_m(0.25F);
  body.infrared().assign(msg::kMaxInfrared, reading);
  body.body_pressed(0x800001);
  body.body_panels(24);
  body.base_pressed(0x80000000);
  body.base_panels(32);
}

void fill(msg::BaseStatus& status) {
  status.state(msg::kBaseBumped);
  status.stands(true);
  status.battery_v(47.5F);
  status.battery_low(true);
  status.bumpers(0x8001);
  status.stop_count(~0ULL);
  set_text(status.reason(), "bumper pressed", "reason");
}

void fill(msg::LaserStatus& status) {
  status.state(msg::kLaserFault);
  status.baud(500'000);
  status.contaminated(true);
  status.dazzled_beams(3);
  msg::FaultCount drop;
  set_text(drop.reason(), "bad checksum", "reason");
  drop.count(1'000'000'007);
  status.drops().assign(msg::kMaxFaultKinds, drop);
  set_text(status.reason(), "dirty window", "reason");
}

void fill(msg::GroundTruth& truth) {
  truth.T_world_robot(pose(7.0));
  truth.linear_mps(0.4);
  truth.touching(true);
  truth.collisions(3);
}

void fill(msg::SimulatorCommand& command) {
  command.fault(msg::kSimulatedJoystick);
  command.device(msg::kSimulatedBase);
  command.duration_s(2.5);
  set_client_id(command, "tester");
}

void fill(msg::ScanRequest& request) {
  request.odometry_epoch(7);
  request.first_scan(321);
}

void fill(msg::StreamEnd& end) {
  end.stage(msg::kStageLocalMapper);
  end.count(17);
  end.last_id(16);
  end.version(5);
}

void fill(msg::RunSummary& summary) {
  summary.matches_tried(1'000);
  msg::ReasonCount reason;
  reason.reason(msg::kReasonImplausible);
  reason.matches(12);
  summary.matches_rejected().assign(6, reason);
  msg::StateCount state;
  state.state(msg::kStateLost);
  state.stops(3);
  summary.stops_by_state().assign(4, state);
  set_text(summary.message(), "2 stops are not mapped", "message");
  summary.longest_recovery_ms(12.5);
}

/// A map of a crowded hall: several hundred kilobytes, so that it is sent in fragments.
void fill(msg::LocalMap& map) {
  map.id(7);
  map.content_hash(0xFEDCBA9876543210ULL);
  map.T_previous_robot(pose(1.0));
  for (std::uint32_t i = 0; i < 200; ++i) {
    msg::LocalNode node;
    node.id(i);
    node.kind(msg::kNodeDoor);
    node.base_groups() = {1, 2, 65535};
    map.nodes().push_back(node);
    msg::LocalBranch branch;
    branch.id(i);
    branch.node_b(i + 1);
    branch.is_virtual(i % 2 == 0);
    branch.points().assign(100, branch_point(i));
    map.branches().push_back(branch);
    msg::TrackedScan tracked;
    tracked.sequence_number(i);
    tracked.T_stop_robot(pose(i));
    tracked.matched(i % 3 == 0);
    map.track().push_back(tracked);
  }
  map.points().assign(361, {});
  map.points().back().y_m(-4.25F);
}

void fill(msg::MatchTasks& tasks) {
  set_worker_id(tasks, "pc1-42");
  set_client_id(tasks, "localizer-1");
  msg::MatchTask task;
  task.task_id(99);
  task.reference_map_id(3);
  task.query_hash(~0ULL);
  task.covariance(matrix());
  task.genetic().individuals(50);
  task.fitness_form(msg::kFitnessCombined);
  task.initial_individuals().assign(3, pose(4.0));
  task.seed(0x8000000000000001ULL);
  tasks.tasks().assign(msg::kMaxTasksInMessage, task);
}

void fill(msg::MatchResults& results) {
  set_client_id(results, "localizer-1");
  msg::MatchResult result;
  result.task_id(99);
  result.status(msg::kMatchMapMissing);
  msg::MatchSolution solution;
  solution.T_reference_query(pose(1.0 / 3.0));
  solution.fitness(0.1);
  result.solutions().assign(msg::kMaxSolutions, solution);
  result.covariance(matrix());
  result.evaluations(1500);
  results.results().assign(msg::kMaxTasksInMessage, result);
}

void fill(msg::WorkerStatus& status) {
  set_worker_id(status, "pc1-42");
  status.slots(4);
  status.tasks_per_s(512.5);
  status.config_fingerprint(0x123456789ABCDEF0ULL);
}

void fill(msg::ServiceStatus& status) {
  set_service(status, "localizer", "host-1");
  status.state(msg::kServiceRunning);
  set_text(status.input(), "local_map", "input");
  status.inputs(345);
  status.input_rate_per_s(12.5);
  status.input_age_s(0.25);
  msg::Counter counter;
  set_text(counter.name(), "scans", "name");
  counter.value(1223.0);
  status.counters().assign(3, counter);
  msg::FaultCount fault;
  set_text(fault.reason(), "nan_range", "reason");
  fault.count(2);
  status.faults().assign(1, fault);
  status.drops().assign(2, fault);
  set_text(status.waits_for(), "workers", "waits_for");
  set_text(status.last_error(), "nan_range: beam 7", "last_error");
  status.last_error_age_s(1.5);
  status.config_fingerprint(0xFEDCBA9876543210ULL);
  msg::TopicTraffic traffic;
  set_text(traffic.topic(), "scan", "topic");
  traffic.sent(true);
  traffic.messages(17);
  traffic.rate_per_s(0.5);
  traffic.waiting(3);
  status.traffic().assign(2, traffic);
  msg::QueueDepth queue;
  set_text(queue.name(), "match tasks", "name");
  queue.depth(5);
  queue.capacity(64);
  status.queues().assign(1, queue);
}

void fill(msg::LivePose& live) {
  live.state(msg::kStateLost);
  live.confidence(0.25);
  live.mode(msg::kModeLocalization);
  live.T_map_robot(pose(9.0));
  live.covariance(matrix());
  live.trajectory_version(12);
}

void fill(msg::TrajectorySegment& segment) {
  segment.segment(1);
  segment.version(12);
  segment.total_stops(512);
  for (std::uint32_t i = 0; i < msg::kSegmentStops; ++i) {
    msg::StopPose stop;
    stop.local_map_id(256 + i);
    stop.T_map_robot(pose(i));
    stop.covariance(matrix());
    segment.stops().push_back(stop);
  }
}

void fill(msg::LoopClosures& closures) {
  msg::LoopClosure closure;
  closure.earlier_id(1);
  closure.later_id(200);
  closure.T_earlier_later(pose(0.5));
  closures.closures().assign(20, closure);
}

void fill(msg::LoopDecisions& decisions) {
  decisions.segment(2);
  decisions.total(3 * msg::kSegmentDecisions);
  msg::LoopDecision decision;
  decision.step(210);
  decision.earlier_id(1);
  decision.later_id(200);
  decision.outcome(msg::kLoopOutvoted);
  decision.reason(msg::kReasonFewInliers);
  set_text(decision.explanation(), "outvoted: few inliers", "explanation");
  decision.source(msg::kSourceWindow);
  decision.T_earlier_later(pose(0.5));
  decision.T_predicted(pose(0.25));
  decision.predicted_covariance(matrix());
  decision.correction_m(0.75);
  decision.probability(0.875);
  decisions.decisions().assign(msg::kSegmentDecisions, decision);
}

void fill(msg::LocalizationCommand& command) {
  command.request_id(7);
  set_client_id(command, "operator-1");
  command.kind(msg::kCommandSetPose);
  command.T_map_robot(pose(2.0));
  command.covariance(matrix());
}

void fill(msg::LocalizationReply& reply) {
  reply.request_id(7);
  set_client_id(reply, "operator-1");
  reply.accepted(true);
  set_text(reply.message(), "searching", "message");
}

void fill(msg::MergeProposal& proposal) {
  proposal.number(3);
  proposal.state(msg::kMergeRefused);
  set_text(proposal.robot(), "b", "robot");
  set_text(proposal.other_robot(), "a", "other_robot");
  proposal.T_other_own(pose(4.0));
  proposal.confidence(0.75);
}

void fill(msg::MergeAnswer& answer) {
  answer.request_id(7);
  set_client_id(answer, "operator-1");
  answer.number(3);
  answer.accepted(true);
}

void fill(msg::MapElement& element) {
  element.kind(msg::kElementBranch);
  element.id(4);
  element.map_version(12);
  element.node_a(1);
  element.node_b(2);
  element.points().assign(msg::kMaxBranchPoints, branch_point(2.0));
}

void fill(msg::SnapshotPiece& piece) {
  set_client_id(piece, "local_mapper-1");
  piece.request_id(3);
  piece.piece(1);
  piece.pieces(2);
  piece.bytes().assign(msg::kMaxPieceBytes, 0xa5);
}

void fill(msg::TrackedPose& tracked) {
  tracked.stop().session(0xfedcba9876543210ULL);
  tracked.stop().number(7);
  tracked.scan().T_odom_robot(pose(1.5));
  tracked.scan().T_stop_robot(pose(0.5));
  tracked.scan().matched(true);
}

void fill(msg::Goal& goal) {
  goal.goal_id(5);
  goal.kind(msg::kGoalPlace);
  set_text(goal.place(), "room A", "place");
  goal.target().x_m(12.5);
  goal.has_heading(true);
  goal.heading_rad(-1.5);
}

void fill(msg::Route& route) {
  route.status(msg::kRouteFound);
  route.length_m(20.0);
  route.node_ids() = {1, 5, 9};
  route.zones() = {0, 3};
  route.points().assign(5'000, branch_point(1.0));
  msg::MotionPrimitive primitive;
  primitive.kind(msg::kMotionTurnRight);
  primitive.amount(0.25);
  route.primitives().assign(100, primitive);
}

void fill(msg::Blockages& blockages) {
  blockages.version(4);
  blockages.points().resize(msg::kMaxBlockedPoints);
  blockages.points().back().y_m(-3.5);
}

void fill(msg::NavigatorStatus& status) {
  status.state(msg::kNavigatorBlocked);
  status.reason(msg::kHaltObstacle);
  status.T_map_robot(pose(2.5));
  status.rest_m(7.5);
  set_text(status.message(), "something stands in the way", "message");
}

void fill(msg::GridTile& tile) {
  tile.tile(7);
  tile.version(3);
  tile.states().assign(msg::kTileArea, 2);
  tile.zones().assign(msg::kTileArea, msg::kNoZone);
}

void fill(msg::HybridMap& map) {
  map.version(3);
  map.columns(640);
  map.rows(64);
  map.tile_versions().assign(10, 3);
  map.zones().resize(2);
  set_text(map.zones().front().name(), "hall", "name");
  map.places().resize(1);
  map.places().front().position().x_m(1.5);
  map.nodes().resize(2);
  map.edges().resize(1);
  map.edges().front().cost_m(4.5);
}

void fill(msg::DrawingOrder& order) {
  order.request_id(7);
  set_client_id(order, "page-1");
  order.kind(msg::kDrawingFloor);
  order.version(~0ULL);
  order.content().places().resize(2);
  set_text(order.content().places().back().name(), "kitchen", "name");
  order.content().zones().resize(msg::kMaxDrawnZones);
  order.content().zones().back().corners().resize(msg::kMaxDrawnPoints);
  order.content().lines().resize(msg::kMaxDrawnLines);
  order.content().lines().back().points().resize(2);
  order.content().lines().back().points().back().y_m(-3.5);
}

void fill(msg::DrawingAnswer& answer) {
  answer.result(msg::kDrawingNotDone);
  answer.version(9);
  set_text(answer.message(), "the disk is full", "message");
}

void fill(msg::MotionCommand& command) {
  command.linear_mps(0.3);
  command.valid_for_s(0.2);
}

void fill(msg::BaseCommand& command) {
  command.kind(msg::kBaseSetLimits);
  command.stop_count(~0ULL);
  command.largest_linear_mps(0.5);
  command.angular_acceleration_radps2(1.5);
  set_client_id(command, "operator");
}

void fill(msg::MapRequest& request) {
  set_client_id(request, "localizer-1");
  set_worker_id(request, "pc1-42");
  request.map_id(3);
  request.content_hash(~0ULL);
}

void fill(msg::MapCopy& copy) {
  set_worker_id(copy, "pc1-42");
  copy.local_map(message<msg::LocalMap>());
  fill(copy.local_map());
}

/// A type of which only the header is set.
template <class T>
void fill(T& /*message*/) {}

template <class T>
class RoundTrip : public TwoParticipants {};

template <class First, class... Rest>
struct AllBut {
  using Types = ::testing::Types<Rest...>;
};
#define TOPOGEO_TOPIC(Type, name, role, replay_role, addressee) , msg::Type
using AllTypes = AllBut<void
#include "topogeo/messaging/topics.def"
                        >::Types;
TYPED_TEST_SUITE(RoundTrip, AllTypes);

TYPED_TEST(RoundTrip, ArrivesUnchanged) {
  Writer<TypeParam> writer(this->sender_);
  Reader<TypeParam> reader(this->receiver_);
  ASSERT_TRUE(wait_for_peers(writer));
  ASSERT_TRUE(wait_for_peers(reader));
  auto sent = message<TypeParam>(123);
  fill(sent);

  ASSERT_TRUE(writer.write(sent));

  ASSERT_TRUE(wait_for_data(reader));
  int received = 0;
  reader.take([&](const TypeParam& got, const SampleInfo& info) {
    ++received;
    EXPECT_TRUE(info.valid);
    EXPECT_TRUE(got == sent);
    EXPECT_NE(info.writer, Handle{});
    EXPECT_NE(info.instance, Handle{});
  });
  EXPECT_EQ(received, 1);
}

TEST_F(TwoParticipants, WriteRefusesWhatBreaksTheContract) {
  Writer<msg::Scan> writer(sender_);
  EXPECT_THROW(static_cast<void>(writer.write(msg::Scan{})), std::invalid_argument);  // no version
  auto scan = message<msg::Scan>();
  scan.ranges_m().resize(msg::kMaxBeams + 1);
  EXPECT_THROW(static_cast<void>(writer.write(scan)), std::invalid_argument);
  scan.ranges_m().resize(msg::kMaxBeams);
  EXPECT_TRUE(writer.write(scan));

  Writer<msg::LocalMap> maps(sender_);
  auto map = message<msg::LocalMap>();
  map.branches().resize(1);
  map.branches().front().points().resize(msg::kMaxBranchPoints + 1);
  EXPECT_THROW(static_cast<void>(maps.write(map)), std::invalid_argument);
}

TEST_F(TwoParticipants, WriteChecksEnumerationsAndMembers) {
  const auto expect_refused = [](auto& writer, const auto& message, const std::string& defect) {
    try {
      static_cast<void>(writer.write(message));
      ADD_FAILURE() << "not refused: " << defect;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(defect), std::string::npos) << error.what();
    }
  };
  Writer<msg::MapCopy> copies(sender_);
  auto copy = message<msg::MapCopy>();
  expect_refused(copies, copy, "local_map.schema_version 0, expected");
  copy.local_map(message<msg::LocalMap>());
  copy.local_map().nodes().resize(2);
  copy.local_map().nodes().back().kind(static_cast<msg::NodeKind>(77));
  expect_refused(copies, copy, "local_map.nodes.kind is 77, expected 0 to 5");
  copy.local_map().nodes().back().kind(msg::kNodeHallCorridor);
  EXPECT_TRUE(copies.write(copy));

  copy.worker_key(key_of("another"));
  expect_refused(copies, copy, ": worker_key does not match ''");

  Writer<msg::Goal> goals(sender_);
  auto goal = message<msg::Goal>();
  goal.robot_key(0);
  expect_refused(goals, goal, ": robot_key does not match '");
  set_robot_id(goal, "robot");
  goal.kind(static_cast<msg::GoalKind>(msg::kGoalResume + 1));
  expect_refused(goals, goal, ": kind is ");
}

TEST(Message, TextOverItsBoundIsAnErrorOrCutAtACharacter) {
  msg::Scan scan;
  EXPECT_NO_THROW(set_robot_id(scan, std::string(32, 'a')));
  EXPECT_EQ(scan.robot_id().to_string(), std::string(32, 'a'));
  EXPECT_THROW(set_robot_id(scan, std::string(33, 'a')), std::invalid_argument);
  EXPECT_THROW(set_robot_id(scan, std::string_view("a\0b", 3)), std::invalid_argument);
  set_text_cut(scan.robot_id(), std::string(31, 'a') + "\u00e4");  // two bytes: 31 + 2 > 32
  EXPECT_EQ(scan.robot_id().to_string(), std::string(31, 'a'));
}

}  // namespace
}  // namespace topogeo::messaging
