#include "topogeo/search_pool/reference_holders.hpp"

#include <algorithm>
#include <optional>

#include "topogeo/matching/matcher.hpp"

namespace topogeo::search_pool {
namespace {

constexpr std::size_t kLookAhead = 64;  // keeps the time for a batch linear in its size

bool contains(const std::deque<std::uint64_t>& held, std::uint64_t reference_hash) {
  return std::find(held.begin(), held.end(), reference_hash) != held.end();
}

}  // namespace

void ReferenceHolders::add(const std::string& worker_id, std::uint64_t reference_hash) {
  std::deque<std::uint64_t>& held = held_[worker_id];
  const auto found = std::find(held.begin(), held.end(), reference_hash);
  if (found != held.end()) {
    held.erase(found);
  } else {
    ++holders_of_[reference_hash];
  }
  held.push_back(reference_hash);
  if (held.size() <= localization::Matcher::kKeptReferences) return;
  release(held.front());
  held.pop_front();
}

void ReferenceHolders::forget(const std::string& worker_id) {
  const auto found = held_.find(worker_id);
  if (found == held_.end()) return;
  for (const std::uint64_t reference_hash : found->second) release(reference_hash);
  held_.erase(found);
}

void ReferenceHolders::release(std::uint64_t reference_hash) {
  const auto found = holders_of_.find(reference_hash);
  if (--found->second == 0) holders_of_.erase(found);
}

std::size_t ReferenceHolders::choose(const std::string& worker_id,
                                     const std::set<std::size_t>& waiting,
                                     const TaskBatch& batch) const {
  const auto found = held_.find(worker_id);
  std::optional<std::size_t> of_nobody;
  std::size_t looked_at = 0;
  for (const std::size_t index : waiting) {
    if (looked_at++ == kLookAhead) break;
    const std::uint64_t reference_hash = batch.at(index).task.reference_hash;
    if (found != held_.end() && contains(found->second, reference_hash)) return index;
    if (!of_nobody && !holders_of_.contains(reference_hash)) of_nobody = index;
  }
  return of_nobody.value_or(*waiting.begin());
}

}  // namespace topogeo::search_pool
