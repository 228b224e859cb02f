// The n best relative solutions of each pair of maps (Thesis, 7.3.1.2, definition 7.3.4;
// docs/algorithms.md, "Backward correction"): the forward correction stores them, the backward
// correction chooses from them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "loop/relative_solution.hpp"

namespace topogeo::localization {

class SolutionStore {
 public:
  /// Limit of solutions per pair; throws std::invalid_argument for 0.
  explicit SolutionStore(std::size_t largest_per_pair = 40);

  /// Replaces the solutions of a pair by the fittest of `solutions`; equal ones in the order of the
  /// list. An empty list removes the pair. Throws std::invalid_argument unless earlier < later,
  /// every fitness lies in [0, 1] and every covariance is finite with a positive diagonal.
  void put(std::uint32_t earlier, std::uint32_t later, std::vector<RelativeSolution> solutions);

  /// Best first; empty for a pair that was not matched.
  [[nodiscard]] std::span<const RelativeSolution> find(std::uint32_t earlier,
                                                       std::uint32_t later) const;

  /// The earlier maps with known solutions for `later`, ascending.
  [[nodiscard]] std::vector<std::uint32_t> matched_with(std::uint32_t later) const;

  [[nodiscard]] std::size_t pairs() const { return solutions_.size(); }

 private:
  std::size_t largest_per_pair_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<RelativeSolution>>
      solutions_;  // (later, earlier)
};

}  // namespace topogeo::localization
