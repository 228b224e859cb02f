#include "channels/health_view.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include "channels/event_log.hpp"
#include "channels/protocol_names.hpp"
#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

using messaging::SampleInfo;
using Level = EventLog::Level;

std::optional<double> counter(const msg::ServiceStatus& status, std::string_view name) {
  for (const msg::Counter& one : status.counters()) {
    if (name == one.name().c_str()) return one.value();
  }
  return std::nullopt;
}

Json service_json(const msg::ServiceStatus& status) {
  return {{"service", text_of_message(status.service())},
          {"host", text_of_message(status.host())},
          {"state", name_of(status.state())},
          {"message", text_of_message(status.message())},
          {"waits_for", text_of_message(status.waits_for())},
          {"input", text_of_message(status.input())},
          {"input_rate_per_s", rounded(status.input_rate_per_s())},
          {"input_age_s", rounded(status.input_age_s())},
          {"faults", status.fault_count()},
          {"last_error", text_of_message(status.last_error())},
          {"cpu_s", rounded(counter(status, "cpu_s").value_or(0.0))},
          {"memory_bytes", counter(status, "resident_bytes").value_or(0.0)},
          {"version", text_of_message(status.version())}};
}

}  // namespace

HealthView::HealthView(service::Service& service, ChannelHub& hub, EventLog& events)
    : hub_(hub), events_(events), robot_id_(service.robot_id()) {
  service.subscribe<msg::ServiceStatus>(
      [this](const msg::ServiceStatus& status, const SampleInfo& info) {
        on_service(status, info);
      },
      {.any_robot = true}, [this](const SampleInfo& info) { on_service_gone(info); });
  service.subscribe<msg::WorkerStatus>(
      [this](const msg::WorkerStatus& status, const SampleInfo& info) { on_worker(status, info); },
      {.any_robot = true}, [this](const SampleInfo& info) { on_worker_gone(info); });
}

void HealthView::on_service(const msg::ServiceStatus& status, const SampleInfo& info) {
  const std::string robot = text_of_message(status.robot_id());
  if (!robot.empty() && robot != robot_id_) return;
  const std::string key =
      text_of_message(status.service()) + "@" + text_of_message(status.instance());
  keys_[info.instance] = key;
  Row& row = rows_[key];
  note(row, status);
  std::vector<Edit> edits = {{key, text_of(service_json(status))}};
  // A lost service that has come back under another name is not lost.
  for (auto other = rows_.begin(); other != rows_.end();) {
    const bool replaced =
        other->first != key && other->second.lost && other->second.service == row.service;
    if (replaced) edits.push_back({other->first, {}});
    other = replaced ? rows_.erase(other) : std::next(other);
  }
  hub_.edit(Channel::kServices, std::move(edits));
}

void HealthView::note(Row& row, const msg::ServiceStatus& status) {
  const std::string service = text_of_message(status.service());
  if (row.service.empty() || row.state != status.state() || row.lost) {
    const std::string text =
        with_reason(name_of(status.state()), text_of_message(status.message()));
    if (status.state() == msg::kServiceFailed) {
      events_.alarm(Level::kError, service, text);
    } else {
      events_.add(Level::kInfo, service, text);
    }
  }
  if (status.fault_count() > row.faults && !row.service.empty()) {
    events_.add(Level::kWarning, service, text_of_message(status.last_error()));
  }
  row.service = service;
  row.state = status.state();
  row.lost = false;
  row.faults = status.fault_count();
  row.last = status;
}

void HealthView::on_service_gone(const SampleInfo& info) {
  const auto key = keys_.find(info.instance);
  if (key == keys_.end()) return;
  const auto row = rows_.find(key->second);
  if (row != rows_.end() && row->second.state == msg::kServiceStopped) {
    hub_.edit(Channel::kServices, {{key->second, {}}});
    rows_.erase(row);
  } else if (row != rows_.end()) {
    row->second.lost = true;
    events_.alarm(Level::kError, row->second.service, "is gone");
    // Includes all fields that pages expect.
    Json lost = service_json(row->second.last);
    lost["state"] = "lost";
    hub_.edit(Channel::kServices, {{key->second, text_of(lost)}});
  }
  keys_.erase(key);
}

std::optional<double> HealthView::battery_percent() const {
  const auto gateway = std::ranges::find_if(rows_, [](const auto& row) {
    return row.second.service == "sensor_gateway" && !row.second.lost;
  });
  if (gateway == rows_.end()) return std::nullopt;
  return counter(gateway->second.last, "battery_percent");
}

bool HealthView::runs(const std::string& service) const {
  return std::ranges::any_of(rows_, [&](const auto& row) {
    return row.second.service == service && !row.second.lost &&
           row.second.state != msg::kServiceStopped;
  });
}

void HealthView::on_worker(const msg::WorkerStatus& status, const SampleInfo& info) {
  const std::string key = text_of_message(status.worker_id());
  workers_[info.instance] = key;
  hub_.edit(Channel::kWorkers, {{key, text_of(Json{{"name", text_of_message(status.name())},
                                                   {"host", text_of_message(status.host())},
                                                   {"slots", status.slots()},
                                                   {"in_hand", status.tasks_in_hand()},
                                                   {"load", rounded(status.load())},
                                                   {"tasks_per_s", rounded(status.tasks_per_s())},
                                                   {"tasks_done", status.tasks_done()},
                                                   {"failures", status.failures()},
                                                   {"draining", status.draining()}})}});
}

void HealthView::on_worker_gone(const SampleInfo& info) {
  const auto key = workers_.find(info.instance);
  if (key == workers_.end()) return;
  hub_.edit(Channel::kWorkers, {{key->second, {}}});
  workers_.erase(key);
}

}  // namespace topogeo::web
