// A running localizer that is ordered to stop mapping, and to map again.
#include <csignal>

#include "topogeo/msg/stream.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/service/trajectory_assembly.hpp"
#include "topogeo/session/mapping_session.hpp"

#include "pool_fixture.hpp"

namespace topogeo::test {
namespace {

/// Gives a localizer its local maps one by one, each after the previous one was processed, so that
/// the test controls after which stop a command comes.
class SwitchTest : public ::testing::Test {
 protected:
  SwitchTest() {
    loop_.add<msg::TrajectorySegment>(
        segments_, [this](const auto& message, const auto&) { assembly_.add(message); });
    loop_.add<msg::LivePose>(poses_,
                             [this](const auto& message, const auto&) { last_pose_ = message; });
    loop_.add<msg::LocalizationReply>(
        replies_, [this](const auto& message, const auto&) { last_reply_ = message; });
    loop_.add<msg::StreamEnd>(ends_in_, [this](const auto& message, const auto&) {
      if (message.stage() == msg::kStageLocalizer) end_ = message;
    });
  }

  void start(std::vector<std::string> words = {}) {
    words.insert(words.end(),
                 {"--standalone", "--domain", own_domain(), "--partition", partition_});
    localizer_ = std::make_unique<Program>(scratch_, "localizer", words);
    ASSERT_TRUE(wait_until("the localizer",
                           [&] { return commands_.matched() > 0 && replies_.matched() > 0; }));
  }
  bool wait_until(const std::string& what, const std::function<bool()>& condition) {
    return wait_in_loop(loop_, what, condition);
  }
  /// Sends the stops [from, to), each after the previous one was processed.
  void drive(std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      ASSERT_TRUE(map_writer_.write(service::to_msg(*maps_.at(i))));
      ASSERT_TRUE(wait_until("the pose at the stop", [&] {
        return last_pose_ && last_pose_->last_stop().number() == i &&
               last_pose_->stamp_ns() == maps_[i]->stamp_ns;
      })) << i;
    }
  }
  std::string send_command(msg::LocalizationCommandKind kind) {
    ++requests_;
    return send_again(kind);
  }
  /// Repeats the request with the last number.
  std::string send_again(msg::LocalizationCommandKind kind) {
    service::LocalizationCommand command;
    command.kind = kind;
    command.client_id = "test";
    command.request_id = requests_;
    last_reply_.reset();
    EXPECT_TRUE(commands_.write(service::to_msg(command, "robot", 0, requests_)));
    EXPECT_TRUE(wait_until("a reply",
                           [&] { return last_reply_ && last_reply_->request_id() == requests_; }));
    if (!last_reply_) return "no reply";
    return (last_reply_->accepted() ? "accepted: " : "refused: ") +
           last_reply_->message().to_string();
  }
  void end_stream(std::size_t count) {
    msg::StreamEnd end;
    messaging::set_header(end, "robot", maps_.back()->stamp_ns, 0);
    end.stage(msg::kStageLocalMapper);
    end.count(count);
    ASSERT_TRUE(ends_out_.write(end));
    ASSERT_TRUE(wait_until("the end of the stream", [&] { return end_.has_value(); }));
    ASSERT_TRUE(wait_until("the whole trajectory",
                           [&] { return assembly_.whole(end_->version()).has_value(); }));
  }
  [[nodiscard]] std::size_t stops_in_map() const { return assembly_.newest().stops.size(); }

