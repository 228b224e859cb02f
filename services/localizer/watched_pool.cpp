#include "watched_pool.hpp"

#include <algorithm>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"

namespace topogeo::localizer {

using localization::MatchResult;
using localization::MatchTask;

namespace {

/// Pause between two published searches: most take milliseconds, and nobody reads faster.
constexpr std::chrono::milliseconds kSearchPeriod{500};

msg::SearchHypothesis hypothesis_of(const localization::MatchSolution& solution) {
  msg::SearchHypothesis out;
  out.T_base_robot(service::to_msg(solution.T_reference_query));
  out.fitness(solution.fitness);
  return out;
}

/// Puts the best solutions first, as many as fit into a message.
template <class Sequence>
void put_best(std::vector<localization::MatchSolution> solutions, Sequence& out) {
  std::ranges::stable_sort(solutions, std::ranges::greater{},
                           &localization::MatchSolution::fitness);
  if (solutions.size() > msg::kMaxSearchHypotheses) solutions.resize(msg::kMaxSearchHypotheses);
  for (const localization::MatchSolution& solution : solutions) {
    out.push_back(hypothesis_of(solution));
  }
}

bool is_shown(const MatchTask& task, const StopsOfTasks& stops) {
  return !task.places && stops.contains(task.reference_map_id) && stops.contains(task.query_map_id);
}

}  // namespace

msg::Search searched(std::span<const MatchTask> tasks, const StopsOfTasks& stops) {
  msg::Search search;
  search.tasks(static_cast<std::uint32_t>(tasks.size()));
  search.running(true);
  search.whole_map(!tasks.empty() && tasks.front().places != nullptr);
  for (const MatchTask& task : tasks) {
    if (search.matches().size() >= msg::kMaxSearchMatches) break;
    if (!is_shown(task, stops)) continue;
    msg::SearchedMatch match;
    match.base(service::to_msg(stops.at(task.reference_map_id)));
    match.stop(service::to_msg(stops.at(task.query_map_id)));
    match.T_base_stop(service::to_msg(task.T_reference_query));
    match.covariance(service::to_msg(task.covariance));
    match.half_width_x_m(task.half_width.x());
    match.half_width_y_m(task.half_width.y());
    match.half_width_rad(task.half_width.z());
    search.matches().push_back(std::move(match));
  }
  return search;
}

void add_results(std::span<const MatchTask> tasks, std::span<const MatchResult> results,
                 const StopsOfTasks& stops, msg::Search& search) {
  search.running(false);
  std::vector<localization::MatchSolution> places;
  std::size_t shown = 0;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const MatchResult& result = results[i];
    if (tasks[i].places) {
      places.insert(places.end(), result.solutions.begin(), result.solutions.end());
      continue;
    }
    if (!is_shown(tasks[i], stops) || shown >= search.matches().size()) continue;
    msg::SearchedMatch& match = search.matches()[shown++];
    match.done(true);
    match.accepted(result.verdict == localization::Verdict::kAccepted);
    match.reason(static_cast<msg::MatchReason>(result.reason));
    match.fitness(result.fitness);
    if (result.status != localization::MatchStatus::kSolved) continue;
    // The solution found, and the alternatives that the maps allow.
    std::vector<localization::MatchSolution> solutions = {
        {result.T_reference_query, result.fitness}};
    if (result.second.fitness > 0.0) solutions.push_back(result.second);
    solutions.insert(solutions.end(), result.solutions.begin(), result.solutions.end());
    if (solutions.size() > msg::kMaxSearchHypotheses) solutions.resize(msg::kMaxSearchHypotheses);
    for (const auto& solution : solutions) match.hypotheses().push_back(hypothesis_of(solution));
  }
  put_best(std::move(places), search.hypotheses());
}

WatchedPool::WatchedPool(service::Service& service, localization::MatchPool& pool)
    : service_(service), pool_(pool), writer_(service.advertise<msg::Search>()) {}

void WatchedPool::add_map(std::shared_ptr<const topomap::LocalMap> map) {
  stops_[map->id] = map->stop;
  stamps_ns_[map->id] = map->stamp_ns;
  pool_.add_map(std::move(map));
}

void WatchedPool::add_field(std::shared_ptr<const localization::PlaceField> field) {
  pool_.add_field(std::move(field));
}

std::int64_t WatchedPool::stamp_of(const MatchTask& task) const {
  const auto stamp = stamps_ns_.find(task.query_map_id);
  return stamp == stamps_ns_.end() ? 0 : stamp->second;
}

std::vector<MatchResult> WatchedPool::match(std::span<const MatchTask> tasks) {
  if (tasks.empty() || writer_.matched() == 0) return pool_.match(tasks);
  if (Clock::now() < next_) return pool_.match(tasks);
  const std::int64_t stamp_ns = stamp_of(tasks.front());
  msg::Search search = searched(tasks, stops_);
  // Viewers see a long search while it runs. Its result belongs to it and is always sent.
  send(search, stamp_ns);
  std::vector<MatchResult> results = pool_.match(tasks);
  add_results(tasks, results, stops_, search);
  send(search, stamp_ns);
  next_ = Clock::now() + kSearchPeriod;
  return results;
}

void WatchedPool::send(msg::Search& search, std::int64_t stamp_ns) {
  messaging::set_header(search, service_.robot_id(), stamp_ns, sent_++);
  static_cast<void>(writer_.write(search));  // not worth a retry
}

}  // namespace topogeo::localizer
