#include "topogeo/thesis/solution_store.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace topogeo::localization {

SolutionStore::SolutionStore(std::size_t largest_per_pair) : largest_per_pair_(largest_per_pair) {
  if (largest_per_pair == 0) {
    throw std::invalid_argument("solution store: at least one solution per pair must be kept");
  }
}

void SolutionStore::put(std::uint32_t earlier, std::uint32_t later,
                        std::vector<RelativeSolution> solutions) {
  const std::string pair = "maps " + std::to_string(earlier) + " and " + std::to_string(later);
  if (earlier >= later) {
    throw std::invalid_argument("solution store: " + pair + " are not an earlier and a later one");
  }
  for (const RelativeSolution& solution : solutions) {
    if (!(solution.fitness >= 0.0 && solution.fitness <= 1.0)) {
      throw std::invalid_argument("solution store: fitness " + std::to_string(solution.fitness) +
                                  " of " + pair + " is not in [0, 1]");
    }
    if (!solution.covariance.allFinite() || solution.covariance.diagonal().minCoeff() <= 0.0) {
      throw std::invalid_argument("solution store: a covariance of " + pair +
                                  " is not finite with a positive diagonal");
    }
  }
  if (solutions.empty()) {
    solutions_.erase({later, earlier});
    return;
  }
  std::stable_sort(solutions.begin(), solutions.end(),
                   [](const auto& a, const auto& b) { return a.fitness > b.fitness; });
  if (solutions.size() > largest_per_pair_) solutions.resize(largest_per_pair_);
  solutions_[{later, earlier}] = std::move(solutions);
}

std::span<const RelativeSolution> SolutionStore::find(std::uint32_t earlier,
                                                      std::uint32_t later) const {
  const auto found = solutions_.find({later, earlier});
  if (found == solutions_.end()) return {};
  return found->second;
}

std::vector<std::uint32_t> SolutionStore::matched_with(std::uint32_t later) const {
  std::vector<std::uint32_t> earlier;
  for (auto it = solutions_.lower_bound({later, 0});
       it != solutions_.end() && it->first.first == later; ++it) {
    earlier.push_back(it->first.second);
  }
  return earlier;
}

}  // namespace topogeo::localization
