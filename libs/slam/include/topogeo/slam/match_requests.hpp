// Requests for matches: the search space of a match around its prediction, and tasks with numbers,
// hashes and seeds, handed to a MatchPool and counted.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/matching/match.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/slam/slam.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

/// The task for two maps with a predicted relative pose: the search space, cut to the largest one,
/// and all settings. The caller adds ids, hashes and seed.
MatchTask match_task(const LocalizerConfig& config, const UncertainPose& T_reference_query);

/// Whether a prediction is good enough for a match: its search space, before cutting, is no larger
/// than the largest one. A wider search finds look-alikes.
bool searchable(const LocalizerConfig& config, const UncertainPose& T_reference_query);

/// PoseGraph::path_cost() beyond which no prediction is searchable().
double largest_searchable_cost(const LocalizerConfig& config);

class MatchRequests {
 public:
  /// The pool must outlive the requests.
  MatchRequests(const LocalizerConfig& config, MatchPool& pool);

  /// Registers a local map with the pool, under its id.
  void add_map(std::shared_ptr<const topomap::LocalMap> map);

  /// Registers a whole map with the pool.
  void add_field(std::shared_ptr<const PlaceField> field) { pool_.add_field(std::move(field)); }

  /// The next task: match_task() for two registered maps. Its seed follows from the seed of the
  /// run, the robot of the reference map, both ids and the number of the match. Throws
  /// std::out_of_range for a map that was not registered.
  MatchTask make(std::uint32_t reference_id, std::uint32_t query_id,
                 const UncertainPose& T_reference_query);

  /// The answers to all parts of a search of the whole map by a registered stop, in the order of
  /// the parts; they do not count as matches. Throws like MatchPool::match and make().
  std::vector<MatchSolution> ask(std::span<const std::shared_ptr<const PlaceQuestion>> questions,
                                 std::uint32_t query_id);

  /// The results in the order of the tasks. Without tasks the pool is not called. Throws like
  /// MatchPool::match.
  std::vector<MatchResult> run(std::span<const MatchTask> tasks);

  /// Continues the numbering of tasks there. No number may occur twice in one pool.
  void number_from(std::uint64_t next_task) { next_task_ = next_match_ = next_task; }
  [[nodiscard]] std::uint64_t next_task() const { return next_task_; }

  [[nodiscard]] const MatchCounts& counts() const { return counts_; }

 private:
  struct KnownMap {
    std::uint64_t hash = 0;
    std::string robot_id;
  };

  MatchTask place_task(const std::shared_ptr<const PlaceQuestion>& question,
                       std::uint32_t query_id);

  LocalizerConfig config_;
  MatchPool& pool_;
  std::map<std::uint32_t, KnownMap> maps_;  // by id
  std::uint64_t next_task_ = 0;
  std::uint64_t next_match_ = 0;  // without tasks of ask(), so that seeds do not depend on them
  MatchCounts counts_;
};

}  // namespace topogeo::localization
