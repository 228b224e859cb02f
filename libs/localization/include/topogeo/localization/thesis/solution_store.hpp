// The n best relative solutions of each pair of maps (Thesis, 7.3.1.2, definition 7.3.4;
// docs/algorithms.md, "Backward correction"): what the forward correction leaves behind for the
// backward correction to choose from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "topogeo/localization/mapping/relative_solution.hpp"

namespace topogeo::localization {

class SolutionStore {
 public:
  /// Keeps at most so many solutions of a pair; throws std::invalid_argument for 0.
  explicit SolutionStore(std::size_t largest_per_pair = 40);

  /// Replaces the solutions of a pair by the fittest of `solutions`, of equally fit ones the
  /// earlier in the list. None: the pair is forgotten. Throws std::invalid_argument unless
  /// earlier < later, every fitness lies in [0, 1] and every covariance is finite with a positive
  /// diagonal.
  void put(std::uint32_t earlier, std::uint32_t later, std::vector<RelativeSolution> solutions);

  /// Best first; empty for a pair that was not matched.
  [[nodiscard]] std::span<const RelativeSolution> find(std::uint32_t earlier,
                                                       std::uint32_t later) const;

  /// The earlier maps of which solutions for `later` are known, ascending.
  [[nodiscard]] std::vector<std::uint32_t> matched_with(std::uint32_t later) const;

  [[nodiscard]] std::size_t pairs() const { return solutions_.size(); }

 private:
  std::size_t largest_per_pair_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<RelativeSolution>>
      solutions_;  // (later, earlier)
};

}  // namespace topogeo::localization
