// A client of the search pool in the test's own process, for tests of real workers: it addresses
// one worker after the other and records their messages.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/local_map.h"
#include "topogeo/msg/match.h"
#include "topogeo/msg/status.h"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/version.hpp"

#include "search_pool/worker_fixture.hpp"
#include "waiting.hpp"

namespace topogeo::test {

using search_pool::MapPointer;

class WorkerClient {
 public:
  WorkerClient(const std::string& domain, const std::string& partition, std::string client_id)
      : client_id_(std::move(client_id)),
        participant_(options(domain, partition)),
        maps_(participant_),
        copies_(participant_),
        tasks_(participant_),
        results_(participant_, for_me()),
        requests_(participant_, for_me()),
        statuses_(participant_) {
    loop_.add<msg::MatchResults>(
        results_, [this](const msg::MatchResults& message, const messaging::SampleInfo& info) {
          together.push_back(message.results().size());
          for (const msg::MatchResult& result : message.results()) {
            results[result.task_id()] = result;
            answered_ns[result.task_id()] = info.stamp_ns;
            answered_by[result.task_id()] = message.worker_id().to_string();
          }
          loop_.stop();
        });
    loop_.add<msg::MapRequest>(requests_, [this](const msg::MapRequest& request, const auto&) {
      requests.push_back(request);
      if (on_request) on_request(request);
      loop_.stop();
    });
    loop_.add<msg::WorkerStatus>(
        statuses_,
        [this](const msg::WorkerStatus& status, const messaging::SampleInfo& info) {
          workers[status.worker_id().to_string()] = status;
          instances_[info.instance] = status.worker_id().to_string();
          if (on_status) on_status(status);
          loop_.stop();
        },
        [this](const messaging::SampleInfo& info) { workers.erase(instances_[info.instance]); });
    address.robot_id = "robot";
    address.client_id = client_id_;
    address.version = support::kVersion;
    address.matcher_fingerprint = localization::matcher_fingerprint();
  }
  WorkerClient(const WorkerClient&) = delete;
  WorkerClient& operator=(const WorkerClient&) = delete;

  bool wait_until(const std::string& what, const std::function<bool()>& condition) {
    return wait_for(what, condition, [&] { run_loop(); });
  }
  /// Receives messages for a short time.
  void run_loop() { loop_.run_for(std::chrono::milliseconds(2)); }

  /// Ids of the workers with this name.
  std::vector<std::string> named(const std::string& name) const {
    std::vector<std::string> ids;
    for (const auto& [id, status] : workers) {
      if (status.name().to_string() == name) ids.push_back(id);
    }
    return ids;
  }
  /// The id of the only worker with this name, once it can be reached; empty on a timeout.
  std::string find(const std::string& name) {
    const bool there =
        wait_until("worker " + name, [&] { return named(name).size() == 1; }) && reach(1);
    return there ? named(name).front() : "";
  }
  bool reach(int workers_there) {
    return wait_until("all topics of the workers", [&] {
      return tasks_.matched() >= workers_there && copies_.matched() >= workers_there &&
             results_.matched() >= workers_there && requests_.matched() >= workers_there;
    });
  }

  void publish(const MapPointer& map) { EXPECT_TRUE(maps_.write(service::to_msg(*map))); }
  void send(const std::string& worker_id, const localization::MatchTask& task) {
    send_together(worker_id, {task});
  }
  /// Sends the tasks in one message.
  void send_together(const std::string& worker_id,
                     const std::vector<localization::MatchTask>& tasks) {
    address.worker_id = worker_id;
    msg::MatchTasks message = service::tasks_for(address);
    for (const auto& task : tasks) message.tasks().push_back(service::to_msg(task, 0));
    EXPECT_TRUE(tasks_.write(message));
    ++address.sequence_number;
  }
  void send_copy(const std::string& worker_id, msg::LocalMap map) {
    msg::MapCopy copy;
    messaging::set_header(copy, "robot", 0, 0);
    messaging::set_worker_id(copy, worker_id);
    copy.local_map(std::move(map));
    EXPECT_TRUE(copies_.write(copy));
  }
  /// Sends each of these maps that the worker requests.
  void answer_requests(const std::string& worker_id, std::vector<MapPointer> maps) {
    on_request = [this, worker_id, maps = std::move(maps)](const msg::MapRequest& request) {
      for (const MapPointer& map : maps) {
        if (topomap::content_hash(*map) != request.content_hash()) continue;
        send_copy(worker_id, service::to_msg(*map));
      }
    };
  }

  service::MatchAddress address;  ///< of the next task
  std::map<std::uint64_t, msg::MatchResult> results;
  std::map<std::uint64_t, std::string> answered_by;   ///< worker id
  std::map<std::uint64_t, std::int64_t> answered_ns;  ///< when it was sent, wall clock
  std::vector<std::size_t> together;                  ///< results in each message
  std::vector<msg::MapRequest> requests;
  std::map<std::string, msg::WorkerStatus> workers;
  std::function<void(const msg::MapRequest&)> on_request;
  std::function<void(const msg::WorkerStatus&)> on_status;

 private:
  static messaging::ParticipantOptions options(const std::string& domain,
                                               const std::string& partition) {
    messaging::ParticipantOptions options;
    options.domain = static_cast<std::uint32_t>(std::stoul(domain));
    options.partition = partition;
    options.name = "test";
    return options;
  }
  [[nodiscard]] messaging::ReaderOptions for_me() const { return {{}, client_id_}; }

  std::string client_id_;
  messaging::Participant participant_;
  messaging::Writer<msg::LocalMap> maps_;
  messaging::Writer<msg::MapCopy> copies_;
  messaging::Writer<msg::MatchTasks> tasks_;
  messaging::Reader<msg::MatchResults> results_;
  messaging::Reader<msg::MapRequest> requests_;
  messaging::Reader<msg::WorkerStatus> statuses_;
  std::map<messaging::Handle, std::string> instances_;
  messaging::EventLoop loop_;  // last, because it must be destroyed before the readers
};

}  // namespace topogeo::test
