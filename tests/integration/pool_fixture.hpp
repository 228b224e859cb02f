// Local maps of a simulated drive, tasks on them, and peers of the search pool in a partition of
// the test's own.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/localization/matcher.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/local_map.h"
#include "topogeo/msg/match.h"
#include "topogeo/msg/status.h"
#include "topogeo/pipeline/local_mapper.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/simulation/world.hpp"
#include "topogeo/support/version.hpp"

#include "program.hpp"
#include "remote_pool.hpp"
#include "task_board.hpp"

namespace topogeo::test {

/// Longer than anything takes on a busy machine.
constexpr std::chrono::seconds kPatience{30};

using Maps = std::vector<std::shared_ptr<const topomap::LocalMap>>;

inline Maps maps_of_room() {
  const simulation::World world =
      simulation::load_world(std::string(TOPOGEO_TEST_DATA) + "/room.world.yaml");
  pipeline::LocalMapper mapper({}, "robot");
  Maps maps;
  for (const scan::Scan& scan : simulation::simulate_log(world, {}).scans) {
    if (auto map = mapper.add(scan)) {
      maps.push_back(std::make_shared<const topomap::LocalMap>(std::move(*map)));
    }
  }
  return maps;
}

/// Tasks between each map and the ones just before it, round and round until there are `count`.
inline std::vector<localization::MatchTask> tasks_on(const Maps& maps, std::size_t count,
                                                     std::uint64_t first_id = 0) {
  std::vector<localization::MatchTask> tasks;
  for (std::size_t i = 0; tasks.size() < count; ++i) {
    const topomap::LocalMap& query = *maps[1 + i % (maps.size() - 1)];
    const topomap::LocalMap& reference = *maps[query.id - 1 - (i % 3) % query.id];
    localization::MatchTask task;
    task.task_id = first_id + i;
    task.reference_map_id = reference.id;
    task.query_map_id = query.id;
    task.reference_hash = topomap::content_hash(reference);
    task.query_hash = topomap::content_hash(query);
    task.T_reference_query = geometry::between(reference.T_odom_robot, query.T_odom_robot);
    task.covariance = Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal();
    task.half_width = Eigen::Vector3d(0.5, 0.5, 0.3);
    task.seed = 7 * i + 1;
    tasks.push_back(task);
  }
  return tasks;
}

inline std::string random_partition() {
  std::random_device device;
  return "test-" + std::to_string(device()) + std::to_string(device());
}

inline messaging::ParticipantOptions options_in(const std::string& partition) {
  messaging::ParticipantOptions options;
  options.partition = partition;
  options.name = "test";
  return options;
}

/// A worker in the test's own process that does what the test says.
class FakeWorker {
 public:
  using OnTask = std::function<void(FakeWorker&, const msg::MatchTask&)>;

  FakeWorker(const FakeWorker&) = delete;
  FakeWorker& operator=(const FakeWorker&) = delete;
  FakeWorker(const std::string& partition, messaging::EventLoop& loop, const std::string& worker_id,
             const OnTask& on_task)
      : loop_(loop),
        participant_(options_in(partition)),
        statuses_(participant_),
        results_(participant_),
        tasks_(participant_, {{}, {"worker_id = %0", {"'" + worker_id + "'"}}}) {
    loop_.add<msg::MatchTask>(tasks_, [this, on_task](const msg::MatchTask& task, const auto&) {
      ++received;
      on_task(*this, task);
    });
    messaging::set_header(status_, "", 0, 0);
    messaging::set_text(status_.worker_id(), worker_id, "worker_id");
    messaging::set_text(status_.version(), support::kVersion, "version");
    status_.slots(1);
    timer_ = loop_.add_timer(std::chrono::milliseconds(200), [this] { announce(); });
    announce();
  }
  ~FakeWorker() { loop_.cancel_timer(timer_); }

  /// Says that it goes, as a worker that drains does.
  void leave() {
    loop_.cancel_timer(timer_);
    statuses_.dispose(status_);
  }

  void answer(const msg::MatchTask& task, localization::MatchResult result,
              msg::MatchStatus status = msg::kMatchSolved) {
    result.task_id = task.task_id();
    service::MatchAddress address;
    address.robot_id = "robot";
    address.worker_id = task.worker_id().to_string();
    address.client_id = task.client_id().to_string();
    msg::MatchResult message = service::to_msg(result, address);
    message.status(status);
    EXPECT_TRUE(results_.wait_for_matched(1, kPatience));
    EXPECT_TRUE(results_.write(message));
  }

  int received = 0;

 private:
  void announce() { EXPECT_TRUE(statuses_.write(status_)); }

  messaging::EventLoop& loop_;
  std::uint64_t timer_ = 0;
  messaging::Participant participant_;
  messaging::Writer<msg::WorkerStatus> statuses_;
  messaging::Writer<msg::MatchResult> results_;
  messaging::Reader<msg::MatchTask> tasks_;
  msg::WorkerStatus status_;
};

}  // namespace topogeo::test
