// Wrong matches that are accepted in surroundings that invite the mistake, and right matches that
// are kept at the same width of search.
#pragma once

#include <array>
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>
#include <tuple>

#include "matching_pairs.hpp"
#include "matching_run.hpp"

namespace topogeo::bench {

class LookAlikes {
 public:
  /// Uses `pairs` of each kind per log. With a file name, every match is also written there, one a
  /// line, with its evidence; throws std::runtime_error when the file cannot be written.
  LookAlikes(std::size_t pairs, const std::string& samples_file);

  /// Tries the pairs of a log.
  void add(MatchingRun& run);

  /// A row for each log, kind of pair and width, then those of all logs together.
  void print(std::FILE* out) const;

 private:
  enum class Kind : std::uint8_t { kOverlapping, kCorridor, kApart, kLookAlike };
  struct Counts {
    std::size_t pairs = 0;
    std::size_t right = 0;  ///< accepted and right
    std::size_t wrong = 0;  ///< accepted and wrong
    std::array<std::size_t, localization::kReasons> reasons{};
    Counts& operator+=(const Counts& other);
  };
  using Key = std::tuple<std::size_t, Kind, double>;  ///< log, kind, half-width in metres

  static const char* name_of(Kind kind);
  void try_pairs(MatchingRun& run, Kind kind, const std::vector<StopPair>& pairs,
                 support::Random& random);
  void try_pair(MatchingRun& run, Kind kind, const StopPair& pair, double half_width_m,
                support::Random& random);
  void write_sample(const MatchingRun& run, Kind kind, const StopPair& pair, double half_width_m,
                    const localization::MatchTask& task, const localization::MatchResult& result,
                    bool right);

  std::size_t pairs_;
  std::ofstream samples_;
  std::vector<std::string> logs_;
  std::map<Key, Counts> counts_;
};

}  // namespace topogeo::bench
