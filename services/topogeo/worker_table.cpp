#include "worker_table.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "topogeo/support/format.hpp"

namespace topogeo::cli {
namespace {

using Clock = WorkerTable::Clock;

double silence_s(Clock::time_point heard, Clock::time_point now) {
  return std::chrono::duration<double>(now - heard).count();
}

std::string duration_text(double seconds) {
  const auto whole = static_cast<std::uint64_t>(std::max(0.0, seconds));
  if (whole >= 3600)
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

}  // namespace

void WorkerTable::update(const msg::WorkerStatus& status, const messaging::SampleInfo& info,
                         Clock::time_point now) {
  const std::string id = status.worker_id().c_str();
  rows_[id] = {status, now};
  ids_[info.instance] = id;
}

void WorkerTable::remove(const messaging::SampleInfo& info) {
  const auto found = ids_.find(info.instance);
  if (found == ids_.end()) return;
  rows_.erase(found->second);
  ids_.erase(found);
}

void WorkerTable::forget_silent(Clock::time_point now) {
  std::erase_if(rows_, [&](const auto& row) { return now - row.second.heard > kForget; });
}

std::string WorkerTable::state(const Row& row, Clock::time_point now) const {
  const msg::WorkerStatus& status = row.status;
  if (now - row.heard > kSilent) {
    return fmt::format("silent for {:.0f} s", silence_s(row.heard, now));
  }
  if (version_ != status.version().c_str()) {
    return fmt::format("other version: {}, this is {}", status.version().c_str(), version_);
  }
  if (status.matcher_fingerprint() != matcher_fingerprint_) {
    return "other build: computes differently";
  }
  if (status.draining()) return "draining";
  return status.tasks_in_hand() > 0 || status.load() > 0.0 ? "working" : "idle";
}

std::string WorkerTable::text(Clock::time_point now) const {
  constexpr std::string_view kRow =
      "{:<24} {:<16} {:>7} {:>5} {:>6} {:>7} {:>9} {:>8} {:>7} {:>6} "
      "{:>5} {:>8}  {}\n";
  std::string text =
      fmt::format(fmt::runtime(kRow), "WORKER", "HOST", "PID", "SLOTS", "LOAD", "IN HAND", "DONE",
                  "TASKS/s", "FAILED", "ROBOTS", "MAPS", "UP", "STATE");
  std::uint64_t slots = 0;
  double busy_slots = 0.0;
  double tasks_per_s = 0.0;
  std::uint64_t done = 0;
  for (const auto& [id, row] : rows_) {
    const msg::WorkerStatus& s = row.status;
    text += fmt::format(fmt::runtime(kRow), s.name().c_str(), s.host().c_str(), s.process_id(),
                        s.slots(), fmt::format("{:.0f} %", 100.0 * s.load()), s.tasks_in_hand(),
                        s.tasks_done(), fmt::format("{:.1f}", s.tasks_per_s()), s.failures(),
                        s.clients(), s.maps_held(), duration_text(s.uptime_s()), state(row, now));
    if (now - row.heard > kSilent) continue;
    slots += s.slots();
    busy_slots += s.load() * s.slots();
    tasks_per_s += s.tasks_per_s();
    done += s.tasks_done();
  }
  text += fmt::format("{} worker{}, {} slot{}, {:.0f} % busy, {} tasks done, {:.1f} tasks/s\n",
                      rows_.size(), rows_.size() == 1 ? "" : "s", slots, slots == 1 ? "" : "s",
                      slots == 0 ? 0.0 : 100.0 * busy_slots / static_cast<double>(slots), done,
                      tasks_per_s);
  return text;
}

std::string WorkerTable::json(Clock::time_point now) const {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const auto& [id, row] : rows_) {
    const msg::WorkerStatus& s = row.status;
    list.push_back({{"worker_id", id},
                    {"name", s.name().c_str()},
                    {"host", s.host().c_str()},
                    {"process_id", s.process_id()},
                    {"slots", s.slots()},
                    {"load", s.load()},
                    {"tasks_in_hand", s.tasks_in_hand()},
                    {"tasks_done", s.tasks_done()},
                    {"tasks_per_s", s.tasks_per_s()},
                    {"failures", s.failures()},
                    {"clients", s.clients()},
                    {"maps_held", s.maps_held()},
                    {"uptime_s", s.uptime_s()},
                    {"version", s.version().c_str()},
                    {"state", state(row, now)}});
  }
  return list.dump(2) + "\n";
}

}  // namespace topogeo::cli
