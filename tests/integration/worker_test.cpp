// Real search workers and clients with different requests, each test in a domain of its own,
// because a worker serves every partition unless a flag restricts it.
#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>
#include <numeric>
#include <random>
#include <vector>

#include "topogeo/pipeline/config.hpp"
#include "topogeo/support/host.hpp"

#include "program.hpp"
#include "worker_client.hpp"

namespace topogeo::test {
namespace {

using localization::MatchTask;
using search_pool::room;
using search_pool::task;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class WorkerTest : public ::testing::Test {
 protected:
  std::unique_ptr<Program> start(std::vector<std::string> words = {}) {
    words.insert(words.end(), {"--name", name_, "--domain", domain_});
    return std::make_unique<Program>(scratch_, "ga_worker", words);
  }
  std::unique_ptr<WorkerClient> client(const std::string& partition = "topogeo") {
    const std::string id = "client-" + name_ + "-" + std::to_string(++clients_);
    return std::make_unique<WorkerClient>(domain_, partition, id);
  }
  /// Expects that the result equals that of a matcher in this process, bit for bit. The task is
  /// sent again when this process, on a busy machine, has sent a map later than the worker waits
  /// for it.
  static void expect_right(WorkerClient& client, const MatchTask& task, const MapPointer& reference,
                           const MapPointer& query) {
    ASSERT_TRUE(client.wait_until("the result", [&] {
      const auto found = client.results.find(task.task_id);
      if (found == client.results.end()) return false;
      if (found->second.status() != msg::kMatchMapMissing) return true;
      client.results.erase(found);
      client.send(client.answered_by.at(task.task_id), task);
      return false;
    }));
    localization::Matcher matcher;
    matcher.add_map(*reference);
    matcher.add_map(*query);
    const msg::MatchResult& message = client.results.at(task.task_id);
    ASSERT_LE(message.status(), msg::kMatchNothingInCommon) << message.message().to_string();
    const localization::MatchResult expected = matcher.solve(task);
    EXPECT_EQ(expected.status, localization::MatchStatus::kSolved);
    EXPECT_TRUE(search_pool::same(service::from_msg(message), expected));
  }
  msg::MatchResult refusal(WorkerClient& client, const std::string& worker, std::uint64_t id) {
    client.send(worker, task(*zero_, *one_, id));
    EXPECT_TRUE(client.wait_until("the refusal", [&] { return client.results.contains(id); }));
    return client.results[id];
  }

  /// Publishes both maps and waits until all found workers hold them. A worker waits two seconds
  /// for a map that a task names, and then gives the task back.
  void publish_both(WorkerClient& client) const {
    client.publish(zero_);
    client.publish(one_);
    ASSERT_TRUE(client.wait_until("both maps at the workers", [&] {
      return std::ranges::all_of(client.workers,
                                 [](const auto& worker) { return worker.second.maps_held() >= 2; });
    }));
  }

  static std::string random_name() {
    std::random_device device;
    return "t" + std::to_string(device());
  }

  const bool udp_only_ = (use_udp_only(), true);
  Scratch scratch_;
  std::string domain_ = own_domain();
  std::string name_ = random_name();
  int clients_ = 0;
  MapPointer zero_ = room(0, 0.0);
  MapPointer one_ = room(1, 0.2);
};

TEST_F(WorkerTest, TwoOfOneNameAreTwo) {
  const auto first = start();
  const auto second = start();
  const auto peer = client();
  ASSERT_TRUE(peer->wait_until("two workers", [&] { return peer->named(name_).size() == 2; }));
  ASSERT_TRUE(peer->reach(2));
  publish_both(*peer);
  std::uint64_t id = 0;
  for (const std::string& worker : peer->named(name_)) {
    EXPECT_THAT(worker, ::testing::StartsWith(name_ + "#"));
    const MatchTask one_task = task(*zero_, *one_, id++);
    peer->send(worker, one_task);
    expect_right(*peer, one_task, zero_, one_);
    EXPECT_EQ(peer->answered_by.at(one_task.task_id), worker);
  }
}

TEST_F(WorkerTest, HasTheLocalMapsOfBeforeItsTimeFromEveryPartition) {
  for (const char* partition : {"topogeo", "run-7-abc"}) {
    const auto peer = client(partition);
    peer->publish(zero_);
    peer->publish(one_);
    const auto process = start();
    const std::string worker = peer->find(name_);
    const MatchTask wanted = task(*zero_, *one_, 1);
    // Waits for the map count in the status, so that the requests do not matter here.
    ASSERT_TRUE(peer->wait_until("the worker to hold two maps",
                                 [&] { return peer->workers[worker].maps_held() == 2; }));
    peer->send(worker, wanted);
    expect_right(*peer, wanted, zero_, one_);
    EXPECT_THAT(peer->requests, IsEmpty());
    process->send_signal(SIGTERM);
    EXPECT_EQ(process->wait(), 0);
    EXPECT_TRUE(peer->wait_until("the worker to be gone", [&] { return peer->workers.empty(); }));
  }
}

TEST_F(WorkerTest, ServesRunsWhoseRobotsAndMapsHaveTheSameNames) {
  const auto process = start();
  const auto live = client("topogeo");
  const auto run = client("run-7-abc");
  const std::string worker = live->find(name_);
  ASSERT_EQ(run->find(name_), worker);
  const MapPointer other_zero = room(0, 0.1);
  const MapPointer other_one = room(1, 0.4);
  // When two maps with one key arrive together, the worker may keep only the last, and asks.
  live->answer_requests(worker, {zero_, one_});
  run->answer_requests(worker, {other_zero, other_one});
  live->publish(zero_);
  run->publish(other_zero);
  live->publish(one_);
  run->publish(other_one);
  for (std::uint64_t id = 0; id < 4; ++id) {
    live->send(worker, task(*zero_, *one_, id));
    run->send(worker, task(*other_zero, *other_one, id));
  }
  // Both must answer requests until both have their results.
  ASSERT_TRUE(live->wait_until("the results of both clients", [&] {
    run->run_loop();
    return live->results.size() == 4 && run->results.size() == 4;
  }));
  for (std::uint64_t id = 0; id < 4; ++id) {
    expect_right(*live, task(*zero_, *one_, id), zero_, one_);
    expect_right(*run, task(*other_zero, *other_one, id), other_zero, other_one);
  }
  // The worker counts the clients of the last seconds, so both keep sending.
  std::uint64_t asked = 4;
  EXPECT_TRUE(live->wait_until("a status with both clients", [&] {
    run->run_loop();
    if (live->results.size() == asked && run->results.size() == asked) {
      live->send(worker, task(*zero_, *one_, asked));
      run->send(worker, task(*other_zero, *other_one, asked++));
    }
    return live->workers[worker].clients() == 2;
  }));
  EXPECT_EQ(live->workers[worker].maps_held(), 4U);
}

TEST_F(WorkerTest, APartitionRestrictsIt) {
  const auto process = start({"--partition", "mine"});
  const auto mine = client("mine");
  const auto other = client("other");
  ASSERT_NE(mine->find(name_), "");
  // A later worker that serves every partition is found in the other one, too.
  name_ = random_name();
  const auto everywhere = start();
  ASSERT_NE(other->find(name_), "");
  EXPECT_THAT(other->workers, ::testing::SizeIs(1));
}

TEST_F(WorkerTest, AsksForAMapThatItLacksUntilItHasTheRightOne) {
  const auto process = start();
  const auto peer = client();
  const std::string worker = peer->find(name_);
  peer->publish(zero_);
  peer->publish(room(1, 0.5));  // the requested id, but another map
  int damaged = 0;
  peer->on_request = [&](const msg::MapRequest& request) {
    EXPECT_EQ(request.worker_id().to_string(), worker);
    EXPECT_EQ(request.content_hash(),
              topomap::content_hash(request.map_id() == 0 ? *zero_ : *one_));
    msg::LocalMap map = service::to_msg(request.map_id() == 0 ? *zero_ : *one_);
    // The worker refuses a copy with a wrong hash and requests it again.
    if (request.map_id() == 1 && damaged++ == 0) map.points()[0].x_m(-1.0F);
    peer->send_copy(worker, map);
  };
  const MatchTask wanted = task(*zero_, *one_, 1);
  peer->send(worker, wanted);
  expect_right(*peer, wanted, zero_, one_);
  EXPECT_GE(damaged, 2);
  process->wait_for_error_text("invalid map copy");
}

TEST_F(WorkerTest, SaysThatAMapIsMissingWhenItDoesNotCome) {
  const auto process = start();
  const auto peer = client();
  const std::string worker = peer->find(name_);
  peer->publish(zero_);
  const msg::MatchResult result = refusal(*peer, worker, 1);
  EXPECT_EQ(result.status(), msg::kMatchMapMissing);
  EXPECT_THAT(result.message().to_string(), HasSubstr("local map 1 ("));
  EXPECT_TRUE(peer->wait_until("the third request", [&] { return peer->requests.size() >= 3; }));
  EXPECT_TRUE(peer->wait_until("the failure to be counted",
                               [&] { return peer->workers[worker].failures() == 1; }));
  EXPECT_EQ(peer->workers[worker].tasks_in_hand(), 0U);
}

TEST_F(WorkerTest, AsksAgainForAMapThatMadeRoomForOthers) {
  const auto process = start({"--memory-mb", "8"});
  const auto peer = client();
  const std::string worker = peer->find(name_);
  // 4 MB hold fewer than 260 maps of this size.
  topomap::LocalMap large = *room(0, 0.0);
  large.points.resize(2000, {1.0F, 1.0F});
  std::vector<MapPointer> maps;
  for (large.id = 1000; large.id < 1300; ++large.id) {
    // All contents differ, because equal maps would stand in for each other.
    large.points.back().x_m = 1.0F + 1e-3F * static_cast<float>(large.id);
    maps.push_back(std::make_shared<const topomap::LocalMap>(large));
    peer->publish(maps.back());
  }
  ASSERT_TRUE(peer->wait_until("the worker to hold many maps",
                               [&] { return peer->workers[worker].maps_held() > 150; }));
  peer->publish(one_);
  maps.push_back(one_);
  peer->answer_requests(worker, maps);
  // The order of arrival at the worker decides which maps were dropped; each is requested only
  // once, because using a map keeps it.
  std::uint32_t asked_for = 0;
  const auto lacks = [&] {
    return std::any_of(
        peer->requests.begin(), peer->requests.end(),
        [&](const msg::MapRequest& request) { return request.map_id() == asked_for; });
  };
  for (std::uint64_t id = 0; id < 300 && !lacks(); ++id) {
    const MatchTask wanted = task(*maps[id], *one_, id + 1);
    asked_for = maps[id]->id;
    peer->send(worker, wanted);
    expect_right(*peer, wanted, maps[id], one_);
  }
  EXPECT_TRUE(lacks());
  EXPECT_LT(peer->workers[worker].maps_held(), 270U);
}

TEST_F(WorkerTest, AClientWithALongQueueDoesNotKeepAnotherWaiting) {
  const auto process = start();
  const auto greedy = client();
  const auto modest = client();
  const std::string worker = greedy->find(name_);
  ASSERT_EQ(modest->find(name_), worker);
  publish_both(*greedy);
  constexpr std::uint64_t kMany = 120;
  constexpr std::uint64_t kFew = 3;
  MatchTask long_task = task(*zero_, *one_, 0);
  long_task.genetic.generations = 500;  // sending takes less time than the work
  // An attempt counts when half of the queue is left after the other client has sent its tasks.
  std::uint64_t sent = 0;
  std::uint64_t done_before = 0;
  std::uint64_t done_meanwhile = 0;
  const auto attempt = [&] {
    const std::uint64_t first = sent;
    for (; sent < first + kMany; ++sent) {
      long_task.task_id = sent;
      greedy->send(worker, long_task);
    }
    for (std::uint64_t i = 0; i < kFew; ++i) {
      modest->send(worker, task(*zero_, *one_, first + i));
    }
    const std::int64_t queued_ns = support::wall_clock_ns();
    EXPECT_TRUE(modest->wait_until("the results of the second client", [&] {
      greedy->run_loop();
      return modest->answered_ns.contains(first + kFew - 1) && greedy->results.size() == sent;
    }));
    const auto done_until = [&](std::int64_t end_ns) {
      return static_cast<std::uint64_t>(
          std::count_if(greedy->answered_ns.lower_bound(first), greedy->answered_ns.end(),
                        [&](const auto& answer) { return answer.second < end_ns; }));
    };
    done_before = done_until(queued_ns);
    done_meanwhile = done_until(modest->answered_ns[first + kFew - 1]) - done_before;
  };
  attempt();
  ASSERT_TRUE(wait_for(
      "an attempt that nothing interrupts", [&] { return done_before <= kMany / 2; }, attempt));
  EXPECT_LT(done_meanwhile, kMany / 4);
}

TEST_F(WorkerTest, RefusesAnotherVersionAnotherMatcherAndAnotherConfiguration) {
  const auto file = scratch_ / "config.yaml";
  std::ofstream(file) << "localizer:\n  recent_matches: 2\n";
  const std::uint64_t fingerprint = pipeline::load_config(file).effective.fingerprint;
  const auto process = start({"--config", file.string()});
  const auto peer = client();
  const std::string worker = peer->find(name_);
  EXPECT_EQ(peer->workers[worker].config_fingerprint(), fingerprint);
  publish_both(*peer);
  const service::MatchAddress good = [&] {
    service::MatchAddress address = peer->address;
    address.config_fingerprint = fingerprint;
    return address;
  }();

  peer->address = good;
  peer->address.version = "0.0.1";
  const msg::MatchResult version = refusal(*peer, worker, 1);
  EXPECT_EQ(version.status(), msg::kMatchOtherVersion);
  EXPECT_THAT(version.message().to_string(), HasSubstr("0.0.1"));
  EXPECT_THAT(version.message().to_string(), HasSubstr(std::string(support::kVersion)));

  peer->address = good;
  peer->address.matcher_fingerprint = 0xABC;
  const msg::MatchResult matcher = refusal(*peer, worker, 2);
  EXPECT_EQ(matcher.status(), msg::kMatchOtherVersion);
  EXPECT_THAT(matcher.message().to_string(), HasSubstr("matcher 0000000000000abc"));

  peer->address = good;
  peer->address.config_fingerprint = 0xDEF;
  const msg::MatchResult configuration = refusal(*peer, worker, 3);
  EXPECT_EQ(configuration.status(), msg::kMatchOtherConfiguration);
  EXPECT_THAT(configuration.message().to_string(), HasSubstr("0000000000000def"));

  peer->address = good;
  const MatchTask wanted = task(*zero_, *one_, 4);
  peer->send(worker, wanted);
  expect_right(*peer, wanted, zero_, one_);
  process->wait_for_error_text("task refused");
}

TEST_F(WorkerTest, WithoutAConfigurationAnyWillDo) {
  const auto process = start();
  const auto peer = client();
  const std::string worker = peer->find(name_);
  EXPECT_EQ(peer->workers[worker].config_fingerprint(), 0U);
  publish_both(*peer);
  peer->address.config_fingerprint = 0xDEF;
  const MatchTask wanted = task(*zero_, *one_, 1);
  peer->send(worker, wanted);
  expect_right(*peer, wanted, zero_, one_);
}

TEST_F(WorkerTest, AnswersTasksOfOneMessage) {
  const auto process = start();
  const auto peer = client();
  const std::string worker = peer->find(name_);
  publish_both(*peer);
  std::vector<MatchTask> tasks;
  for (std::uint64_t id = 0; id < msg::kMaxTasksInMessage; ++id) {
    tasks.push_back(task(*zero_, *one_, id));
  }
  peer->send_together(worker, tasks);
  for (const MatchTask& one : tasks) expect_right(*peer, one, zero_, one_);
}

// Answers are sent when they are as many as the tasks still in hand, or after a long wait: never
// more together than half of the pending ones, which makes five messages, or more when the worker
// was delayed.
TEST_F(WorkerTest, AnswersToTasksOfOneMessageLeaveTogether) {
  const auto process = start();
  const auto peer = client();
  const std::string worker = peer->find(name_);
  peer->address.version = "0.0.1";
  // Answers wait until the worker knows their reader, and are then sent together.
  peer->send(worker, task(*zero_, *one_, 16));
  ASSERT_TRUE(peer->wait_until("the first result", [&] { return peer->results.size() == 1; }));
  peer->together.clear();
  std::vector<MatchTask> tasks;
  for (std::uint64_t id = 0; id < 16; ++id) tasks.push_back(task(*zero_, *one_, id));
  peer->send_together(worker, tasks);
  ASSERT_TRUE(peer->wait_until("all results", [&] { return peer->results.size() == 17; }));
  EXPECT_LT(peer->together.size(), tasks.size()) << "one by one";
  std::size_t owed = tasks.size();
  for (const std::size_t together : peer->together) {
    EXPECT_LE(together, (owed + 1) / 2);
    owed -= together;
  }
}

TEST_F(WorkerTest, AnAnswerDoesNotWaitForASearchThatTakesLong) {
  const auto process = start();
  const auto peer = client();
  const std::string worker = peer->find(name_);
  publish_both(*peer);
  MatchTask short_task = task(*zero_, *one_, 0);
  peer->send(worker, short_task);
  ASSERT_TRUE(peer->wait_until("the first result", [&] { return peer->results.size() == 1; }));
  peer->together.clear();
  MatchTask long_task = short_task;
  long_task.genetic.individuals = 1000;
  long_task.genetic.generations = 1000;         // the most evaluations that a search may have
  long_task.genetic.finer_resolution_m = 0.01;  // and several searches
  long_task.genetic.finer_resolution_rad = 0.01;
  MatchTask between = long_task;
  between.genetic.generations = 200;  // longer than the waiting time of answers
  std::vector<MatchTask> tasks{short_task, between, short_task};
  tasks.insert(tasks.end(), 5, long_task);
  for (std::size_t i = 0; i < tasks.size(); ++i) tasks[i].task_id = 1 + i;
  peer->send_together(worker, tasks);
  ASSERT_TRUE(
      peer->wait_until("the result of the long search", [&] { return peer->results.size() >= 4; }));
  std::vector<std::size_t> had_left;
  std::partial_sum(peer->together.begin(), peer->together.end(), std::back_inserter(had_left));
  EXPECT_THAT(had_left, ::testing::Contains(3)) << "the third left with that of a long search";
  process->send_signal(SIGTERM);
  process->send_signal(SIGTERM);
}

TEST_F(WorkerTest, TellsWhatItIsAndDoes) {
  const auto process = start({"--slots", "2"});
  const auto peer = client();
  const std::string worker = peer->find(name_);
  publish_both(*peer);
  const msg::WorkerStatus idle = peer->workers[worker];
  EXPECT_EQ(idle.slots(), 2U);
  EXPECT_FALSE(idle.draining());
  EXPECT_EQ(idle.clients(), 0U);
  EXPECT_EQ(idle.version().to_string(), std::string(support::kVersion));
  EXPECT_EQ(idle.matcher_fingerprint(), localization::matcher_fingerprint());
  EXPECT_FALSE(idle.host().to_string().empty());
  double most_load = 0.0;
  double most_tasks_per_s = 0.0;
  std::uint32_t most_in_hand = 0;
  std::uint32_t most_clients = 0;  // clients of the last seconds, which the queue may outlast
  peer->on_status = [&](const msg::WorkerStatus& status) {
    most_load = std::max(most_load, status.load());
    most_tasks_per_s = std::max(most_tasks_per_s, status.tasks_per_s());
    most_in_hand = std::max(most_in_hand, status.tasks_in_hand());
    most_clients = std::max(most_clients, status.clients());
  };
  // The queue must last until a status has counted it, on a machine of any speed.
  MatchTask long_task = task(*zero_, *one_, 0);
  long_task.genetic.generations = 3000;
  constexpr std::uint64_t kQueue = 20;
  ASSERT_TRUE(peer->wait_until("a status of a busy worker", [&] {
    for (; long_task.task_id < peer->results.size() + kQueue; ++long_task.task_id) {
      peer->send(worker, long_task);
    }
    return most_load > 0.5 && most_in_hand > 2 && most_tasks_per_s > 0.0;
  }));
  const std::uint64_t sent = long_task.task_id;
  ASSERT_TRUE(peer->wait_until("all results", [&] { return peer->results.size() == sent; }));
  ASSERT_TRUE(peer->wait_until("a status of an idle worker", [&] {
    const msg::WorkerStatus& status = peer->workers[worker];
    return status.tasks_done() == sent && status.tasks_in_hand() == 0;
  }));
  const msg::WorkerStatus done = peer->workers[worker];
  EXPECT_LE(most_load, 1.0);
  EXPECT_EQ(done.tasks_in_hand(), 0U);
  EXPECT_GT(most_tasks_per_s, 0.0);
  EXPECT_EQ(most_clients, 1U);
  EXPECT_EQ(done.failures(), 0U);
  EXPECT_GT(done.uptime_s(), idle.uptime_s());
}

TEST_F(WorkerTest, FinishesWhatItHasInHandBeforeItGoes) {
  const auto process = start();
  const auto peer = client();
  const std::string worker = peer->find(name_);
  publish_both(*peer);
  constexpr std::uint64_t kTasks = 30;
  for (std::uint64_t id = 0; id < kTasks; ++id) peer->send(worker, task(*zero_, *one_, id));
  ASSERT_TRUE(peer->wait_until("a result", [&] { return !peer->results.empty(); }));
  process->send_signal(SIGTERM);
  ASSERT_TRUE(peer->wait_until("all results, and the worker to be gone", [&] {
    return peer->results.size() == kTasks && peer->workers.empty();
  }));
  EXPECT_EQ(process->wait(), 0);
  EXPECT_THAT(process->err(), HasSubstr("joined domain " + domain_));
  EXPECT_THAT(process->err(), HasSubstr("first task of client"));
  EXPECT_THAT(process->err(), HasSubstr("30 tasks done for 1 clients, 0 failures"));
}

TEST_F(WorkerTest, ASecondSignalEndsItAtOnce) {
  const auto process = start();
  const auto peer = client();
  const std::string worker = peer->find(name_);
  publish_both(*peer);
  MatchTask long_task = task(*zero_, *one_, 0);
  peer->send(worker, long_task);
  // Together they take minutes on any machine.
  long_task.genetic.individuals = 1000;
  long_task.genetic.generations = 500;
  for (long_task.task_id = 1; long_task.task_id < 120; ++long_task.task_id) {
    peer->send(worker, long_task);
  }
  ASSERT_TRUE(peer->wait_until("a result", [&] { return !peer->results.empty(); }));
  process->send_signal(SIGTERM);
  ASSERT_TRUE(peer->wait_until("the worker to drain", [&] {
    return peer->workers[worker].draining() && peer->workers[worker].slots() == 0;
  }));
  process->send_signal(SIGTERM);
  EXPECT_EQ(process->wait(), 0);
  EXPECT_LT(peer->results.size(), 120U);
  EXPECT_THAT(process->err(), HasSubstr("not finished"));
}

TEST_F(WorkerTest, HasRoomForEverNewClients) {
  // More than a writer can hold at once (deploy/dds_profiles.xml, results).
  constexpr int kAtATime = 10;
  const auto process = start();
  for (int i = 0; i < 7; ++i) {
    std::vector<std::unique_ptr<WorkerClient>> peers;
    peers.reserve(kAtATime);
    for (int k = 0; k < kAtATime; ++k) peers.push_back(client());
    for (const auto& peer : peers) {
      const std::string worker = peer->find(name_);
      publish_both(*peer);
      const MatchTask wanted = task(*zero_, *one_, 1);
      peer->send(worker, wanted);
      ASSERT_NO_FATAL_FAILURE(expect_right(*peer, wanted, zero_, one_)) << "round " << i;
    }
  }
  process->send_signal(SIGTERM);
  EXPECT_EQ(process->wait(), 0);
  EXPECT_THAT(process->err(), HasSubstr("disconnected after 1 answers"));
  EXPECT_THAT(process->err(), HasSubstr("70 tasks done for 70 clients"));
}

TEST_F(WorkerTest, ABadNameIsAUsageError) {
  Program process(scratch_, "ga_worker", {"--name", "a#b"});
  EXPECT_EQ(process.wait(), 2);
  EXPECT_THAT(process.err(), HasSubstr("worker name 'a#b': expected 1 to 24 bytes"));
}

}  // namespace
}  // namespace topogeo::test
