// One pool of workers serves several robots: a robot that floods it does not delay the others, and
// maps with the same id stay separate.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "pool_fixture.hpp"

namespace topogeo::test {
namespace {

using localization::MatchTask;

/// The same stops from another robot with fewer points.
Maps seen_by_another(const Maps& maps) {
  Maps out;
  for (const auto& map : maps) {
    auto other = std::make_shared<topomap::LocalMap>(*map);
    other->robot_id = "other";
    other->points.resize(other->points.size() - 20);
    out.push_back(std::move(other));
  }
  return out;
}

/// The localizer's end of the pool for one robot, in the thread that creates it.
class Robot {
 public:
  Robot(const std::string& name, Maps maps)
      : maps_(std::move(maps)),
        participant_(options_in(random_partition())),
        map_writer_(participant_),
        worker_statuses_(participant_) {
    loop_.add<msg::WorkerStatus>(worker_statuses_, [this](const auto& status, const auto&) {
      maps_held_[status.worker_id().to_string()] = status.maps_held();
    });
    localizer::RemotePoolOptions options;
    options.robot_id = name;
    options.client_id = "client-" + name + "-" + std::to_string(std::random_device{}());
    options.version = support::kVersion;
    options.board.straggler_floor = hang_limit();
    options.log = [](const std::string&) {};
    pool_.emplace(participant_, loop_, options,
                  [this](std::string_view why, std::string_view) { faults.emplace_back(why); });
    for (const auto& map : maps_) pool_->add_map(map);
  }

  /// Results of this process for the tasks.
  [[nodiscard]] std::vector<localization::MatchResult> match_here(
      const std::vector<MatchTask>& tasks) const {
    localization::InProcessPool in_process;
    for (const auto& map : maps_) in_process.add_map(map);
    return in_process.match(tasks);
  }
  /// Publishes the maps and waits until so many workers hold them. A worker waits two seconds for a
  /// map that a task names, and then gives the task back.
  bool give_maps(std::ptrdiff_t workers) {
    for (const auto& map : maps_) {
      if (!map_writer_.write(service::to_msg(*map))) return false;
    }
    return wait_in_loop(loop_, "the maps at the workers", [&] {
      return std::ranges::count_if(maps_held_, [this](const auto& worker) {
               return worker.second >= maps_.size();
             }) >= workers;
    });
  }
  localizer::RemotePool& pool() { return *pool_; }
  [[nodiscard]] const Maps& maps() const { return maps_; }

  std::vector<std::string> faults;

 private:
  Maps maps_;
  messaging::Participant participant_;
  messaging::Writer<msg::LocalMap> map_writer_;
  messaging::Reader<msg::WorkerStatus> worker_statuses_;
  std::map<std::string, std::size_t> maps_held_;  // by worker
  messaging::EventLoop loop_;
  std::optional<localizer::RemotePool> pool_;
};

class FairnessTest : public ::testing::Test {
 protected:
  FairnessTest() {
    for (const char* name : {"w1", "w2"}) {
      workers_.push_back(std::make_unique<Program>(
          scratch_, "ga_worker",
          std::vector<std::string>{"--domain", own_domain(), "--name", name}));
    }
  }

  /// Works in any thread: Fast DDS creates the participants of one process one at a time.
  std::unique_ptr<Robot> make_robot(const std::string& name, const Maps& maps) {
    const std::lock_guard lock(making_);
    return std::make_unique<Robot>(name, maps);
  }

  const bool udp_only_ = (use_udp_only(), true);
  Scratch scratch_;
  std::vector<std::unique_ptr<Program>> workers_;

 private:
  std::mutex making_;
};

bool identical(const std::vector<localization::MatchResult>& found,
               const std::vector<localization::MatchResult>& expected) {
  return std::equal(found.begin(), found.end(), expected.begin(), expected.end(),
                    [](const auto& a, const auto& b) { return localization::identical(a, b); });
}

// Floods of a second's work follow each other until the modest robots have finished twenty small
// batches in sequence. If a batch waited for the end of the previous flood, there would be as many
// floods as batches, however fast the machine is; when served in turn, all twenty batches together
// see a few.
TEST_F(FairnessTest, ARobotThatFloodsThePoolStarvesNoOther) {
  constexpr std::size_t kFlood = 300;
  constexpr std::size_t kSmall = 3;
  constexpr std::uint64_t kBatches = 20;
  constexpr std::uint64_t kMostFloods = kBatches / 4;
  const Maps maps = maps_of_room();
  std::atomic<bool> floods{false};
  std::atomic<std::uint64_t> ebbed_away{0};
  std::atomic<int> modest_under_way{2};
  std::atomic<bool> flood_ended{false};
  std::atomic<bool> flood_is_right{false};
  std::atomic<std::uint64_t> flood_searched_here{1};
  std::thread flood([&] {
    const auto robot = make_robot("greedy", maps);
    if (!wait_for_workers(robot->pool(), 2) || !robot->give_maps(2)) {
      flood_ended = true;
      return;
    }
    std::vector<MatchTask> tasks = tasks_on(robot->maps(), kFlood);
    for (MatchTask& task : tasks) task.genetic.generations = 400;  // 10 ms or more for each task
    floods = true;
    bool right = true;
    while (modest_under_way > 0) {
      right = robot->pool().match(tasks).size() == kFlood && right;
      ++ebbed_away;
    }
    flood_searched_here = robot->pool().counts().in_process;
    flood_is_right = right && robot->faults.empty();
  });
  struct Modest {
    std::uint64_t right = 0;
    std::uint64_t floods_seen = 0;
    std::vector<std::string> faults;
  };
  std::vector<Modest> modest(2);
  std::vector<std::thread> others;
  for (std::size_t i = 0; i < modest.size(); ++i) {
    others.emplace_back([&, i] {
      const auto robot =
          make_robot("modest" + std::to_string(i), i == 0 ? maps : seen_by_another(maps));
      std::vector<std::vector<localization::MatchResult>> expected;
      for (std::uint64_t batch = 0; batch < kBatches; ++batch)
        expected.push_back(robot->match_here(tasks_on(robot->maps(), kSmall, kSmall * batch)));
      if (wait_for_workers(robot->pool(), 2)) {
        while (!floods && !flood_ended) std::this_thread::yield();
        const std::uint64_t before = ebbed_away;
        for (std::uint64_t batch = 0; batch < kBatches; ++batch) {
          const auto found = robot->pool().match(tasks_on(robot->maps(), kSmall, kSmall * batch));
          modest[i].right += identical(found, expected[batch]) ? 1 : 0;
        }
        modest[i].floods_seen = ebbed_away - before;
      }
      modest[i].faults = robot->faults;
      --modest_under_way;
    });
  }
  for (std::thread& other : others) other.join();
  flood.join();
  for (const Modest& robot : modest) {
    EXPECT_EQ(robot.right, kBatches);
    EXPECT_LE(robot.floods_seen, kMostFloods);
    EXPECT_THAT(robot.faults, ::testing::IsEmpty());
  }
  EXPECT_TRUE(flood_is_right);
  EXPECT_EQ(flood_searched_here, 0U);
}

}  // namespace
}  // namespace topogeo::test
