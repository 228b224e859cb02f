#include "common/service_table.hpp"

#include "topogeo/service/cpu_watch.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::cli {
namespace {

/// Times and resources of a process change even without work.
bool is_work(std::string_view name) {
  return !name.ends_with("_s") && name != "resident_bytes" && name != "open_files" &&
         !name.starts_with("cpu_");
}

std::string text(const auto& bounded) {
  return bounded.c_str();
}

}  // namespace

void ServiceTable::update(const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
  Name name{text(status.service()), text(status.instance())};
  by_name_[name] = status;
  names_[info.instance] = std::move(name);
}

void ServiceTable::remove(const messaging::SampleInfo& info) {
  const auto found = names_.find(info.instance);
  if (found == names_.end()) return;
  by_name_.erase(found->second);
  names_.erase(found);
}

std::vector<const msg::ServiceStatus*> ServiceTable::rows() const {
  std::vector<const msg::ServiceStatus*> rows;
  for (const auto& [name, status] : by_name_) rows.push_back(&status);
  return rows;
}

const msg::ServiceStatus* ServiceTable::find(std::string_view service) const {
  const msg::ServiceStatus* newest = nullptr;
  for (const msg::ServiceStatus* row : rows()) {
    if (service != row->service().c_str()) continue;
    if (newest == nullptr || row->started_ns() > newest->started_ns()) newest = row;
  }
  return newest;
}

std::string ServiceTable::short_of_cpu() const {
  std::string names;
  for (const msg::ServiceStatus* row : rows()) {
    if (cpu_shortage(*row).empty()) continue;
    names += (names.empty() ? "" : ", ") + std::string(row->service().c_str());
  }
  return names;
}

std::string ServiceTable::progress_mark() const {
  std::string mark;
  for (const msg::ServiceStatus* row : rows()) {
    if (row->service() == "ga_worker") continue;  // it may be busy for another run
    mark += fmt::format("{}={}", row->instance().c_str(), static_cast<int>(row->state()));
    for (const msg::Counter& c : row->counters()) {
      if (is_work(c.name().c_str())) mark += fmt::format(",{}={}", c.name().c_str(), c.value());
    }
    mark += ';';
  }
  return mark;
}

double counter(const msg::ServiceStatus* status, std::string_view name) {
  if (status == nullptr) return 0.0;
  for (const msg::Counter& c : status->counters()) {
    if (name == c.name().c_str()) return c.value();
  }
  return 0.0;
}

std::string cpu_shortage(const msg::ServiceStatus& status) {
  if (counter(&status, service::CpuWatch::kShort) == 0.0) return {};
  return fmt::format("the CPU is short: timers fire up to {:.1f} s late",
                     counter(&status, service::CpuWatch::kTimerDelay));
}

std::string_view to_string(msg::ServiceState state) {
  switch (state) {
    case msg::kServiceStarting:
      return "starting";
    case msg::kServiceWaiting:
      return "waiting";
    case msg::kServiceRunning:
      return "running";
    case msg::kServiceFinished:
      return "finished";
    case msg::kServiceFailed:
      return "failed";
    case msg::kServiceStopped:
      return "stopped";
  }
  return "unknown";
}

std::string describe_states(const ServiceTable& table) {
  std::string states;
  for (const msg::ServiceStatus* row : table.rows()) {
    if (!states.empty()) states += "; ";
    states += fmt::format("{} {}", row->service().c_str(), to_string(row->state()));
    if (const std::string message = text(row->message()); !message.empty()) {
      states += ": " + message;
    }
    if (const std::string cpu = cpu_shortage(*row); !cpu.empty()) states += ", " + cpu;
  }
  return states.empty() ? "no service has published its status" : states;
}

}  // namespace topogeo::cli
