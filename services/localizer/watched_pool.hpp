// A pool whose searches can be watched: what goes through it is published as topic kSearch, for
// people alone.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "topogeo/localization/matching/match.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/search.h"
#include "topogeo/service/service.hpp"

namespace topogeo::localizer {

/// Stops by the ids that tasks name them with.
using StopsOfTasks = std::map<std::uint32_t, topomap::StopId>;

/// The first tasks as they are when the search begins, without header; of a search of the whole map
/// none of them. Maps that `stops` does not have are left out.
msg::Search searched(std::span<const localization::MatchTask> tasks, const StopsOfTasks& stops);

/// Adds what came of it. `results` are in the order of the tasks.
void add_results(std::span<const localization::MatchTask> tasks,
                 std::span<const localization::MatchResult> results, const StopsOfTasks& stops,
                 msg::Search& search);

class WatchedPool : public localization::MatchPool {
 public:
  /// Both outlive it.
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
