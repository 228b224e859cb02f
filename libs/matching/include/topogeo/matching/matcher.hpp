// Solves one match task at a time: genetic search, then refinement of the winners. Used by
// ga_worker, and by a localizer without workers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/matching/match.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

class Matcher {
 public:
  /// Number of references kept ready, the most recently searched ones, some 150 kB each. Answers do
  /// not depend on it.
  static constexpr std::size_t kKeptReferences = 16;

  Matcher();
  Matcher(Matcher&&) noexcept;
  Matcher& operator=(Matcher&&) noexcept;
  ~Matcher();

  /// Stores the features of the map (some 20 kB, twice that once tasks without scan points ask for
  /// them) under its id; a later map with the same id replaces it.
  void add_map(const topomap::LocalMap& map);

  /// True if a map with this id and content is known.
  [[nodiscard]] bool has_map(std::uint32_t id, std::uint64_t hash) const;

  /// Stores the whole map for tasks that search in it, in place of the previous one.
  void add_field(std::shared_ptr<const PlaceField> field) { field_ = std::move(field); }
  [[nodiscard]] bool has_field(std::uint64_t hash) const;

  /// Throws std::out_of_range if a map that the task names is unknown or has another content;
  /// std::invalid_argument if a number in the task is not finite, the covariance not positive
  /// definite, the search space empty, the resolution not positive or solutions_wanted not 1 to 40.
  MatchResult solve(const MatchTask& task);

  /// Recomputes everything that `result` states about its poses from the task's maps: fitness,
  /// evidence, covariance, verdict. Returns the first fault as text; empty if all is right to the
  /// last bit. A right result may still be poorer than that of solve(), which only a second answer
  /// to the task shows. Throws like solve().
  [[nodiscard]] std::string verify(const MatchTask& task, const MatchResult& result);

 private:
  struct KnownMap {
    std::uint64_t hash = 0;
    std::shared_ptr<const MatchFeatures> features;
    topomap::LocalMap branches;  // only branches and laser pose, to derive walls
    // The walls in place of the scan, made on demand.
    std::shared_ptr<const MatchFeatures> by_branches;
  };
  struct CachedReference {
    std::uint32_t id = 0;
    std::uint64_t hash = 0;
    bool by_scan = true;
    Reference reference;
  };

  KnownMap& known(std::uint32_t id, std::uint64_t hash);
  // The features that the task's evidence uses.
  const std::shared_ptr<const MatchFeatures>& features(std::uint32_t id, std::uint64_t hash,
                                                       MatchEvidence evidence);
  const Reference& reference(const MatchTask& task);
  // Searches once more around each of the starts; returns the number of scored individuals.
  std::uint32_t search_finer(const MatchTask& task);
  const PlaceField& field(const PlaceQuestion& question) const;

  std::map<std::uint32_t, KnownMap> maps_;
  std::shared_ptr<const PlaceField> field_;
  std::list<CachedReference>
      references_;  // most recently used first; grids are large, so only a few
  struct Buffers;
  std::unique_ptr<Buffers> buffers_;
};

/// Hash of the answer of solve() to a small built-in task. Programs with different fingerprints
/// would give different answers to the same task (other constants, another compiler's arithmetic).
std::uint64_t matcher_fingerprint();

/// Solves all tasks in this process, one after the other.
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
