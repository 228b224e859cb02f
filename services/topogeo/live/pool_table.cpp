#include "live/pool_table.hpp"

#include <algorithm>
#include <set>
#include <string_view>

#include <nlohmann/json.hpp>

#include "topogeo/support/format.hpp"

#include "common/service_table.hpp"
#include "live/worker_table.hpp"

namespace topogeo::cli {
namespace {

/// Worker names matter more than host names: they get this many more columns.
constexpr std::size_t kMoreOfWorkers = 6;
/// Reserved for the usual states, "  draining" being the longest.
constexpr std::size_t kPoolStateWidth = 10;
/// Lines of text() besides workers and robots: totals, two heads, two blanks.
constexpr std::size_t kOtherLines = 6;

std::uint64_t open_tasks(const msg::ServiceStatus& localizer) {
  for (const msg::QueueDepth& queue : localizer.queues()) {
    if (queue.name() == "match tasks") return queue.depth();
  }
  return 0;
}

std::string whole(double value) {
  return fmt::format("{:.0f}", value);
}

}  // namespace

void PoolTable::update(const msg::WorkerStatus& status, const messaging::SampleInfo& info,
                       Clock::time_point now) {
  const std::string id = status.worker_id().to_string();
  workers_[id] = {status, now};
  worker_ids_[info.instance] = id;
}

void PoolTable::remove_worker(const messaging::SampleInfo& info) {
  const auto id = worker_ids_.extract(info.instance);
  if (id) workers_.erase(id.mapped());
}

void PoolTable::update(const msg::ServiceStatus& status, const messaging::SampleInfo& info,
                       Clock::time_point now) {
  const std::string instance = status.instance().to_string();
  if (status.service() == "ga_worker") {
    faults_[instance] = status.fault_count();  // the instance is the worker id
    short_of_cpu_[instance] = cpu_shortage(status);
    service_ids_[info.instance] = instance;
  } else if (status.service() == "localizer") {
    const std::string key = status.robot_id().to_string() + '/' + instance;
    if (status.state() == msg::kServiceStopped) {
      robots_.erase(key);
      return;
    }
    RobotRow row{status, now, 0.0};
    if (const auto before = robots_.find(key); before != robots_.end()) {
      const double sent =
          counter(&status, "tasks_sent") - counter(&before->second.status, "tasks_sent");
      const std::chrono::duration<double> time = now - before->second.received;
      if (sent > 0.0 && time.count() > 0.0) row.sent_per_s = sent / time.count();
    }
    robots_[key] = std::move(row);
    service_ids_[info.instance] = key;
  }
}

void PoolTable::remove_service(const messaging::SampleInfo& info) {
  const auto id = service_ids_.extract(info.instance);
  if (!id) return;
  faults_.erase(id.mapped());
  short_of_cpu_.erase(id.mapped());
  robots_.erase(id.mapped());
}

void PoolTable::forget_silent(Clock::time_point now) {
  const auto silent = [&](const auto& entry) { return now - entry.second.received > kForget; };
  std::erase_if(workers_, silent);
  std::erase_if(robots_, silent);
}

std::uint64_t PoolTable::faults(const std::string& worker_id) const {
  const auto found = faults_.find(worker_id);
  return found == faults_.end() ? 0 : found->second;
}

std::string PoolTable::state(const Row<msg::WorkerStatus>& row, Clock::time_point now) const {
  std::string text = worker_state(row.status, now - row.received, version_, matcher_fingerprint_);
  const auto cpu = short_of_cpu_.find(row.status.worker_id().to_string());
  if (cpu != short_of_cpu_.end() && !cpu->second.empty()) text += "; " + cpu->second;
  return text;
}

std::string PoolTable::state(const RobotRow& row, Clock::time_point now) {
  if (now - row.received > kWorkerSilent) return "silent";
  std::string text(to_string(row.status.state()));
  if (const std::string cpu = cpu_shortage(row.status); !cpu.empty()) text += "; " + cpu;
  return text;
}

PoolTable::Total PoolTable::total(Clock::time_point now) const {
  Total total;
  total.workers = workers_.size();
  for (const auto& [id, row] : workers_) {
    if (now - row.received > kWorkerSilent) continue;
    total.slots += row.status.slots();
    total.busy_slots += row.status.load() * row.status.slots();
    total.tasks_per_s += row.status.tasks_per_s();
    total.tasks_in_hand += row.status.tasks_in_hand();
  }
  for (const auto& [key, row] : robots_) total.open_tasks += open_tasks(row.status);
  return total;
}

std::vector<std::string> PoolTable::worker_grid(std::size_t longest_name) const {
  std::set<std::string> hosts;
  std::set<std::string> names;
  for (const auto& [id, row] : workers_) {
    hosts.insert(row.status.host().to_string());
    names.insert(row.status.name().to_string());
  }
  const bool show_pid = names.size() < workers_.size();
  const bool show_host = hosts.size() > 1 && hosts != names;
  std::vector<std::string> titles = {"WORKER"};
  if (show_pid) titles.emplace_back("PID");
  if (show_host) titles.emplace_back("HOST");
  for (const char* title : {"SLOTS", "LOAD", "TASKS/s", "QUEUE", "FAULTS"}) {
    titles.emplace_back(title);
  }
  TextGrid grid(std::move(titles));
  for (const auto& [id, row] : workers_) {
    const msg::WorkerStatus& s = row.status;
    std::vector<std::string> cells = {
        shortened(s.name().to_string(), longest_name + kMoreOfWorkers)};
    if (show_pid) cells.push_back(std::to_string(s.process_id()));
    if (show_host) cells.push_back(shortened(s.host().to_string(), longest_name));
    cells.push_back(std::to_string(s.slots()));
    cells.push_back(whole(100.0 * s.load()) + " %");
    cells.push_back(fmt::format("{:.1f}", s.tasks_per_s()));
    cells.push_back(std::to_string(s.tasks_in_hand()));
    cells.push_back(std::to_string(faults(id)));
    grid.add(std::move(cells));
  }
  return grid.lines({"PID", "SLOTS", "LOAD", "TASKS/s", "QUEUE", "FAULTS"});
}

std::string PoolTable::worker_lines(Clock::time_point now, std::size_t columns,
                                    std::size_t rows) const {
  if (workers_.empty()) return "no search worker\n";
  std::size_t longest_name = kLongestName;
  std::vector<std::string> lines = worker_grid(longest_name);
  while (lines[0].size() + kPoolStateWidth > columns && longest_name > kShortestName) {
    lines = worker_grid(--longest_name);
  }
  std::vector<std::string> states;
  for (const auto& [id, row] : workers_) states.push_back(state(row, now));
  const std::size_t shown = rows == 0 ? states.size() : std::min(rows, states.size());
  const std::size_t more = states.size() - shown;
  lines.resize(1 + shown);
  states.resize(shown);
  return with_remarks(lines, "STATE", states, columns) +
         (more == 0 ? "" : fmt::format("and {} more: the window has no room\n", more));
}

std::string PoolTable::robot_lines(Clock::time_point now, std::size_t columns) const {
  if (robots_.empty()) return "no robot asks for work\n";
  TextGrid grid({"ROBOT", "OPEN", "SENT/s", "WORKERS", "LOST", "RESENT", "OWN"});
  std::vector<std::string> states;
  for (const auto& [key, row] : robots_) {
    const msg::ServiceStatus& s = row.status;
    grid.add({shortened(s.robot_id().to_string(), kLongestName), std::to_string(open_tasks(s)),
              fmt::format("{:.1f}", row.sent_per_s), whole(counter(&s, "workers")),
              whole(counter(&s, "workers_lost")), whole(counter(&s, "tasks_resent")),
              whole(counter(&s, "tasks_in_process"))});
    states.push_back(state(row, now));
  }
  return with_remarks(grid.lines({"OPEN", "SENT/s", "WORKERS", "LOST", "RESENT", "OWN"}),
                      "LOCALIZER", states, columns);
}

std::string PoolTable::text(Clock::time_point now, const TextSize& size) const {
  const Total sums = total(now);
  std::size_t rows = 0;
  if (size.rows > 0) {
    const std::size_t others = kOtherLines + std::max<std::size_t>(1, robots_.size());
    rows = size.rows > others ? size.rows - others : 1;
  }
  const double busy = sums.slots == 0 ? 0.0 : sums.busy_slots / static_cast<double>(sums.slots);
  return fmt::format(
             "{} worker{}, {} slot{} {:.0f} % busy, {:.1f} tasks/s, {} in hand, {} open\n\n",
             sums.workers, sums.workers == 1 ? "" : "s", sums.slots, sums.slots == 1 ? "" : "s",
             100.0 * busy, sums.tasks_per_s, sums.tasks_in_hand, sums.open_tasks) +
         worker_lines(now, size.columns, rows) + "\n" + robot_lines(now, size.columns);
}

std::string PoolTable::json(Clock::time_point now, int indent) const {
  nlohmann::ordered_json pool = {{"workers", nlohmann::ordered_json::array()},
                                 {"robots", nlohmann::ordered_json::array()}};
  for (const auto& [id, row] : workers_) {
    const msg::WorkerStatus& s = row.status;
    pool["workers"].push_back({{"worker_id", id},
                               {"name", s.name().c_str()},
                               {"host", s.host().c_str()},
                               {"process_id", s.process_id()},
                               {"slots", s.slots()},
                               {"load", s.load()},
                               {"tasks_per_s", s.tasks_per_s()},
                               {"tasks_in_hand", s.tasks_in_hand()},
                               {"tasks_done", s.tasks_done()},
                               {"failures", s.failures()},
                               {"fault_count", faults(id)},
                               {"state", state(row, now)}});
  }
  for (const auto& [key, row] : robots_) {
    const msg::ServiceStatus& s = row.status;
    pool["robots"].push_back({{"robot_id", s.robot_id().c_str()},
                              {"host", s.host().c_str()},
                              {"state", to_string(s.state())},
                              {"open_tasks", open_tasks(s)},
                              {"tasks_sent_per_s", row.sent_per_s},
                              {"workers", counter(&s, "workers")},
                              {"workers_lost", counter(&s, "workers_lost")},
                              {"tasks_resent", counter(&s, "tasks_resent")},
                              {"tasks_in_process", counter(&s, "tasks_in_process")}});
  }
  const Total sums = total(now);
  pool["total"] = {{"workers", sums.workers},
                   {"slots", sums.slots},
                   {"busy_slots", sums.busy_slots},
                   {"tasks_per_s", sums.tasks_per_s},
                   {"tasks_in_hand", sums.tasks_in_hand},
                   {"open_tasks", sums.open_tasks}};
  return pool.dump(indent) + "\n";
}

}  // namespace topogeo::cli
