#include "live/unheard_services.hpp"

#include <algorithm>
#include <set>

#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/topics.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::cli {
namespace {

/// How likely a process is the heard one of several with its number, the likeliest first: a young
/// process may not have joined its domain yet, and a stopped one publishes nothing.
enum class Likelihood : std::uint8_t { kRuns, kStarts, kStopped };

Likelihood likelihood(const HostProcess* process) {
  if (process->stopped) return Likelihood::kStopped;
  return process->age_s < UnheardServices::kStarting_s ? Likelihood::kStarts : Likelihood::kRuns;
}

/// A reason for running processes that share their number with `heard` services, which may be any
/// of them.
std::string some_are_silent(std::span<const HostProcess* const> processes, std::size_t heard) {
  std::string numbers;
  for (const HostProcess* process : processes) {
    numbers += (numbers.empty() ? "" : ", ") + std::to_string(process->pid);
  }
  const std::size_t silent = processes.size() - heard;
  if (silent == 1) {
    return fmt::format("one of the processes {} of this host publishes no status", numbers);
  }
  return fmt::format("{} of the processes {} of this host publish no status", silent, numbers);
}

}  // namespace

void UnheardServices::heard(const msg::ServiceStatus& status, const messaging::SampleInfo& info,
                            Time now) {
  heard_.insert(info.writer);
  auto& instances =
      instances_[{status.host().to_string(), {status.service().to_string(), status.process_id()}}];
  std::erase_if(instances, [&](const auto& one) { return now - one.second > kRemembered; });
  instances[status.instance().to_string()] = now;
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

std::size_t UnheardServices::services_heard(const Numbered& name, Time now) const {
  const auto found = instances_.find({host_, name});
  if (found == instances_.end()) return 0;
  return static_cast<std::size_t>(std::ranges::count_if(
      found->second, [&](const auto& one) { return now - one.second <= kRemembered; }));
}

// A heard service accounts for one process: containers count their processes each from 1, so
// services of one name in several of them often have the same number.
std::vector<UnheardService> UnheardServices::silent_processes(Time now) const {
  std::map<Numbered, std::vector<const HostProcess*>> by_name;
  for (const HostProcess& process : running_) {
    const bool wanted = process.domain == domain_ &&
                        (partition_ == messaging::kAnyPartition || partition_ == process.partition);
    if (!wanted) continue;
    by_name[{process.service, static_cast<std::uint32_t>(process.own_pid)}].push_back(&process);
  }
  std::vector<UnheardService> silent;
  for (auto& [name, processes] : by_name) {
    std::ranges::stable_sort(processes, {}, likelihood);
    const std::size_t accounted = services_heard(name, now);
    const auto candidates =
        static_cast<std::size_t>(std::ranges::count(processes, Likelihood::kRuns, likelihood));
    for (std::size_t i = accounted; i < processes.size(); ++i) {
      const HostProcess& process = *processes[i];
      const Likelihood kind = likelihood(&process);
      if (kind == Likelihood::kStarts) continue;
      const bool one_of_several = kind == Likelihood::kRuns && accounted > 0;
      if (one_of_several && i > accounted) continue;  // in the row of the first one
      silent.push_back({process.service,
                        one_of_several
                            ? some_are_silent(std::span(processes).first(candidates), accounted)
                            : fmt::format("process {} of this host {}, and no status of it comes",
                                          process.pid, process.stopped ? "is stopped" : "runs")});
    }
  }
  return silent;
}

std::vector<UnheardService> UnheardServices::list(Time now) const {
  std::vector<UnheardService> unheard = silent_processes(now);
  std::set<std::string> named;
  for (const UnheardService& one : unheard) named.insert(one.name);
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
