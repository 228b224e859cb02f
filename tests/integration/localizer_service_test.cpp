// The localizer as a process: local maps in any order in, the trajectory of one process out.
#include <algorithm>
#include <csignal>

#include "topogeo/msg/sensor.h"
#include "topogeo/msg/store.h"
#include "topogeo/msg/stream.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/service/trajectory_assembly.hpp"
#include "topogeo/slam/pose_graph_slam.hpp"
#include "topogeo/storage/map_file.hpp"

#include "pool_fixture.hpp"
#include "waiting.hpp"

namespace topogeo::test {
namespace {

class LocalizerTest : public ::testing::Test {
 protected:
  LocalizerTest() {
    loop_.add<msg::TrajectorySegment>(segments_, [this](const auto& message, const auto&) {
      EXPECT_TRUE(assembly_.add(message));
    });
    loop_.add<msg::LoopClosures>(
        closures_, [this](const auto& message, const auto&) { last_closures_ = message; });
    loop_.add<msg::LivePose>(poses_,
                             [this](const auto& message, const auto&) { last_pose_ = message; });
    loop_.add<msg::StreamEnd>(ends_in_, [this](const auto& message, const auto&) {
      if (message.stage() == msg::kStageLocalizer) end_ = message;
    });
    loop_.add<msg::ServiceStatus>(
        statuses_, [this](const auto& message, const auto&) { last_status_ = message; });
  }

  std::unique_ptr<Program> start(const std::string& name, std::vector<std::string> words = {}) {
    if (name == "localizer") words.emplace_back("--standalone");
    words.insert(words.end(), {"--domain", own_domain(), "--partition", partition_});
    return std::make_unique<Program>(scratch_, name, words);
  }
  void publish(const topomap::LocalMap& map) {
    ASSERT_TRUE(map_writer_.write(service::to_msg(map)));
  }
  void end_stream() {
    msg::StreamEnd end;
    messaging::set_header(end, "robot", maps_.back()->stamp_ns, 0);
    end.stage(msg::kStageLocalMapper);
    end.count(maps_.size());
    ASSERT_TRUE(ends_out_.write(end));
  }
  bool wait_until(const std::string& what, const std::function<bool()>& condition) {
    return wait_in_loop(loop_, what, condition);
  }
  double counter(const std::string& name) const {
    for (const msg::Counter& c : last_status_->counters()) {
      if (c.name().to_string() == name) return c.value();
    }
    return -1.0;
  }
  void expect_result_of_one_process() {
    localization::InProcessPool pool;
    localization::PoseGraphSlam slam({}, pool);
    for (const auto& map : maps_) slam.add(map);
    slam.finish();
    const topomap::Trajectory expected = slam.trajectory();
    const auto got = assembly_.whole(end_->version());
    ASSERT_TRUE(got) << "not all segments came before the end with its version";
    EXPECT_EQ(end_->count(), maps_.size());
    EXPECT_EQ(got->version, expected.version);
    ASSERT_EQ(got->stops.size(), expected.stops.size());
    for (std::size_t i = 0; i < expected.stops.size(); ++i) {
      EXPECT_EQ(got->stops[i].T_map_robot, expected.stops[i].T_map_robot) << i;
      EXPECT_EQ(got->stops[i].covariance, expected.stops[i].covariance) << i;
    }
    const std::vector<topomap::LoopClosure> loops = slam.loop_closures();
    EXPECT_EQ(last_closures_->version(), expected.version);
    ASSERT_EQ(last_closures_->closures().size(), loops.size());
    ASSERT_TRUE(wait_until("the localizer to be finished",
                           [&] { return last_status_->state() == msg::kServiceFinished; }));
    EXPECT_EQ(counter("stops"), static_cast<double>(maps_.size()));
    EXPECT_EQ(counter("tasks"), static_cast<double>(slam.counts().tasks));
    EXPECT_EQ(counter("accepted"), static_cast<double>(slam.counts().reasons[0]));
    EXPECT_EQ(counter("loop_closures"), static_cast<double>(loops.size()));
    EXPECT_EQ(last_status_->fault_count(), 0U) << last_status_->message().to_string();
  }

