#include "unheard_services.hpp"

#include <algorithm>
#include <set>

#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/topics.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::cli {

void UnheardServices::heard(const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
  heard_.insert(info.writer);
  processes_heard_.emplace(status.host().to_string(), status.service().to_string(),
                           status.process_id());
}

void UnheardServices::discovered(std::span<const messaging::RemoteEndpoint> endpoints, Time now) {
  std::map<messaging::Handle, Writer> before;
  before.swap(writers_);
  for (const messaging::RemoteEndpoint& one : endpoints) {
    const bool wanted = partition_ == messaging::kAnyPartition ||
                        std::ranges::find(one.partitions, partition_) != one.partitions.end();
    if (!one.writer || one.topic != messaging::kServiceStatus || !wanted) continue;
    const auto known = before.find(one.id);
    writers_[one.id] = {one.participant, known == before.end() ? now : known->second.since};
  }
}

void UnheardServices::running(std::vector<HostProcess> processes, const std::string& host) {
  running_ = std::move(processes);
  host_ = host;
}

bool UnheardServices::may_come(Time now) const {
  return std::ranges::any_of(writers_, [&](const auto& entry) {
    return !heard_.contains(entry.first) && now - entry.second.since < kFirstStatus;
  });
}

std::vector<UnheardService> UnheardServices::list(Time now) const {
  std::vector<UnheardService> unheard;
  std::set<std::string> named;
  for (const HostProcess& process : running_) {
    const bool wanted = process.domain == domain_ &&
                        (partition_ == messaging::kAnyPartition || partition_ == process.partition);
    const auto own_pid = static_cast<std::uint32_t>(process.own_pid);
    if (!wanted || processes_heard_.contains({host_, process.service, own_pid})) continue;
    if (!process.stopped && process.age_s < kStarting_s) continue;
    named.insert(process.service);
    unheard.push_back(
        {process.service, fmt::format("process {} of this host {}, and no status of it comes",
                                      process.pid, process.stopped ? "is stopped" : "runs")});
  }
  for (const auto& [id, writer] : writers_) {
    if (heard_.contains(id) || now - writer.since < kFirstStatus) continue;
    const std::string name = writer.participant.substr(writer.participant.rfind('/') + 1);
    if (named.contains(name)) continue;
    unheard.push_back(
        {name, fmt::format("discovery finds '{}', and no status of it comes", writer.participant)});
  }
  std::ranges::stable_sort(unheard, {}, &UnheardService::name);
  return unheard;
}

}  // namespace topogeo::cli
