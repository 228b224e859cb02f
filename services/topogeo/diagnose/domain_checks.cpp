#include "diagnose/domain_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "topogeo/messaging/deafness.hpp"
#include "topogeo/service/cpu_watch.hpp"
#include "topogeo/support/format.hpp"

#include "common/service_table.hpp"

namespace topogeo::cli {
namespace {

using enum Severity;
using Findings = std::vector<Finding>;

/// Largest difference of clocks. Tables show a service as silent after 1.5 s, so the difference
/// must be well below that.
constexpr double kWrongClock_s = 0.5;
constexpr double kPoorClock_s = 0.1;
/// The first status of a service may be half a second old on arrival.
constexpr std::size_t kLeastSamples = 2;
/// Services of which a robot has only one.
constexpr auto kOnceForEachRobot = std::to_array<std::string_view>(
    {"sensor_gateway", "local_mapper", "localizer", "map_store", "planner", "navigator"});

std::string joined(const std::set<std::string>& texts, const char* between = ", ") {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : between) + text;
  return all;
}

std::string name_of(const msg::ServiceStatus& status) {
  return status.service().to_string() + " on " + status.host().to_string();
}

std::string name_of(const messaging::RemoteEndpoint& endpoint) {
  return endpoint.participant.empty() ? "an unnamed program" : "'" + endpoint.participant + "'";
}

// --- units

Findings check_units(const DomainFacts& facts) {
  const bool heard = std::ranges::any_of(facts.services, [&](const msg::ServiceStatus& status) {
    return status.host() == facts.host.c_str();
  });
  if (facts.units == 0 || heard) return {};
  return {{"", kProblem,
           fmt::format("{} of this host {} and none is found on domain {}",
                       facts.units == 1 ? "1 unit" : fmt::format("{} units", facts.units),
                       facts.units == 1 ? "runs" : "run", facts.domain),
           "this command uses other settings, or the services are not reachable",
           "use the environment of the services: TOPOGEO_DOMAIN, TOPOGEO_SECURITY and the others "
           "of /etc/topogeo/topogeo.env (a PC with workers: worker.env)"}};
}

std::string good_units(const DomainFacts& facts) {
  return facts.units == 0 ? "none runs on this host" : "services of this host are found";
}

// --- discovery server

Findings check_servers(const DomainFacts& facts) {
  if (facts.unanswered_servers.empty()) return {};
  return {{"", kProblem, facts.unanswered_servers, "services find each other through it alone",
           "start it (fast-discovery-server -i 0), correct the address, or unset the variable "
           "everywhere (deploy/README.md, \"How services find each other\")"}};
}

std::string good_servers(const DomainFacts& /*facts*/) {
  return "none is named, or it answers";
}

// --- services

Findings check_services(const DomainFacts& facts) {
  if (!facts.services.empty() || facts.units > 0) return {};  // units: see above
  return {{"", kHint, fmt::format("none is alive on domain {}{}", facts.domain, facts.elsewhere),
           "what follows says nothing about services",
           "start them, or use their settings: TOPOGEO_DOMAIN, TOPOGEO_SECURITY, "
           "ROS_DISCOVERY_SERVER, TOPOGEO_PEERS"}};
}

std::string good_services(const DomainFacts& facts) {
  return fmt::format("{} on domain {}", facts.services.size(), facts.domain);
}

// --- CPU

Findings check_cpu(const DomainFacts& facts) {
  std::map<std::string, std::set<std::string>> services;  // by host
  std::map<std::string, double> delay_s;
  for (const msg::ServiceStatus& status : facts.services) {
    if (cpu_shortage(status).empty()) continue;
    const std::string host = status.host().to_string();
    services[host].insert(status.service().to_string());
    delay_s[host] = std::max(delay_s[host], counter(&status, service::CpuWatch::kTimerDelay));
  }
  Findings found;
  for (const auto& [host, names] : services) {
    found.push_back({"", kHint,
                     fmt::format("the CPU of {} is short: timers fire up to {:.1f} s late ({})",
                                 host, delay_s[host], joined(names)),
                     "scans and poses arrive late, and a robot that gets only late ones stops",
                     "reduce its load: workers (ga_worker), map store and page on another machine, "
                     "fewer --workers or --slots; or raise its limit: CPUQuota= of the unit, "
                     "--cpus of the container"});
  }
  return found;
}

std::string good_cpu(const DomainFacts& facts) {
  return facts.services.empty() ? "no service is found" : "services are in time";
}

// --- robots

/// Two partitions may have robots of the same name, which are different robots.
using RobotInPartition = std::pair<std::string, std::string>;

RobotInPartition robot_of(const msg::ServiceStatus& status, const DomainFacts& facts) {
  const auto partition = facts.partitions.find(status.instance().to_string());
  return {status.robot_id().to_string(),
          partition == facts.partitions.end() ? "" : partition->second};
}

// A restarted service may be listed twice on its host until the old one is forgotten.
Findings check_robots(const DomainFacts& facts) {
  std::map<RobotInPartition, std::map<std::string, std::set<std::string>>> hosts_of_services;
  for (const msg::ServiceStatus& status : facts.services) {
    const std::string service = status.service().to_string();
    if (status.robot_id().size() == 0 || status.state() == msg::kServiceStopped ||
        std::ranges::find(kOnceForEachRobot, service) == kOnceForEachRobot.end()) {
      continue;
    }
    hosts_of_services[robot_of(status, facts)][service].insert(status.host().to_string());
  }
  Findings found;
  for (const auto& [robot, hosts_of] : hosts_of_services) {
    std::map<std::set<std::string>, std::set<std::string>> services_on;
    for (const auto& [service, hosts] : hosts_of) {
      if (hosts.size() > 1) services_on[hosts].insert(service);
    }
    for (const auto& [hosts, services] : services_on) {
      found.push_back({"", kProblem,
                       fmt::format("robot '{}' has {} on {}", robot.first, joined(services),
                                   joined(hosts, " and ")),
                       "scans of two robots mix, and map stores stop each other",
                       "give each robot a name of its own: TOPOGEO_ROBOT in topogeo.env, --robot"});
    }
  }
  return found;
}

std::string good_robots(const DomainFacts& /*facts*/) {
  return "each has its services once";
}

// --- wire contract

Findings check_wire(const DomainFacts& facts) {
  std::map<std::uint32_t, std::set<std::string>> others;
  for (const messaging::RemoteEndpoint& endpoint : facts.endpoints) {
    const std::uint32_t version = messaging::wire_version(endpoint.topic);
    if (version != 0 && version != facts.wire_version) others[version].insert(name_of(endpoint));
  }
  Findings found;
  for (const auto& [version, programs] : others) {
    found.push_back(
        {"", kProblem,
         fmt::format("{} speak version {} of the wire contract, this program version {}",
                     joined(programs), version, facts.wire_version),
         "programs of different versions do not hear each other",
         "install the same version on all hosts, then restart the services"});
  }
  return found;
}

std::string good_wire(const DomainFacts& facts) {
  return fmt::format("all programs speak version {}", facts.wire_version);
}

// --- versions

Findings check_versions(const DomainFacts& facts) {
  std::map<std::string, std::set<std::string>> others;
  for (const msg::ServiceStatus& status : facts.services) {
    if (status.version().to_string() == facts.version) continue;
    others[status.version().to_string()].insert(name_of(status));
  }
  Findings found;
  for (const auto& [version, services] : others) {
    found.push_back(
        {"", kProblem,
         fmt::format("{} run version {}, this is {}", joined(services), version, facts.version),
         "workers of another version get no tasks, and results may differ",
         "install the same version on all hosts, then restart the services"});
  }
  return found;
}

std::string good_versions(const DomainFacts& facts) {
  return fmt::format("{} services run version {}", facts.services.size(), facts.version);
}

// --- configurations

Findings check_configurations(const DomainFacts& facts) {
  std::map<RobotInPartition, std::map<std::uint64_t, std::set<std::string>>> by_robot;
  for (const msg::ServiceStatus& status : facts.services) {
    if (status.robot_id().size() == 0 || status.config_fingerprint() == 0) continue;
    by_robot[robot_of(status, facts)][status.config_fingerprint()].insert(name_of(status));
  }
  Findings found;
  for (const auto& [robot, configurations] : by_robot) {
    if (configurations.size() < 2) continue;
    std::string what = fmt::format("services of robot {} have {} configurations:", robot.first,
                                   configurations.size());
    for (const auto& [fingerprint, services] : configurations) {
      what += fmt::format(" {:016x} ({});", fingerprint, joined(services));
    }
    what.pop_back();
    found.push_back({"", kProblem, what, "the services of a robot must use the same settings",
                     "give all the same --config, then restart them"});
  }
  return found;
}

std::string good_configurations(const DomainFacts& /*facts*/) {
  return "the services of a robot have the same";
}

// --- quality of service

Findings check_qos(const DomainFacts& facts) {
  Findings found;
  const std::string remedy =
      "the same DDS profiles everywhere (--profiles, TOPOGEO_DDS_PROFILES), the same --replay";
  for (const messaging::Mismatch& mismatch : messaging::find_mismatches(facts.endpoints)) {
    if (messaging::wire_version(mismatch.writer.topic) == 0) continue;
    found.push_back({"", kProblem,
                     fmt::format("{}: writer {} and reader {} differ in {}", mismatch.writer.topic,
                                 name_of(mismatch.writer), name_of(mismatch.reader), mismatch.what),
                     "no message of this topic gets from one to the other", remedy});
  }
  for (const msg::ServiceStatus& status : facts.services) {
    for (const msg::FaultCount& fault : status.faults()) {
      if (fault.reason() != "incompatible_qos") continue;
      found.push_back({"", kProblem,
                       fmt::format("{} found {} peers that it cannot connect to", name_of(status),
                                   fault.count()),
                       "no message gets from one to the other", remedy});
    }
  }
  return found;
}

std::string good_qos(const DomainFacts& facts) {
  return fmt::format("{} readers and writers fit each other", facts.endpoints.size());
}

// --- clocks

Findings check_clocks(const DomainFacts& facts) {
  Findings found;
  for (const auto& [host, clock] : facts.clocks) {
    const double off_s = std::abs(clock.lag_s());
    if (clock.samples() < kLeastSamples || off_s < kPoorClock_s) continue;
    found.push_back(
        {"", off_s < kWrongClock_s ? kHint : kProblem,
         fmt::format("the clock of {} is {:.2f} s {} of this one", host, off_s,
                     clock.lag_s() > 0.0 ? "behind" : "ahead"),
         "certificates, logs and `topogeo status` depend on it",
         "run chrony on both, with one of them as the server where there is no internet"});
  }
  return found;
}

std::string good_clocks(const DomainFacts& facts) {
  std::set<std::string> hosts;
  for (const auto& [host, clock] : facts.clocks) hosts.insert(host);
  return hosts.empty() ? "no service is there to compare with" : "agree with " + joined(hosts);
}

// --- inputs

Findings check_inputs(const DomainFacts& facts) {
  std::map<std::string, std::vector<messaging::HeardStatus>> by_partition;
  for (const msg::ServiceStatus& status : facts.services) {
    by_partition[robot_of(status, facts).second].push_back({&status});
  }
  Findings found;
  for (const auto& [partition, services] : by_partition) {
    for (const messaging::HeardStatus& heard : services) {
      const msg::ServiceStatus* const service = heard.status;
      const std::string why = messaging::deafness(heard, services);
      if (why.empty()) continue;
      found.push_back(
          {"", kProblem, name_of(*service) + " is " + why,
           "after an interruption, one of the two dropped the connection unnoticed by the other",
           "restart " + service->service().to_string()});
    }
  }
  return found;
}

std::string good_inputs(const DomainFacts& /*facts*/) {
  return "messages to the services arrive";
}

// --- strangers

/// Number of forged messages in the name of a peer that the service rejected.
std::uint64_t forged_messages(const msg::ServiceStatus& status) {
  std::uint64_t sum = 0;
  for (const msg::FaultCount& drop : status.drops()) {
    if (drop.reason() == "forged_removal" || drop.reason() == "unprotected_packet") {
      sum += drop.count();
    }
  }
  return sum;
}

Findings check_strangers(const DomainFacts& facts) {
  std::uint64_t sum = 0;
  std::set<std::string> services;
  for (const msg::ServiceStatus& status : facts.services) {
    if (const std::uint64_t forged = forged_messages(status)) {
      sum += forged;
      services.insert(name_of(status));
    }
  }
  if (services.empty()) return {};
  return {{"", kHint, fmt::format("{} forged messages to {} were refused", sum, joined(services)),
           "a program on the network impersonates a service",
           "find the sender (tcpdump udp portrange 7400-7999) and keep it off the network; without "
           "TOPOGEO_SECURITY it can impersonate any service"}};
}

std::string good_strangers(const DomainFacts& /*facts*/) {
  return "no service has refused a forged message";
}

constexpr auto kDomainChecks = std::to_array<Check<DomainFacts>>({
    {"discovery server", check_servers, good_servers},
    {"units", check_units, good_units},
    {"services", check_services, good_services},
    {"CPU of services", check_cpu, good_cpu},
    {"robots", check_robots, good_robots},
    {"wire contract", check_wire, good_wire},
    {"versions", check_versions, good_versions},
    {"configuration", check_configurations, good_configurations},
    {"QoS", check_qos, good_qos},
    {"clocks", check_clocks, good_clocks},
    {"inputs", check_inputs, good_inputs},
    {"strangers", check_strangers, good_strangers},
});

}  // namespace

void ClockLag::add(std::int64_t stamp_ns, std::int64_t received_ns) {
  constexpr double kNano_s = 1e-9;
  const double lag_s = kNano_s * static_cast<double>(received_ns - stamp_ns);
  lag_s_ = samples_ == 0 ? lag_s : std::min(lag_s_, lag_s);
  ++samples_;
}

std::span<const Check<DomainFacts>> domain_checks() {
  return kDomainChecks;
}

}  // namespace topogeo::cli