  // A killed program leaves segments in /dev/shm that others may still wait at.
  const bool udp_only_ = (use_udp_only(), true);
  std::string partition_ = random_partition();
  Scratch scratch_;
  Maps maps_ = maps_of_room();
  messaging::Participant participant_{options_in(partition_)};
  messaging::Writer<msg::LocalMap> map_writer_{participant_};
  messaging::Writer<msg::Odometry> odometry_writer_{participant_};
  messaging::Writer<msg::StreamEnd> ends_out_{participant_};
  messaging::Reader<msg::TrajectorySegment> segments_{participant_};
  messaging::Reader<msg::LoopClosures> closures_{participant_};
  messaging::Reader<msg::LivePose> poses_{participant_};
  messaging::Reader<msg::StreamEnd> ends_in_{participant_};
  messaging::Reader<msg::ServiceStatus> statuses_{participant_};
  messaging::EventLoop loop_;
  service::TrajectoryAssembly assembly_;
  std::optional<msg::LoopClosures> last_closures_;
  std::optional<msg::LivePose> last_pose_;
  std::optional<msg::StreamEnd> end_;
  std::optional<msg::ServiceStatus> last_status_;
};

TEST_F(LocalizerTest, MapsInAnyOrderGiveTheTrajectoryOfOneProcess) {
  const auto localizer = start("localizer");
  // Sends the end first, then the maps from last to first: a race of topics must lose nothing.
  end_stream();
  for (auto map = maps_.rbegin(); map != maps_.rend(); ++map) publish(**map);
  ASSERT_TRUE(wait_until("the end of the stream", [&] { return end_.has_value(); }));
  expect_result_of_one_process();
  EXPECT_EQ(counter("tasks_in_process"), counter("tasks"));
  localizer->send_signal(SIGTERM);
  EXPECT_EQ(localizer->wait(), 0) << localizer->err();
}

TEST_F(LocalizerTest, WorkersThatItWaitedForDoAllTheMatching) {
  const auto localizer = start("localizer", {"--wait-workers", "2", "--wait-seconds", "600"});
  for (const auto& map : maps_) publish(*map);
  end_stream();
  const auto one = start("ga_worker", {"--name", "one"});
  const auto two = start("ga_worker", {"--name", "two", "--slots", "2"});
  ASSERT_TRUE(wait_until("the end of the stream", [&] { return end_.has_value(); }));
  expect_result_of_one_process();
  EXPECT_GT(counter("tasks_sent"), 0.0);
  const std::string log = localizer->err();
  EXPECT_THAT(log, ::testing::Not(::testing::HasSubstr("no worker, searching in this process")))
      << "it has not waited";
  // On a busy machine a worker may answer too late, be taken to be gone, or get a map too late.
  const auto in_log = [&log](const char* text) { return log.find(text) != std::string::npos; };
  const bool in_time = !in_log("no worker answers, ") && !in_log("no worker left, ") &&
                       !in_log(" stalled with ") && !in_log(" lost with ") &&
                       counter("maps_missing") == 0.0;
  EXPECT_TRUE(!in_time || counter("tasks_in_process") == 0.0) << log;
}

TEST_F(LocalizerTest, WithoutTheWorkersItGoesOnAfterAWhile) {
  const auto localizer = start("localizer", {"--wait-workers", "3", "--wait-seconds", "0.2"});
  for (const auto& map : maps_) publish(*map);
  end_stream();
  ASSERT_TRUE(wait_until("the end of the stream", [&] { return end_.has_value(); }));
  expect_result_of_one_process();
  EXPECT_THAT(localizer->err(), ::testing::HasSubstr("0 of 3 workers joined within 0.2 s"));
}

// Odometry has ended by then.
TEST_F(LocalizerTest, AReaderThatComesAfterTheLogGetsTheLastPose) {
  const auto localizer = start("localizer");
  for (const auto& map : maps_) publish(*map);
  end_stream();
  ASSERT_TRUE(test::wait_for(
      "the end of the localizer", [&] { return end_.has_value(); },
      [&] { loop_.run_for(std::chrono::milliseconds(5)); }))
      << localizer->err();
  const messaging::Reader<msg::LivePose> late(participant_);
  std::optional<std::int64_t> stamp_ns;
  loop_.add<msg::LivePose>(
      late, [&](const auto& message, const auto&) { stamp_ns = message.stamp_ns(); });
  ASSERT_TRUE(test::wait_for(
      "a pose for the late reader", [&] { return stamp_ns.has_value(); },
      [&] { loop_.run_for(std::chrono::milliseconds(5)); }))
      << localizer->err();
  EXPECT_EQ(*stamp_ns, maps_.back()->stamp_ns);
}

TEST_F(LocalizerTest, TheLivePoseFollowsTheOdometryBetweenStops) {
  const auto localizer = start("localizer");
  publish(*maps_[0]);
  ASSERT_TRUE(wait_until("the first trajectory", [&] { return assembly_.version() == 1; }));
  ASSERT_TRUE(wait_until("a reader of odometry", [&] { return odometry_writer_.matched() > 0; }));
  const geometry::Pose2 moved{0.4, -0.1, 0.2};
  msg::Odometry odometry;
  messaging::set_header(odometry, "robot", maps_[0]->stamp_ns + 1, 9);
  odometry.T_odom_robot(service::to_msg(maps_[0]->T_odom_robot * moved));
  ASSERT_TRUE(odometry_writer_.write(odometry));
  ASSERT_TRUE(wait_until("the pose of the odometry",
                         [&] { return last_pose_ && last_pose_->sequence_number() == 9; }));
  const service::LivePose pose = service::from_msg(*last_pose_);
  EXPECT_EQ(pose.status.state, localization::LocalizationState::kTracking);
  EXPECT_EQ(pose.mode, msg::kModeMapping);
  EXPECT_EQ(pose.last_stop.number, 0U);
  EXPECT_NEAR(pose.T_map_robot.x_m, 0.4, 1e-12);
  EXPECT_NEAR(pose.T_map_robot.y_m, -0.1, 1e-12);
  EXPECT_NEAR(pose.T_map_robot.theta_rad, 0.2, 1e-12);
  EXPECT_GT(pose.covariance(0, 0), 0.0);
}

/// A map of the room, and a localizer that starts when the sender of the local maps no longer keeps
/// the first half.
class LateLocalizer : public LocalizerTest {
 protected:
  LateLocalizer() {
    pipeline::MappingRun run({}, "robot");
    const world::World world =
        world::load_world(std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml");
    for (const scan::Scan& scan : simulation::simulate_log(world, {}).scans) run.add(scan);
    storage::write_map_file(map_file_, run.finish());
    loop_.add<msg::StoredMap>(stored_in_,
                              [this](const auto& message, const auto&) { stored_ = message; });
  }

  std::unique_ptr<Program> start_late(std::vector<std::string> words) {
    for (std::size_t i = 0; i < maps_.size() / 2; ++i) {
      map_writer_.dispose(service::to_msg(*maps_[i]));
    }
    words.insert(words.end(),
                 {"--map", map_file_, "--domain", own_domain(), "--partition", partition_});
    return std::make_unique<Program>(scratch_, "localizer", words);
  }

  const std::filesystem::path map_file_ = scratch_ / "map.pb";
  messaging::Reader<msg::StoredMap> stored_in_{participant_};
  std::optional<msg::StoredMap> stored_;
};

TEST_F(LateLocalizer, GetsTheFirstStopsOfALogFromTheMapStore) {
  const auto store = start("map_store", {"--out", scratch_ / "out"});
  for (const auto& map : maps_) publish(*map);
  ASSERT_TRUE(wait_until("the map store to have all stops",
                         [&] { return stored_ && stored_->session_stops() == maps_.size(); }));
  const auto localizer = start_late({"--replay"});
  end_stream();
  ASSERT_TRUE(wait_until("the end of the stream", [&] { return end_.has_value(); }))
      << localizer->err();
  EXPECT_EQ(end_->count(), maps_.size());
  ASSERT_TRUE(wait_until("the localizer to be finished",
                         [&] { return last_status_->state() == msg::kServiceFinished; }));
  EXPECT_EQ(last_status_->fault_count(), 0U);
}

// It receives the robot's present odometry while it adds the stops of the drive again.
TEST_F(LateLocalizer, SaysNoPoseBeforeItHasAddedTheStopsAgain) {
  const auto store = start("map_store", {"--out", scratch_ / "out"});
  for (const auto& map : maps_) publish(*map);
  ASSERT_TRUE(wait_until("the map store to have all stops",
                         [&] { return stored_ && stored_->session_stops() == maps_.size(); }));
  localization::InProcessPool pool;
  localization::PoseGraphSlam expected({}, pool);
  for (const auto& map : maps_) expected.add(map);
  const geometry::Pose2 T_map_robot = expected.last_stop()->T_map_robot;
  double furthest_m = 0.0;
  bool any = false;
  messaging::Reader<msg::LivePose> poses(participant_);
  loop_.add<msg::LivePose>(poses, [&](const msg::LivePose& message, const auto&) {
    const geometry::Pose2 pose = service::from_msg(message).T_map_robot;
    furthest_m = std::max(furthest_m, (pose.position_m() - T_map_robot.position_m()).norm());
    any = true;
  });
  const auto worker = start("ga_worker");  // while it answers, odometry is heard
  const Program localizer(scratch_, "localizer",
                          {"--wait-workers", "1", "--wait-seconds", "600", "--domain", own_domain(),
                           "--partition", partition_});
  std::uint64_t sequence = maps_.back()->sequence;
  ASSERT_TRUE(wait_until("all stops to be added again", [&] {
    msg::Odometry odometry;
    messaging::set_header(odometry, "robot", maps_.back()->stamp_ns + 1, ++sequence);
    odometry.T_odom_robot(service::to_msg(maps_.back()->T_odom_robot));
    EXPECT_TRUE(odometry_writer_.write(odometry));
    return any && last_status_ && counter("stops") == static_cast<double>(maps_.size());
  })) << localizer.err();
  EXPECT_LT(furthest_m, 0.1);
}

TEST_F(LateLocalizer, GoesOnWithoutThemWhereNothingIsStored) {
  const auto store = start("map_store", {"--map", map_file_});
  for (const auto& map : maps_) publish(*map);
  ASSERT_TRUE(wait_until("a stored map", [&] { return stored_.has_value(); }));
  EXPECT_EQ(stored_->session(), msg::kNothingIsStored);
  EXPECT_EQ(stored_->session_stops(), 0U);
  const auto localizer = start_late({"--replay"});
  end_stream();
  ASSERT_TRUE(wait_until("the end of the stream", [&] { return end_.has_value(); }))
      << localizer->err();
  EXPECT_EQ(end_->count(), maps_.size() - maps_.size() / 2);
  ASSERT_TRUE(wait_until("the localizer to be finished",
                         [&] { return last_status_->state() == msg::kServiceFinished; }));
  ASSERT_EQ(last_status_->faults().size(), 1U);
  EXPECT_EQ(last_status_->faults()[0].reason().to_string(), "local maps missing");
}

TEST_F(LateLocalizer, NeedsNoneOfThemWhileTheRobotDrives) {
  for (const auto& map : maps_) publish(*map);
  const auto localizer = start_late({});  // without a map store
  end_stream();
  ASSERT_TRUE(wait_until("the end of the stream", [&] { return end_.has_value(); }))
      << localizer->err();
  EXPECT_EQ(end_->count(), maps_.size() - maps_.size() / 2);
  ASSERT_TRUE(wait_until("the localizer to be finished",
                         [&] { return last_status_->state() == msg::kServiceFinished; }));
  EXPECT_EQ(last_status_->fault_count(), 0U);
}

TEST_F(LocalizerTest, AStopWhileItWaitsForWorkersOrMapsEndsItCleanly) {
  const auto waiting = start("localizer", {"--wait-workers", "1", "--wait-seconds", "600"});
  ASSERT_TRUE(wait_until("a status", [&] { return last_status_.has_value(); }));
  waiting->send_signal(SIGINT);
  EXPECT_EQ(waiting->wait(), 0) << waiting->err();
}

TEST_F(LocalizerTest, AStopWhileAWorkerHangsEndsItCleanly) {
  FakeWorker hanging(partition_, loop_, "hanging", [](FakeWorker&, const msg::MatchTask&) {});
  const auto localizer = start("localizer", {"--wait-workers", "1", "--wait-seconds", "600"});
  for (const auto& map : maps_) publish(*map);
  ASSERT_TRUE(wait_until("a task", [&] { return hanging.received > 0; }));
  localizer->send_signal(SIGTERM);
  EXPECT_EQ(localizer->wait(), 0) << localizer->err();
  EXPECT_FALSE(end_);
}

}  // namespace
}  // namespace topogeo::test
