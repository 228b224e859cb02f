// One pool of workers serves several robots: one that floods it does not keep the others waiting,
// and maps of one id stay apart.
#include <atomic>
#include <memory>
#include <mutex>
#include <thread>

#include "pool_fixture.hpp"

namespace topogeo::test {
namespace {

using localization::MatchTask;

/// The same stops as another robot saw them, which saw less.
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

/// The localizer's end of the pool of one robot, in the thread that makes it.
class Robot {
 public:
  Robot(const std::string& name, Maps maps)
      : maps_(std::move(maps)), participant_(options_in(random_partition())) {
    localizer::RemotePoolOptions options;
    options.robot_id = name;
    options.client_id = "client-" + name + "-" + std::to_string(std::random_device{}());
    options.version = support::kVersion;
    options.board.straggler_floor = kPatience;
    options.log = [](const std::string&) {};
    pool_.emplace(participant_, loop_, options,
                  [this](std::string_view why, std::string_view) { faults.emplace_back(why); });
    for (const auto& map : maps_) pool_->add_map(map);
  }

  /// True when the workers gave what this process makes of the tasks.
  bool match(const std::vector<MatchTask>& tasks) {
    const std::vector<localization::MatchResult> results = pool_->match(tasks);
    localization::InProcessPool in_process;
    for (const auto& map : maps_) in_process.add_map(map);
    const std::vector<localization::MatchResult> expected = in_process.match(tasks);
    return std::equal(results.begin(), results.end(), expected.begin(), expected.end(),
                      [](const auto& a, const auto& b) { return localization::identical(a, b); });
  }
  localizer::RemotePool& pool() { return *pool_; }
  [[nodiscard]] const Maps& maps() const { return maps_; }

  std::vector<std::string> faults;

 private:
  Maps maps_;
  messaging::Participant participant_;
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

  /// In any thread: Fast DDS makes the participants of one process one at a time.
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

// The flood is work for seconds, a small batch for milliseconds: served in turn, the modest robots
// are through with twenty of them, one after the other, long before it has ebbed away.
TEST_F(FairnessTest, ARobotThatFloodsThePoolStarvesNoOther) {
  constexpr std::size_t kFlood = 600;
  constexpr std::size_t kSmall = 3;
  constexpr std::uint64_t kBatches = 20;
  const Maps maps = maps_of_room();
  std::atomic<bool> floods{false};
  std::atomic<bool> ebbed_away{false};
  std::atomic<bool> flood_is_right{false};
  std::atomic<std::uint64_t> flood_searched_here{1};
  std::thread flood([&] {
    const auto robot = make_robot("greedy", maps);
    if (robot->pool().wait_for_workers(2, kPatience) < 2) return;
    std::vector<MatchTask> tasks = tasks_on(robot->maps(), kFlood);
    for (MatchTask& task : tasks) task.genetic.generations = 400;  // of 10 ms and more
    floods = true;
    const auto results = robot->pool().match(tasks);
    ebbed_away = true;
    flood_searched_here = robot->pool().counts().in_process;
    flood_is_right = results.size() == kFlood && robot->faults.empty();
  });
  struct Modest {
    std::uint64_t right = 0;
    std::uint64_t while_it_flooded = 0;
    std::vector<std::string> faults;
  };
  std::vector<Modest> modest(2);
  std::vector<std::thread> others;
  for (std::size_t i = 0; i < modest.size(); ++i) {
    others.emplace_back([&, i] {
      const auto robot =
          make_robot("modest" + std::to_string(i), i == 0 ? maps : seen_by_another(maps));
      if (robot->pool().wait_for_workers(2, kPatience) < 2) return;
      while (!floods) std::this_thread::yield();
      for (std::uint64_t batch = 0; batch < kBatches; ++batch) {
        const bool right = robot->match(tasks_on(robot->maps(), kSmall, kSmall * batch));
        modest[i].right += right ? 1 : 0;
        modest[i].while_it_flooded += ebbed_away ? 0 : 1;
      }
      modest[i].faults = robot->faults;
    });
  }
  for (std::thread& other : others) other.join();
  flood.join();
  for (const Modest& robot : modest) {
    EXPECT_EQ(robot.right, kBatches);
    EXPECT_EQ(robot.while_it_flooded, kBatches);
    EXPECT_THAT(robot.faults, ::testing::IsEmpty());
  }
  EXPECT_TRUE(flood_is_right);
  EXPECT_EQ(flood_searched_here, 0U);
}

}  // namespace
}  // namespace topogeo::test
