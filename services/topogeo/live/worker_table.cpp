#include "live/worker_table.hpp"

#include <algorithm>
#include <set>
#include <string_view>

#include <nlohmann/json.hpp>

#include "topogeo/support/format.hpp"

namespace topogeo::cli {
namespace {

using Clock = WorkerTable::Clock;

/// Worker names matter more than host names: they get this many more columns.
constexpr std::size_t kMoreOfNames = 6;
/// Reserved for the usual states, "  draining" being the longest.
constexpr std::size_t kStateWidth = 10;

std::string duration_text(double duration_s) {
  const auto whole = static_cast<std::uint64_t>(std::max(0.0, duration_s));
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
  std::erase_if(rows_, [&](const auto& row) { return now - row.second.received > kForget; });
}

std::string worker_state(const msg::WorkerStatus& status, std::chrono::nanoseconds silence,
                         const std::string& version, std::uint64_t matcher_fingerprint) {
  if (silence > kWorkerSilent) {
    return fmt::format("silent for {:.0f} s", std::chrono::duration<double>(silence).count());
  }
  if (version != status.version().c_str()) {
    return fmt::format("other version: {}, this is {}", status.version().c_str(), version);
  }
  if (status.matcher_fingerprint() != matcher_fingerprint) {
    return "other build: computes differently";
  }
  if (status.draining()) return "draining";
  return status.tasks_in_hand() > 0 || status.load() > 0.0 ? "working" : "idle";
}

std::string WorkerTable::state(const Row& row, Clock::time_point now) const {
  return worker_state(row.status, now - row.received, version_, matcher_fingerprint_);
}

std::vector<std::string> WorkerTable::lines(std::size_t longest_name) const {
  std::set<std::string> hosts;
  std::set<std::string> names;
  for (const auto& [id, row] : rows_) {
    hosts.insert(row.status.host().to_string());
    names.insert(row.status.name().to_string());
  }
  const bool show_pid = names.size() < rows_.size();
  const bool show_host = hosts.size() > 1 && hosts != names;
  std::vector<std::string> titles = {"WORKER"};
  if (show_pid) titles.emplace_back("PID");
  if (show_host) titles.emplace_back("HOST");
  for (const char* title : {"SLOTS", "LOAD", "DONE", "TASKS/s", "FAILED"}) {
    titles.emplace_back(title);
  }
  TextGrid grid(std::move(titles));
  for (const auto& [id, row] : rows_) {
    const msg::WorkerStatus& s = row.status;
    std::vector<std::string> cells = {shortened(s.name().to_string(), longest_name + kMoreOfNames)};
    if (show_pid) cells.push_back(std::to_string(s.process_id()));
    if (show_host) cells.push_back(shortened(s.host().to_string(), longest_name));
    cells.push_back(std::to_string(s.slots()));
    cells.push_back(fmt::format("{:.0f} %", 100.0 * s.load()));
    cells.push_back(std::to_string(s.tasks_done()));
    cells.push_back(fmt::format("{:.1f}", s.tasks_per_s()));
    cells.push_back(std::to_string(s.failures()));
    grid.add(std::move(cells));
  }
  return grid.lines({"PID", "SLOTS", "LOAD", "DONE", "TASKS/s", "FAILED"});
}

std::string WorkerTable::text(Clock::time_point now, std::size_t columns) const {
  std::size_t longest_name = kLongestName;
  std::vector<std::string> lines = this->lines(longest_name);
  while (lines[0].size() + kStateWidth > columns && longest_name > kShortestName) {
    lines = this->lines(--longest_name);
  }
  std::vector<std::string> states;
  for (const auto& [id, row] : rows_) states.push_back(state(row, now));
  return with_remarks(lines, "STATE", states, columns) + sums(now);
}

std::string WorkerTable::sums(Clock::time_point now) const {
  std::uint64_t slots = 0;
  double busy_slots = 0.0;
  double tasks_per_s = 0.0;
  std::uint64_t done = 0;
  for (const auto& [id, row] : rows_) {
    if (now - row.received > kSilent) continue;
    const msg::WorkerStatus& s = row.status;
    slots += s.slots();
    busy_slots += s.load() * s.slots();
    tasks_per_s += s.tasks_per_s();
    done += s.tasks_done();
  }
  return fmt::format("{} worker{}, {} slot{}, {:.0f} % busy, {} tasks done, {:.1f} tasks/s\n",
                     rows_.size(), rows_.size() == 1 ? "" : "s", slots, slots == 1 ? "" : "s",
                     slots == 0 ? 0.0 : 100.0 * busy_slots / static_cast<double>(slots), done,
                     tasks_per_s);
}

std::string WorkerTable::details(Clock::time_point now) const {
  std::string text;
  for (const auto& [id, row] : rows_) {
    const msg::WorkerStatus& s = row.status;
    text += fmt::format("{}{}  {}\n", text.empty() ? "" : "\n", s.name().c_str(), state(row, now));
    const auto add = [&text](std::string_view name, const std::string& value) {
      text += fmt::format("  {:<8} {}\n", name, value);
    };
    add("process",
        fmt::format("{} on {}, version {}", s.process_id(), s.host().c_str(), s.version().c_str()));
    add("id", id);
    add("up", duration_text(s.uptime_s()));
    add("load", fmt::format("{:.0f} % of {} slots, {} tasks in hand", 100.0 * s.load(), s.slots(),
                            s.tasks_in_hand()));
    add("tasks",
        fmt::format("{} done, {:.1f}/s, {} failed", s.tasks_done(), s.tasks_per_s(), s.failures()));
    add("serves", fmt::format("{} robots, {} maps held", s.clients(), s.maps_held()));
  }
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
