// A pool whose searches can be watched: publishes them as topic kSearch, for people only.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "topogeo/matching/match.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/search.h"
#include "topogeo/service/service.hpp"

namespace topogeo::localizer {

/// Stops by the map ids that tasks use.
using StopsOfTasks = std::map<std::uint32_t, topomap::StopId>;

/// The message for the start of a search, without header: its first tasks, without those that
/// search the whole map and those with maps unknown to `stops`.
msg::Search searched(std::span<const localization::MatchTask> tasks, const StopsOfTasks& stops);

/// Adds the results of the search. `results` are in the order of the tasks.
void add_results(std::span<const localization::MatchTask> tasks,
                 std::span<const localization::MatchResult> results, const StopsOfTasks& stops,
                 msg::Search& search);

class WatchedPool : public localization::MatchPool {
 public:
  /// Both arguments must outlive it.
  WatchedPool(service::Service& service, localization::MatchPool& pool);

  void add_map(std::shared_ptr<const topomap::LocalMap> map) override;
  void add_field(std::shared_ptr<const localization::PlaceField> field) override;
  std::vector<localization::MatchResult> match(
      std::span<const localization::MatchTask> tasks) override;

 private:
  using Clock = std::chrono::steady_clock;
  void send(msg::Search& search, std::int64_t stamp_ns);
  [[nodiscard]] std::int64_t stamp_of(const localization::MatchTask& task) const;

  service::Service& service_;
  localization::MatchPool& pool_;
  messaging::Writer<msg::Search> writer_;
  StopsOfTasks stops_;
  std::map<std::uint32_t, std::int64_t> stamps_ns_;
  Clock::time_point next_;
  std::uint64_t sent_ = 0;
};

}  // namespace topogeo::localizer
