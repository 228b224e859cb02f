// Works on one match task at a time: genetic search, then refinement of the winners. What a
// ga_worker runs, and what a localizer runs itself when it has no worker.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/localization/matching/fitness_forms.hpp"
#include "topogeo/localization/matching/genetic_search.hpp"
#include "topogeo/localization/matching/genetic_search_hypotheses.hpp"
#include "topogeo/localization/matching/match.hpp"
#include "topogeo/localization/matching/match_features.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

class Matcher {
 public:
  /// So many references that were searched in last stay worked up, some 150 kB each. Answers do not
  /// depend on it.
  static constexpr std::size_t kKeptReferences = 16;

  /// Keeps the features of the map (some 20 kB, twice that where tasks ask for them without the
  /// scan) under its id; a later map of the same id replaces it.
  void add_map(const topomap::LocalMap& map);

  /// True when a map of this id and content is known.
  [[nodiscard]] bool has_map(std::uint32_t id, std::uint64_t hash) const;

  /// Keeps the whole map for tasks that search in it, instead of the one before.
  void add_field(std::shared_ptr<const PlaceField> field) { field_ = std::move(field); }
  [[nodiscard]] bool has_field(std::uint64_t hash) const;

  /// Throws std::out_of_range when a map that the task names is not known or has another content,
  /// std::invalid_argument when a number in the task is not finite, the covariance not positive
  /// definite, the search space empty, the resolution not positive or solutions_wanted not 1 to 40.
  MatchResult solve(const MatchTask& task);

  /// Computes again, from the task's maps and the poses in `result`, all that the result states of
  /// them: fitness, evidence, covariance, verdict. What is wrong with it, for people; empty when it
  /// is right to the last bit. A result that is right may still be poorer than that of solve():
  /// only a second answer to the task shows that. Throws like solve().
  [[nodiscard]] std::string verify(const MatchTask& task, const MatchResult& result);

 private:
  struct KnownMap {
    std::uint64_t hash = 0;
    std::shared_ptr<const MatchFeatures> features;
    topomap::LocalMap branches;  // they and the laser's place alone, of which walls are made
    // The walls in place of the scan, once asked for.
    std::shared_ptr<const MatchFeatures> by_branches;
  };
  struct CachedReference {
    std::uint32_t id = 0;
    std::uint64_t hash = 0;
    bool by_scan = true;
    Reference reference;
  };

  KnownMap& known(std::uint32_t id, std::uint64_t hash);
  // What the task's evidence reads of the maps that it names.
  const std::shared_ptr<const MatchFeatures>& features(std::uint32_t id, std::uint64_t hash,
                                                       MatchEvidence evidence);
  const Reference& reference(const MatchTask& task);
  // Searches once more around each of the starts; how many individuals were scored.
  std::uint32_t search_finer(const MatchTask& task);
  const PlaceField& field(const PlaceQuestion& question) const;

  std::map<std::uint32_t, KnownMap> maps_;
  std::shared_ptr<const PlaceField> field_;
  std::list<CachedReference>
      references_;  // most recently used first; grids are large, so only a few
  // What a match works with, kept for its memory.
  FitnessForms forms_;
  BranchHypotheses hypotheses_;
  GeneticSearch search_;
  std::vector<MatchSolution> starts_;
};

/// Hash of what solve() makes of a small built-in task: two programs that differ in it would give
/// different answers to the same task (other constants, another compiler's arithmetic).
std::uint64_t matcher_fingerprint();

/// Solves all tasks here, one after the other.
class InProcessPool : public MatchPool {
 public:
  void add_map(std::shared_ptr<const topomap::LocalMap> map) override { matcher_.add_map(*map); }
  void add_field(std::shared_ptr<const PlaceField> field) override {
    matcher_.add_field(std::move(field));
  }
  std::vector<MatchResult> match(std::span<const MatchTask> tasks) override;

 private:
  Matcher matcher_;
};

}  // namespace topogeo::localization
