#include "stamp_repair.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "stamped_topic.hpp"

namespace topogeo::recording {
namespace {

constexpr std::size_t kLeastCommon = 10;  // of the scans, in the time of odometry

std::int64_t median_of(std::vector<std::int64_t> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Joins the clocks of two computers by the times of recording, if no times are common. Returns a
/// note if it did.
std::string join_clocks(StampedTopic& scans, StampedTopic& odometry) {
  const auto range = odometry.range();
  if (!range || scans.by_log_time().empty()) return {};
  const std::int64_t first_log_ns = odometry.by_log_time().front().first;
  const std::int64_t last_log_ns = odometry.by_log_time().back().first;
  std::size_t common = 0;
  std::vector<std::int64_t> apart_ns;
  std::vector<std::int64_t> offsets_ns;
  for (const auto& [log_ns, number] : scans.by_log_time()) {
    const std::int64_t time_ns = scans.time_of(number);
    if (time_ns >= saturated_sum(range->first, -kSameClock_ns) &&
        time_ns <= saturated_sum(range->second, kSameClock_ns)) {
      ++common;
    }
    if (log_ns < first_log_ns || log_ns > last_log_ns) continue;
    const std::size_t near = *odometry.nearest_by_log_time(log_ns);
    apart_ns.push_back(saturated_sum(odometry.offset_of(near), -scans.offset_of(number)));
    offsets_ns.push_back(scans.offset_of(number));
  }
  if (common * kLeastCommon >= scans.by_log_time().size() || last_log_ns <= first_log_ns ||
      2 * apart_ns.size() < scans.by_log_time().size()) {
    return {};
  }
  const std::int64_t shift_ns = median_of(std::move(apart_ns));
  const std::int64_t offset_ns = median_of(std::move(offsets_ns));
  // On the clock that is nearer to that of the recorder.
  if (std::llabs(saturated_sum(offset_ns, shift_ns)) <= std::llabs(offset_ns)) {
    scans.shift_all(shift_ns);
  } else {
    odometry.shift_all(-shift_ns);
  }
  char text[160];
  std::snprintf(text, sizeof(text),
                "scans and odometry have the times of two clocks (%.1f s apart): the times of "
                "recording join them",
                static_cast<double>(shift_ns) * 1e-9);
  return text;
}

}  // namespace

RepairedStamps repair_stamps(std::span<const StampedMessage> scans,
                             std::span<const StampedMessage> odometry) {
  StampedTopic of_odometry("odometry messages", odometry);
  StampedTopic of_scans("scans", scans);
  of_odometry.join_runs();
  of_scans.join_runs_as(of_odometry);
  of_odometry.note_steps();
  if (of_scans.runs().size() != of_odometry.runs().size()) of_scans.note_steps();
  const std::string joined = join_clocks(of_scans, of_odometry);
  RepairedStamps repaired;
  repaired.scans_ns = of_scans.put_times();
  repaired.odometry_ns = of_odometry.put_times();
  repaired.scans_repeated = of_scans.repeated();
  if (!joined.empty()) repaired.notes.push_back(joined);
  for (const StampedTopic* topic : {&of_odometry, &of_scans}) {
    repaired.notes.insert(repaired.notes.end(), topic->notes().begin(), topic->notes().end());
  }
  return repaired;
}

}  // namespace topogeo::recording
