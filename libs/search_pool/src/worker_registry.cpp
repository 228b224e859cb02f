#include "topogeo/search_pool/worker_registry.hpp"

#include <algorithm>
#include <utility>

#include "topogeo/support/format.hpp"

namespace topogeo::search_pool {

namespace {

// Ids come from the network, so stored ids need a limit.
constexpr std::size_t kFormer = 1024;    // more than leave while an answer travels
constexpr std::size_t kReported = 4096;  // beyond this, faults are reported again
constexpr std::size_t kOthers = 8;       // per id, which should have one process

std::string named(const std::string& worker_id, const std::string& host) {
  return "worker " + worker_id + (host.empty() ? "" : " on host " + host);
}

}  // namespace

WorkerRegistry::WorkerRegistry(Build own) : own_(std::move(own)) {}

WorkerRegistry::Verdict WorkerRegistry::update(const WorkerReport& report, const ProcessId& from,
                                               const InstanceId& instance) {
  const auto [found, is_new] = entries_.try_emplace(report.worker_id);
  Entry& entry = found->second;
  if (is_new) entry.owner = from;
  if (entry.owner != from) {
    if (entry.others.size() < kOthers || entry.others.contains(from)) entry.others[from] = 0;
    if (!first_time(report.worker_id)) return {};
    ++counts_.shared_ids;
    return {false, Fault{"two workers of one id", named(report.worker_id, entry.host) +
                                                      ": another process on host " + report.host +
                                                      " has that id; only the first is used"}};
  }
  entry.instance = instance;
  entry.host = report.host;
  entry.silent = 0;
  if (std::optional<Fault> fault = refusal(report)) {
    if (!first_time(report.worker_id)) fault.reset();
    return {false, std::move(fault)};
  }
  return {true, {}};
}

std::optional<WorkerRegistry::Fault> WorkerRegistry::refusal(const WorkerReport& report) {
  const std::string who = named(report.worker_id, report.host);
  const bool is_new = !reported_.contains(report.worker_id);
  const Build& build = report.build;
  if (build.version != own_.version) {
    if (is_new) ++counts_.other_version;
    return Fault{"worker of another version",
                 fmt::format("{}: version {}, here {}", who, build.version, own_.version)};
  }
  if (build.matcher_fingerprint != own_.matcher_fingerprint) {
    if (is_new) ++counts_.other_matcher;
    return Fault{"worker computes differently",
                 fmt::format("{}: matcher fingerprint {:016x}, here {:016x}", who,
                             build.matcher_fingerprint, own_.matcher_fingerprint)};
  }
  if (build.config_fingerprint != 0 && build.config_fingerprint != own_.config_fingerprint) {
    if (is_new) ++counts_.other_configuration;
    return Fault{"worker of another configuration",
                 fmt::format("{}: configuration fingerprint {:016x}, here {:016x}", who,
                             build.config_fingerprint, own_.config_fingerprint)};
  }
  return {};
}

bool WorkerRegistry::first_time(const std::string& worker_id) {
  if (reported_.size() >= kReported) reported_.clear();
  return reported_.insert(worker_id).second;
}

void WorkerRegistry::remove(const std::string& worker_id) {
  const auto found = entries_.find(worker_id);
  former_.push_back({worker_id, found->second.owner});
  if (former_.size() > kFormer) former_.pop_front();
  // Another process with the id takes over with its next report.
  entries_.erase(found);
}

std::optional<std::string> WorkerRegistry::gone(const InstanceId& instance,
                                                const ProcessId& process) {
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const auto& entry) {
    return entry.second.instance == instance;
  });
  if (found == entries_.end()) return {};
  Entry& entry = found->second;
  if (process == ProcessId{}) {
    // One of several processes is gone: ticks without a report will show which.
    if (!entry.others.empty()) return {};
  } else if (process != entry.owner) {
    entry.others.erase(process);
    return {};
  }
  const std::string worker_id = found->first;
  remove(worker_id);
  return worker_id;
}

std::vector<std::string> WorkerRegistry::tick(int silent_ticks) {
  std::vector<std::string> silent;
  for (auto& [worker_id, entry] : entries_) {
    if (++entry.silent > silent_ticks) silent.push_back(worker_id);
    for (auto& [process, ticks] : entry.others) ++ticks;
    std::erase_if(entry.others, [&](const auto& other) { return other.second > silent_ticks; });
  }
  for (const std::string& worker_id : silent) remove(worker_id);
  return silent;
}

bool WorkerRegistry::is_owner(const ProcessId& from, const std::string& worker_id) const {
  const auto found = entries_.find(worker_id);
  if (found != entries_.end()) return found->second.owner == from;
  return std::any_of(former_.rbegin(), former_.rend(), [&](const Former& former) {
    return former.worker_id == worker_id && former.owner == from;
  });
}

ProcessId WorkerRegistry::owner(const std::string& worker_id) const {
  const auto found = entries_.find(worker_id);
  return found == entries_.end() ? ProcessId{} : found->second.owner;
}

std::vector<std::string> WorkerRegistry::workers_of(const ProcessId& process) const {
  std::vector<std::string> ids;
  for (const auto& [worker_id, entry] : entries_) {
    if (entry.owner == process) ids.push_back(worker_id);
  }
  return ids;
}

std::string WorkerRegistry::name(const std::string& worker_id) const {
  const auto found = entries_.find(worker_id);
  return named(worker_id, found == entries_.end() ? "" : found->second.host);
}

}  // namespace topogeo::search_pool
