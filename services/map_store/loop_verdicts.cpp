#include "loop_verdicts.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <tuple>
#include <utility>

#include "topogeo/slam/loop/loop_decision.hpp"

namespace topogeo::map_store {
namespace {

using storage::LoopVerdict;

LoopVerdict verdict_of(const localization::LoopDecision& decision) {
  static_assert(localization::kLoopOutcomes == LoopVerdict::kOutcomes);
  LoopVerdict verdict;
  verdict.step = decision.step;
  verdict.earlier_id = decision.earlier_id;
  verdict.later_id = decision.later_id;
  verdict.outcome = static_cast<LoopVerdict::Outcome>(decision.outcome);
  verdict.explanation = localization::explanation(decision);
  verdict.source = localization::to_string(decision.source);
  verdict.T_earlier_later = decision.T_earlier_later;
  verdict.T_predicted = decision.predicted.T_a_b;
  verdict.predicted_covariance = decision.predicted.covariance;
  verdict.correction_m = decision.correction_m;
  verdict.correction_rad = decision.correction_rad;
  verdict.fitness = decision.fitness;
  verdict.probability = decision.probability;
  return verdict;
}

void drop_oldest_rejected(std::vector<LoopVerdict>& verdicts, std::size_t most) {
  std::size_t excess = verdicts.size() > most ? verdicts.size() - most : 0;
  std::erase_if(verdicts, [&](const LoopVerdict& verdict) {
    if (excess == 0 || verdict.outcome == LoopVerdict::Outcome::kAccepted) return false;
    --excess;
    return true;
  });
}

}  // namespace

LoopVerdicts::LoopVerdicts(std::vector<LoopVerdict> stored, std::uint64_t numbered_since)
    : earlier_(std::move(stored)), numbered_since_(numbered_since) {}

void LoopVerdicts::add(const msg::LoopDecisions& message, const messaging::Handle& localizer) {
  if (message.numbered_since() < numbered_since_) return;
  if (message.numbered_since() > numbered_since_) {
    earlier_.clear();
    newest_ = {};
    numbered_since_ = message.numbered_since();
  } else if (localizer != localizer_) {
    earlier_ = all();
    newest_ = {};
  }
  localizer_ = localizer;
  newest_.add(message);
  ++changes_;
}

std::vector<LoopVerdict> LoopVerdicts::all() const {
  using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;
  std::map<Key, LoopVerdict> found;
  const auto take = [&](LoopVerdict verdict) {
    const Key key{verdict.step, verdict.earlier_id, verdict.later_id};
    found.insert_or_assign(key, std::move(verdict));
  };
  for (const LoopVerdict& verdict : earlier_) take(verdict);
  for (const localization::LoopDecision& decision : newest_.all()) take(verdict_of(decision));
  std::vector<LoopVerdict> verdicts;
  verdicts.reserve(found.size());
  for (auto& [key, verdict] : found) verdicts.push_back(std::move(verdict));
  drop_oldest_rejected(verdicts, kMost);
  return verdicts;
}

std::vector<LoopVerdict> within(std::vector<LoopVerdict> verdicts, std::uint32_t stops) {
  std::erase_if(verdicts, [&](const LoopVerdict& verdict) {
    return verdict.earlier_id >= stops || verdict.later_id >= stops;
  });
  return verdicts;
}

}  // namespace topogeo::map_store