  // A killed program leaves segments in /dev/shm that others may still wait at.
  const bool udp_only_ = (use_udp_only(), true);
  std::string partition_ = random_partition();
  Scratch scratch_;
  Maps maps_ = maps_of_room();
  messaging::Participant participant_{options_in(partition_)};
  messaging::Writer<msg::LocalMap> map_writer_{participant_};
  messaging::Writer<msg::LocalizationCommand> commands_{participant_};
  messaging::Writer<msg::StreamEnd> ends_out_{participant_};
  messaging::Reader<msg::TrajectorySegment> segments_{participant_};
  messaging::Reader<msg::LivePose> poses_{participant_};
  messaging::Reader<msg::LocalizationReply> replies_{participant_};
  messaging::Reader<msg::StreamEnd> ends_in_{participant_};
  messaging::EventLoop loop_;
  service::TrajectoryAssembly assembly_;
  std::optional<msg::LivePose> last_pose_;
  std::optional<msg::LocalizationReply> last_reply_;
  std::optional<msg::StreamEnd> end_;
  std::uint64_t requests_ = 0;
  std::unique_ptr<Program> localizer_;
};

TEST_F(SwitchTest, TheMapStopsGrowingAndGoesOn) {
  const std::size_t end = maps_.size();
  const std::size_t leave = end / 2;
  const std::size_t resume = leave + 4;
  ASSERT_GT(end, resume + 4);
  start();
  EXPECT_EQ(send_command(msg::kCommandSwitchToMapping), "refused: it already extends a map");
  EXPECT_EQ(send_command(msg::kCommandSwitchToLocalization), "refused: there is no map yet");
  drive(0, leave);
  EXPECT_EQ(send_command(msg::kCommandSwitchToLocalization),
            "accepted: the map of " + std::to_string(leave) + " stops stays unchanged");
  EXPECT_EQ(send_again(msg::kCommandSwitchToLocalization),
            "accepted: the map of " + std::to_string(leave) + " stops stays unchanged")
      << "carried out once, told as often as it is asked for";
  ASSERT_TRUE(wait_until("the map to stay as it is", [&] { return stops_in_map() == leave; }));
  const std::uint64_t version = assembly_.version();
  drive(leave, resume);
  EXPECT_EQ(last_pose_->mode(), msg::kModeLocalization);
  EXPECT_EQ(last_pose_->state(), msg::kStateTracking);
  EXPECT_EQ(stops_in_map(), leave);
  EXPECT_EQ(assembly_.version(), version);
  EXPECT_EQ(send_command(msg::kCommandSwitchToLocalization),
            "refused: it already localizes in a finished map");
  EXPECT_EQ(send_command(msg::kCommandSwitchToMapping),
            "accepted: new stops extend the map of " + std::to_string(leave) + " stops");
  drive(resume, end);
  EXPECT_EQ(last_pose_->mode(), msg::kModeMapping);
  end_stream(end);
  EXPECT_EQ(end_->count(), leave + (end - resume));

  // The same commands after the same stops in one process.
  localization::InProcessPool pool;
  localization::MappingSession session({}, pool);
  for (std::size_t i = 0; i < end; ++i) {
    if (i == leave) session.stop_mapping();
    if (i == resume) session.resume_mapping();
    session.add(maps_[i]);
  }
  session.finish();
  const topomap::Trajectory expected = session.trajectory();
  const auto got = assembly_.whole(end_->version());
  ASSERT_EQ(got->stops.size(), expected.stops.size());
  for (std::size_t i = 0; i < expected.stops.size(); ++i) {
    EXPECT_EQ(got->stops[i].T_map_robot, expected.stops[i].T_map_robot) << i;
    EXPECT_EQ(got->stops[i].stop.number, i < leave ? i : i - leave + resume) << i;
  }
  localizer_->send_signal(SIGTERM);
  EXPECT_EQ(localizer_->wait(), 0) << localizer_->err();
}

TEST_F(SwitchTest, StopsOfTheMeantimeAreInNoMapWhenTheLogEndsInIt) {
  const std::size_t leave = maps_.size() / 2;
  start();
  drive(0, leave);
  EXPECT_THAT(send_command(msg::kCommandSwitchToLocalization), ::testing::HasSubstr("accepted"));
  drive(leave, leave + 3);
  end_stream(leave + 3);
  EXPECT_EQ(end_->count(), leave);
  EXPECT_EQ(send_command(msg::kCommandSwitchToMapping), "refused: the log has ended");
}

}  // namespace
}  // namespace topogeo::test
