// Helpers of the search-pool benchmarks: local maps of a simulated drive, tasks on them, a client
// in this process and workers in others.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/matching/match.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/local_map.h"
#include "topogeo/supervision/child_process.hpp"

#include "localization/simulated_maps.hpp"
#include "remote_pool.hpp"

namespace topogeo::bench {

/// A longer wait is a hang.
constexpr std::chrono::seconds kPatience{600};

using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Maps of the stops of a drive through the simulated floor; the same in every process.
localization::test::Maps maps_of_floor();

/// Makes tasks between each map and the three before it in turn, as a localizer does, over and
/// over.
class TaskSource {
 public:
  explicit TaskSource(localization::test::Maps maps);

  [[nodiscard]] const localization::test::Maps& maps() const { return maps_; }
  /// The next `count` tasks, with ascending ids; after `different` of them they repeat except for
  /// the id. The seed identifies the different ones.
  std::vector<localization::MatchTask> next(
      std::size_t count, std::uint64_t different = std::numeric_limits<std::uint64_t>::max());

 private:
  localization::test::Maps maps_;
  std::vector<std::uint64_t> hashes_;
  std::uint64_t made_ = 0;
};

/// Different tasks that stub workers know the answers to.
constexpr std::uint64_t kStubTasks = 60;

/// A DDS domain that hardly any other program uses.
std::uint32_t random_domain();

/// Flags that let a service join.
std::vector<std::string> flags_of(std::uint32_t domain, const std::string& partition);

/// A localizer's end of the pool, in a partition of its own.
class PoolClient {
 public:
  /// Knows the maps but does not publish them.
  explicit PoolClient(const localization::test::Maps& maps, bool verify = true,
                      std::uint32_t domain = random_domain());

  [[nodiscard]] localizer::RemotePool& pool() { return *pool_; }
  /// Flags that let a service meet this client.
  [[nodiscard]] std::vector<std::string> flags() const;
  /// Publishes the maps to present and later readers.
  void publish(const localization::test::Maps& maps);
  /// The last fault; empty if none.
  [[nodiscard]] const std::string& fault() const { return fault_; }

 private:
  std::string fault_;
  messaging::ParticipantOptions options_;
  std::optional<messaging::Participant> map_participant_;
  std::optional<messaging::Writer<msg::LocalMap>> map_writer_;
  std::optional<messaging::Participant> participant_;
  messaging::EventLoop loop_;
  std::optional<localizer::RemotePool> pool_;
};

/// Worker processes, asked to leave at the end.
class Workers {
 public:
  Workers() = default;
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;
  ~Workers();

  /// Starts a real worker of one slot.
  void start_real(const PoolClient& client, std::vector<std::string> flags = {});
  /// Starts a process with `count` workers that answer without searching (stub_workers.hpp);
  /// `flags` set their domain and partition, and each answer takes `cost`.
  void start_stubs(std::vector<std::string> flags, std::size_t count,
                   std::chrono::microseconds cost = {});
  [[nodiscard]] std::size_t size() const { return children_.size(); }
  /// CPU time of the threads of the process that was started as number `worker`.
  [[nodiscard]] double cpu_s(std::size_t worker) const;

 private:
  std::vector<supervision::ChildProcess> children_;
};

}  // namespace topogeo::bench
