#include "live/status_table.hpp"

#include <algorithm>
#include <set>
#include <tuple>

#include <nlohmann/json.hpp>

#include "topogeo/messaging/deafness.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/printable.hpp"

#include "common/service_table.hpp"
#include "common/text_grid.hpp"

namespace topogeo::cli {
namespace {

/// Service names matter more: they get this many more columns.
constexpr std::size_t kMoreOfServices = 6;
constexpr const char* kMissing = "missing";
constexpr const char* kSilentState = "silent";
/// An older fault does not explain the present state of a service.
constexpr double kRecentError_s = 60.0;

/// "0.3 s", "12 s", "5 min", "3 h".
std::string age_text(double age_s) {
  constexpr double kMinute_s = 60.0;
  constexpr double kHour_s = 3600.0;
  if (age_s < 10.0) return fmt::format("{:.1f} s", std::max(0.0, age_s));
  if (age_s < 2.0 * kMinute_s) return fmt::format("{:.0f} s", age_s);
  if (age_s < 2.0 * kHour_s) return fmt::format("{:.0f} min", age_s / kMinute_s);
  return fmt::format("{:.0f} h", age_s / kHour_s);
}

std::string rate_text(double rate_per_s) {
  return rate_per_s < 10.0 ? fmt::format("{:.1f}", rate_per_s) : fmt::format("{:.0f}", rate_per_s);
}

std::string traffic_text(const msg::TopicTraffic& one) {
  return fmt::format("{:<34} {}, {}/s{}", one.topic().c_str(), one.messages(),
                     rate_text(one.rate_per_s()),
                     one.waiting() == 0 ? "" : fmt::format(", {} waiting", one.waiting()));
}

}  // namespace

void StatusTable::update(const msg::ServiceStatus& status, const messaging::SampleInfo& info,
                         Clock::time_point now) {
  Name name{status.service().c_str(), status.instance().c_str()};
  if (status.state() == msg::kServiceStopped) {
    rows_.erase(name);
    names_.erase(info.instance);
    return;
  }
  rows_[name] = {status, now, false};
  names_[info.instance] = std::move(name);
}

void StatusTable::remove(const messaging::SampleInfo& info) {
  const auto name = names_.extract(info.instance);
  if (!name) return;
  const auto row = rows_.find(name.mapped());
  if (row == rows_.end()) return;
  if (row->second.status.state() == msg::kServiceFinished) {
    rows_.erase(row);
  } else {
    row->second.lost = true;
  }
}

void StatusTable::forget(Clock::time_point now) {
  std::erase_if(rows_, [&](const auto& entry) { return now - entry.second.received > kForget; });
}

void StatusTable::keep_only(std::string_view service) {
  std::erase_if(rows_, [&](const auto& entry) { return entry.first.first != service; });
}

void StatusTable::expect(const std::vector<std::string>& services) {
  for (const std::string& service : services) {
    if (std::ranges::find(expected_, service) == expected_.end()) expected_.push_back(service);
  }
}

std::vector<std::string> StatusTable::missing() const {
  std::vector<std::string> missing = expected_;
  for (const auto& [name, row] : rows_) std::erase(missing, name.first);
  for (const UnheardService& one : unheard_) std::erase(missing, one.name);
  return missing;
}

std::vector<StatusTable::Absent> StatusTable::absent() const {
  std::vector<Absent> absent;
  for (const std::string& service : missing()) {
    absent.push_back({service, kMissing, "expected, and not found"});
  }
  for (const UnheardService& one : unheard_) absent.push_back({one.name, kSilentState, one.reason});
  for (const IdleUnit& unit : units_) {
    absent.push_back(
        {unit.name, unit.restarts ? "restarting" : "failed", "see journalctl -u " + unit.name});
  }
  return absent;
}

bool StatusTable::is_gone(const Row& row, Clock::time_point now) {
  return row.lost || now - row.received > kSilent;
}

std::string StatusTable::deafness(const Row& row, Clock::time_point now) const {
  if (is_gone(row, now)) return {};
  const auto heard = [now](const Row& one) {
    return messaging::HeardStatus{&one.status,
                                  std::chrono::duration<double>(now - one.received).count()};
  };
  std::vector<messaging::HeardStatus> all;
  for (const auto& [name, one] : rows_) {
    if (!is_gone(one, now)) all.push_back(heard(one));
  }
  return messaging::deafness(heard(row), all);
}

bool StatusTable::unwell(const Row& row, Clock::time_point now) const {
  return is_gone(row, now) || row.status.state() == msg::kServiceFailed ||
         !deafness(row, now).empty();
}

bool StatusTable::healthy(Clock::time_point now) const {
  return absent().empty() &&
         std::ranges::none_of(rows_, [&](const auto& row) { return unwell(row.second, now); });
}

std::string StatusTable::state(const Row& row, Clock::time_point now) const {
  if (row.status.state() != msg::kServiceFailed) {
    if (row.lost) return "lost";
    if (now - row.received > kSilent) return kSilentState;
    if (!deafness(row, now).empty()) return "deaf";
  }
  return std::string(to_string(row.status.state()));
}

std::string StatusTable::reason(const Row& row, Clock::time_point now) const {
  const std::string message = row.status.message().to_string();
  const std::string age = age_text(std::chrono::duration<double>(now - row.received).count());
  std::string why;
  if (row.lost) {
    why = "ended without notice " + age + " ago";
  } else if (now - row.received > kSilent) {
    why = "no status for " + age;
  } else {
    why = deafness(row, now);
  }
  std::string text = why.empty() || message.empty() ? why + message : why + "; before: " + message;
  const auto add = [&text](const std::string& more) { text += (text.empty() ? "" : "; ") + more; };
  const std::string waits_for = row.status.waits_for().to_string();
  if (!waits_for.empty() && row.status.state() != msg::kServiceWaiting) {
    add("needs " + waits_for);
  }
  if (const std::string cpu = cpu_shortage(row.status); !cpu.empty()) add(cpu);
  const double error_age_s = last_error_age_s(row, now);
  if (row.status.last_error().size() > 0 && row.status.state() != msg::kServiceFailed &&
      error_age_s < kRecentError_s) {
    add(age_text(error_age_s) + " ago: " + row.status.last_error().to_string());
  }
  return text;
}

double StatusTable::last_error_age_s(const Row& row, Clock::time_point now) {
  return row.status.last_error_age_s() + std::chrono::duration<double>(now - row.received).count();
}

double StatusTable::input_age_s(const Row& row, Clock::time_point now) {
  return row.status.input_age_s() + std::chrono::duration<double>(now - row.received).count();
}

std::vector<const StatusTable::Row*> StatusTable::ordered() const {
  std::vector<const Row*> rows;
  for (const auto& [name, row] : rows_) rows.push_back(&row);
  std::ranges::stable_sort(rows, {},
                           [](const Row* row) { return row->status.robot_id().to_string(); });
  return rows;
}

StatusTable::Shown StatusTable::shown() const {
  std::set<std::string> hosts;
  std::set<std::string> robots;
  std::set<std::tuple<std::string, std::string, std::string>> names;
  for (const auto& [name, row] : rows_) {
    const msg::ServiceStatus& s = row.status;
    hosts.insert(s.host().to_string());
    if (const std::string robot = s.robot_id().to_string(); !robot.empty()) robots.insert(robot);
    names.emplace(name.first, s.host().to_string(), s.robot_id().to_string());
  }
  return {names.size() < rows_.size(), robots.size() > 1, hosts.size() > 1};
}

std::vector<std::string> StatusTable::lines(Clock::time_point now, const Shown& shown,
                                            std::size_t longest_name) const {
  std::vector<std::string> titles = {"SERVICE"};
  if (shown.pid) titles.emplace_back("PID");
  if (shown.robot) titles.emplace_back("ROBOT");
  if (shown.host) titles.emplace_back("HOST");
  for (const char* title : {"STATE", "INPUT/s", "AGE", "FAULTS"}) titles.emplace_back(title);
  TextGrid grid(std::move(titles));
  for (const Row* row : ordered()) {
    const msg::ServiceStatus& s = row->status;
    std::vector<std::string> cells = {
        shortened(s.service().to_string(), longest_name + kMoreOfServices)};
    if (shown.pid) cells.push_back(std::to_string(s.process_id()));
    if (shown.robot) cells.push_back(shortened(s.robot_id().to_string(), longest_name));
    if (shown.host) cells.push_back(shortened(s.host().to_string(), longest_name));
    cells.push_back(state(*row, now));
    cells.push_back(s.inputs() == 0 ? "-" : rate_text(s.input_rate_per_s()));
    cells.push_back(s.inputs() == 0 ? "-" : age_text(input_age_s(*row, now)));
    cells.push_back(std::to_string(s.fault_count()));
    grid.add(std::move(cells));
  }
  for (const Absent& one : absent()) {
    std::vector<std::string> cells = {shortened(one.name, longest_name + kMoreOfServices)};
    for (const bool column : {shown.pid, shown.robot, shown.host}) {
      if (column) cells.emplace_back("-");
    }
    cells.push_back(one.state);
    cells.insert(cells.end(), 3, "-");  // input, age, faults
    grid.add(std::move(cells));
  }
  return grid.lines({"PID", "INPUT/s", "AGE", "FAULTS"});
}

std::string StatusTable::text(Clock::time_point now, std::size_t columns) const {
  const Shown shown = this->shown();
  std::size_t longest_name = kLongestName;
  std::vector<std::string> lines = this->lines(now, shown, longest_name);
  while (lines[0].size() > columns && longest_name > kShortestName) {
    lines = this->lines(now, shown, --longest_name);
  }
  std::vector<std::string> reasons;
  for (const Row* row : ordered()) reasons.push_back(reason(*row, now));
  for (Absent& one : absent()) reasons.push_back(std::move(one.reason));
  return with_remarks(lines, "REASON", reasons, columns) + sums(now);
}

std::string StatusTable::sums(Clock::time_point now) const {
  if (rows_.empty() && unheard_.empty() && absent().empty()) return "no service is alive\n";
  std::uint64_t faults = 0;
  std::size_t ill = unheard_.size();
  std::set<std::string> busy_hosts;
  for (const auto& [name, row] : rows_) {
    faults += row.status.fault_count();
    if (unwell(row, now)) ++ill;
    if (!cpu_shortage(row.status).empty()) busy_hosts.insert(row.status.host().to_string());
  }
  const std::size_t missing = this->missing().size();
  std::string busy;
  for (const std::string& host : busy_hosts) {
    busy += fmt::format("the CPU of {} is short: see topogeo doctor\n", support::printable(host));
  }
  return fmt::format("{} service{}, {}{}{} failed, lost, silent or deaf, {} fault{}\n{}",
                     rows_.size() + unheard_.size(), rows_.size() + unheard_.size() == 1 ? "" : "s",
                     missing == 0 ? "" : fmt::format("{} {}, ", missing, kMissing),
                     units_.empty() ? ""
                                    : fmt::format("{} unit{} of this host not running, ",
                                                  units_.size(), units_.size() == 1 ? "" : "s"),
                     ill == 0 ? "none" : std::to_string(ill), faults, faults == 1 ? "" : "s", busy);
}

std::string StatusTable::details(Clock::time_point now) const {
  std::string text;
  for (const Row* row : ordered()) {
    const msg::ServiceStatus& s = row->status;
    const std::string robot = s.robot_id().to_string();
    const std::string head = fmt::format("{}  {}{}", s.service().c_str(), state(*row, now),
                                         robot.empty() ? "" : ", robot " + robot);
    text += fmt::format("{}{}\n", text.empty() ? "" : "\n", support::printable(head));
    const auto add = [&text](std::string_view name, const std::string& value) {
      text += fmt::format("  {:<10} {}\n", name, support::printable(value));
    };
    if (const std::string why = reason(*row, now); !why.empty()) add("reason", why);
    add("process", fmt::format("{} on {}, version {}, instance {}", s.process_id(),
                               s.host().c_str(), s.version().c_str(), s.instance().c_str()));
    if (s.config_fingerprint() != 0) {
      add("config", fmt::format("{:016x}", s.config_fingerprint()));
    }
    add("up", age_text(s.uptime_s()));
    if (s.waits_for().size() > 0) add("waits for", s.waits_for().to_string());
    if (s.inputs() > 0) {
      add("input", fmt::format("{} {}, {}/s, the last {} ago", s.inputs(), s.input().c_str(),
                               rate_text(s.input_rate_per_s()), age_text(input_age_s(*row, now))));
    }
    for (const msg::FaultCount& fault : s.faults()) {
      add("fault", fmt::format("{} {}", fault.count(), fault.reason().c_str()));
    }
    if (s.last_error().size() > 0) {
      add("last error",
          fmt::format("{} ago: {}", age_text(last_error_age_s(*row, now)), s.last_error().c_str()));
    }
    for (const msg::FaultCount& drop : s.drops()) {
      add("dropped", fmt::format("{} {}", drop.count(), drop.reason().c_str()));
    }
    for (const msg::QueueDepth& queue : s.queues()) {
      add("queue",
          fmt::format("{:<34} {}{}", queue.name().c_str(), queue.depth(),
                      queue.capacity() == 0 ? "" : fmt::format(" of {}", queue.capacity())));
    }
    for (const bool sent : {false, true}) {
      for (const msg::TopicTraffic& one : s.traffic()) {
        if (one.sent() == sent) add(sent ? "sent" : "received", traffic_text(one));
      }
    }
    for (const msg::Counter& counter : s.counters()) {
      add("counter", fmt::format("{:<34} {:.10g}", counter.name().c_str(), counter.value()));
    }
  }
  for (const Absent& one : absent()) {
    text += fmt::format("{}{}  {}\n  {:<10} {}\n", text.empty() ? "" : "\n", one.name, one.state,
                        "reason", one.reason);
  }
  return text;
}

std::string StatusTable::json(Clock::time_point now) const {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Row* row : ordered()) {
    const msg::ServiceStatus& s = row->status;
    nlohmann::ordered_json service = {
        {"service", s.service().c_str()},
        {"instance", s.instance().c_str()},
        {"robot_id", s.robot_id().c_str()},
        {"host", s.host().c_str()},
        {"process_id", s.process_id()},
        {"version", s.version().c_str()},
        {"state", state(*row, now)},
        {"message", s.message().c_str()},
        {"waits_for", s.waits_for().c_str()},
        {"last_error", s.last_error().c_str()},
        {"last_error_age_s", nullptr},
        {"config_fingerprint", fmt::format("{:016x}", s.config_fingerprint())},
        {"uptime_s", s.uptime_s()},
        {"silent_s", std::chrono::duration<double>(now - row->received).count()},
        {"input", s.input().c_str()},
        {"inputs", s.inputs()},
        {"input_rate_per_s", s.input_rate_per_s()},
        {"input_age_s", nullptr},
        {"fault_count", s.fault_count()},
        {"faults", nlohmann::ordered_json::object()},
        {"drops", nlohmann::ordered_json::object()},
        {"queues", nlohmann::ordered_json::array()},
        {"traffic", nlohmann::ordered_json::array()},
        {"counters", nlohmann::ordered_json::object()}};
    if (s.inputs() > 0) service["input_age_s"] = input_age_s(*row, now);
    for (const msg::FaultCount& fault : s.faults()) {
      service["faults"][fault.reason().c_str()] = fault.count();
    }
    if (s.last_error().size() > 0) service["last_error_age_s"] = last_error_age_s(*row, now);
    for (const msg::FaultCount& drop : s.drops()) {
      service["drops"][drop.reason().c_str()] = drop.count();
    }
    for (const msg::QueueDepth& queue : s.queues()) {
      service["queues"].push_back({{"name", queue.name().c_str()},
                                   {"depth", queue.depth()},
                                   {"capacity", queue.capacity()}});
    }
    for (const msg::TopicTraffic& one : s.traffic()) {
      service["traffic"].push_back({{"topic", one.topic().c_str()},
                                    {"sent", one.sent()},
                                    {"messages", one.messages()},
                                    {"rate_per_s", one.rate_per_s()},
                                    {"waiting", one.waiting()}});
    }
    for (const msg::Counter& counter : s.counters()) {
      service["counters"][counter.name().c_str()] = counter.value();
    }
    list.push_back(std::move(service));
  }
  for (const Absent& one : absent()) {
    list.push_back({{"service", one.name}, {"state", one.state}, {"message", one.reason}});
  }
  return list.dump(2) + "\n";
}

}  // namespace topogeo::cli
