// Events about peers.
#include <algorithm>
#include <csignal>
#include <optional>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

#include "fixture.hpp"

namespace topogeo::messaging {
namespace {

using Events = TwoParticipants;

template <class Endpoint>
bool eventually_event(Endpoint& endpoint, EventKind kind, std::vector<Event>& all) {
  return test::wait_for("an event of that kind", [&] {
    endpoint.take_events([&](const Event& event) { all.push_back(event); });
    return std::any_of(all.begin(), all.end(), [&](const Event& e) { return e.kind == kind; });
  });
}

TEST_F(Events, IncompatibleQosIsToldToBothSides) {
  // Role command offers volatile durability, role state requests transient-local.
  Writer<msg::Goal> writer(sender_, "command");
  Reader<msg::Goal> reader(receiver_);
  std::vector<Event> at_reader;
  std::vector<Event> at_writer;
  ASSERT_TRUE(eventually_event(reader, EventKind::kIncompatibleQos, at_reader));
  ASSERT_TRUE(eventually_event(writer, EventKind::kIncompatibleQos, at_writer));
  EXPECT_EQ(at_reader.front().topic, kGoal);
  EXPECT_NE(at_reader.front().detail.find("durability"), std::string::npos);
  EXPECT_EQ(reader.matched(), 0);
}

TEST_F(Events, WriterThatLeavesLeavesItsInstancesWithoutWriters) {
  Reader<msg::WorkerStatus> reader(receiver_);
  std::optional<Handle> instance;
  std::optional<Handle> peer;
  {
    Writer<msg::WorkerStatus> writer(sender_);
    auto status = message<msg::WorkerStatus>();
    set_worker_id(status, "one");
    ASSERT_TRUE(writer.write(status));
    ASSERT_TRUE(test::wait_for("the first sample", [&] {
      reader.take([&](const msg::WorkerStatus&, const SampleInfo& info) {
        instance = info.instance;
        peer = info.writer;
      });
      return instance.has_value();
    }));
  }
  std::vector<Event> events;
  ASSERT_TRUE(eventually_event(reader, EventKind::kUnmatched, events));
  EXPECT_EQ(events.back().peer, peer);
  std::vector<SampleInfo> gone;
  EXPECT_TRUE(test::wait_for("the instance to be gone", [&] {
    reader.take([&](const msg::WorkerStatus&, const SampleInfo& info) { gone.push_back(info); });
    reader.take_events([](const Event&) {});
    return !gone.empty();
  }));
  ASSERT_EQ(gone.size(), 1U);
  EXPECT_FALSE(gone.front().valid);
  EXPECT_EQ(gone.front().state, InstanceState::kNoWriters);
  EXPECT_EQ(gone.front().instance, instance);
}

/// Runs `writer` of this test program in a process of its own until it is killed.
class WorkerProcess {
 public:
  explicit WorkerProcess(const std::string& partition) : pid_(::fork()) {
    if (pid_ != 0) return;
    ::setenv("TOPOGEO_TEST_WORKER_PARTITION", partition.c_str(), 1);
    ::execl("/proc/self/exe", "unit_messaging", "--gtest_filter=WorkerProcess.DISABLED_Main",
            "--gtest_also_run_disabled_tests", nullptr);
    ::_exit(127);
  }
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;
  ~WorkerProcess() { kill(); }
  void kill() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }

 private:
  pid_t pid_;
};

TEST(WorkerProcess, DISABLED_Main) {
  const char* partition = std::getenv("TOPOGEO_TEST_WORKER_PARTITION");
  if (partition == nullptr) GTEST_SKIP() << "started by the test below only";
  // Ends itself when the test that should kill it is gone.
  ::alarm(static_cast<unsigned>(test::hang_limit().count()));
  const Participant participant(options_in(partition));
  Writer<msg::WorkerStatus> writer(participant);
  auto status = message<msg::WorkerStatus>();
  set_worker_id(status, "killed");
  ASSERT_TRUE(writer.write(status));
  while (true) ::pause();
}

// Its lease of 10 s ends first.
TEST(Lease, KilledProcessIsReportedAndItsInstancesAreGone) {
  const std::string partition = random_partition();
  WorkerProcess worker(partition);
  const Participant participant(options_in(partition));
  Reader<msg::WorkerStatus> reader(participant);
  EventLoop loop;
  std::optional<Handle> instance;
  std::optional<Handle> gone;
  std::vector<EventKind> kinds;
  loop.add<msg::WorkerStatus>(
      reader,
      [&](const msg::WorkerStatus& status, const SampleInfo& info) {
        EXPECT_EQ(status.worker_id().to_string(), "killed");
        instance = info.instance;
        worker.kill();
      },
      [&](const SampleInfo& info) {
        EXPECT_EQ(info.state, InstanceState::kNoWriters);
        gone = info.instance;
        loop.stop();
      });
  loop.on_event([&](const Event& event) { kinds.push_back(event.kind); });

  EXPECT_TRUE(run_to_stop(loop));

  EXPECT_TRUE(instance.has_value());
  EXPECT_EQ(gone, instance);
  EXPECT_NE(std::find(kinds.begin(), kinds.end(), EventKind::kUnmatched), kinds.end());
}

}  // namespace
}  // namespace topogeo::messaging
