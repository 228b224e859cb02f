// Each fault between services that `topogeo doctor` must find.
#include "topogeo/diagnose/domain_checks.hpp"

#include <set>

#include <gmock/gmock.h>

#include "topogeo/messaging/message.hpp"

namespace topogeo::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr std::int64_t kSecond_ns = 1'000'000'000;

msg::ServiceStatus service_on(const std::string& service, const std::string& host) {
  msg::ServiceStatus status;
  messaging::set_header(status, service == "ga_worker" ? "" : "r1", 0, 0);
  messaging::set_service(status, service, host + "-1");
  messaging::set_text(status.host(), host, "host");
  messaging::set_text(status.version(), "1.2", "version");
  status.config_fingerprint(7);
  return status;
}

messaging::RemoteEndpoint scan_endpoint(const std::string& participant, bool writer) {
  messaging::RemoteEndpoint endpoint;
  endpoint.participant = participant;
  endpoint.topic = "topogeo/v" + std::to_string(msg::kSchemaVersion) + "/scan";
  endpoint.type = "Scan";
  endpoint.writer = writer;
  endpoint.qos.reliable = true;
  return endpoint;
}

DomainFacts healthy_domain() {
  DomainFacts facts;
  facts.version = "1.2";
  facts.host = "robot";
  facts.units = 2;
  facts.services = {service_on("sensor_gateway", "robot"), service_on("localizer", "pc"),
                    service_on("ga_worker", "pc2")};
  facts.services[2].config_fingerprint(0);
  facts.endpoints = {scan_endpoint("r1/sensor_gateway", true), scan_endpoint("r1/mapper", false)};
  for (int i = 0; i < 3; ++i) facts.clocks["pc"].add(i * kSecond_ns, i * kSecond_ns + 2'000'000);
  return facts;
}

std::vector<Finding> unwell(const DomainFacts& facts) {
  std::vector<Finding> findings = run_checks(domain_checks(), facts);
  std::erase_if(findings, [](const Finding& f) { return f.severity == Severity::kGood; });
  return findings;
}

struct DomainFault {
  const char* name;
  const char* check;
  Severity severity;
  const char* what;
  void (*inject)(DomainFacts& facts);
};

void set_counter(msg::ServiceStatus& status, const std::string& name, double value) {
  msg::Counter counter;
  messaging::set_text(counter.name(), name, "counter");
  counter.value(value);
  status.counters().push_back(counter);
}

void add_drops(msg::ServiceStatus& status, const std::string& reason, std::uint64_t count) {
  msg::FaultCount drop;
  messaging::set_text(drop.reason(), reason, "reason");
  drop.count(count);
  status.drops().push_back(drop);
}

void add_traffic(msg::ServiceStatus& status, const std::string& topic, bool sent,
                 double rate_per_s) {
  msg::TopicTraffic traffic;
  messaging::set_text(traffic.topic(), topic, "topic");
  traffic.sent(sent);
  traffic.rate_per_s(rate_per_s);
  status.traffic().push_back(traffic);
}

void set_clock(DomainFacts& facts, std::int64_t lag_ns) {
  ClockLag clock;
  for (int i = 0; i < 3; ++i) clock.add(0, lag_ns + std::int64_t{i} * 1'000'000);
  facts.clocks["pc"] = clock;
}

const std::vector<DomainFault>& domain_faults() {
  static const std::vector<DomainFault> kFaults = {
      {"OtherDomainThanTheUnits", "units", Severity::kProblem,
       "6 units of this host run and none is found on domain 3",
       [](DomainFacts& f) {
         f.host = "robot2";
         f.units = 6;
         f.domain = 3;
       }},
      {"OtherDomainThanTheUnit", "units", Severity::kProblem,
       "1 unit of this host runs and none is found on domain 0",
       [](DomainFacts& f) {
         f.services.clear();
         f.units = 1;
       }},
      {"NoService", "services", Severity::kHint,
       "none is alive on domain 0; services run on domain 4, partition 'topogeo'",
       [](DomainFacts& f) {
         f.services.clear();
         f.units = 0;
         f.elsewhere = "; services run on domain 4, partition 'topogeo'";
       }},
      {"NoDiscoveryServer", "discovery server", Severity::kProblem,
       "no discovery server answers at 10.0.0.1:11811",
       [](DomainFacts& f) {
         f.unanswered_servers = "no discovery server answers at 10.0.0.1:11811";
       }},
      {"CpuShort", "CPU of services", Severity::kHint,
       "the CPU of robot is short: timers fire up to 0.7 s late (sensor_gateway)",
       [](DomainFacts& f) {
         set_counter(f.services.at(0), "cpu_short", 1.0);
         set_counter(f.services.at(0), "timer_delay_s", 0.7);
         set_counter(f.services.at(2), "cpu_short", 0.0);
       }},
      {"TwoRobotsOfOneName", "robots", Severity::kProblem,
       "robot 'r1' has sensor_gateway on pc2 and robot",
       [](DomainFacts& f) { f.services.push_back(service_on("sensor_gateway", "pc2")); }},
      {"OtherWireVersion", "wire contract", Severity::kProblem,
       "'r1/old' speak version 9 of the wire contract",
       [](DomainFacts& f) {
         f.endpoints.push_back(scan_endpoint("r1/old", true));
         f.endpoints.back().topic = "topogeo/v9/scan";
       }},
      {"OtherVersion", "versions", Severity::kProblem, "ga_worker on pc2 run version 1.1",
       [](DomainFacts& f) { messaging::set_text(f.services[2].version(), "1.1", "version"); }},
      {"OtherConfiguration", "configuration", Severity::kProblem, "robot r1 have 2 configurations",
       [](DomainFacts& f) { f.services[1].config_fingerprint(8); }},
      {"QosOfAPair", "QoS", Severity::kProblem,
       "writer 'r1/sensor_gateway' and reader 'r1/mapper' differ in reliability",
       [](DomainFacts& f) { f.endpoints[0].qos.reliable = false; }},
      {"QosThatAServiceHasMet", "QoS", Severity::kProblem, "localizer on pc found 2 peers",
       [](DomainFacts& f) {
         msg::FaultCount fault;
         messaging::set_text(fault.reason(), "incompatible_qos", "reason");
         fault.count(2);
         f.services[1].faults().push_back(fault);
       }},
      {"ClockBehind", "clocks", Severity::kProblem, "the clock of pc is 10.00 s behind",
       [](DomainFacts& f) { set_clock(f, 10 * kSecond_ns); }},
      {"ClockAhead", "clocks", Severity::kProblem, "the clock of pc is 3.00 s ahead",
       [](DomainFacts& f) { set_clock(f, -3 * kSecond_ns); }},
      {"ClockPoor", "clocks", Severity::kHint, "0.20 s behind",
       [](DomainFacts& f) { set_clock(f, kSecond_ns / 5); }},
      {"DeafService", "inputs", Severity::kProblem,
       "localizer on pc is deaf: none of the 5.0 local_map/s of sensor_gateway arrives",
       [](DomainFacts& f) {
         for (msg::ServiceStatus& status : f.services) {
           status.state(msg::kServiceRunning);
           status.uptime_s(60.0);
         }
         add_traffic(f.services[0], "local_map", true, 5.0);
         add_traffic(f.services[1], "local_map", false, 0.0);
         messaging::set_text(f.services[1].input(), "local_map", "input");
         f.services[1].inputs(9);
         f.services[1].input_age_s(8.0);
       }},
      {"ForgedMessages", "strangers", Severity::kHint,
       "5 forged messages to localizer on pc, sensor_gateway on robot were refused",
       [](DomainFacts& f) {
         add_drops(f.services[0], "forged_removal", 4);
         add_drops(f.services[1], "unprotected_packet", 1);
         add_drops(f.services[2], "stuck scan", 7);
       }},
  };
  return kFaults;
}

TEST(DomainChecks, ServicesThatFitHaveNoFinding) {
  EXPECT_THAT(unwell(healthy_domain()), IsEmpty());
}

class DomainFaultTest : public testing::TestWithParam<DomainFault> {};

TEST_P(DomainFaultTest, IsFoundAndNothingElse) {
  DomainFacts facts = healthy_domain();
  GetParam().inject(facts);
  const std::vector<Finding> found = unwell(facts);
  ASSERT_EQ(found.size(), 1U) << findings_text(found);
  EXPECT_EQ(found[0].check, GetParam().check);
  EXPECT_EQ(found[0].severity, GetParam().severity);
  EXPECT_THAT(found[0].what, HasSubstr(GetParam().what));
  EXPECT_THAT(found[0].why, Not(IsEmpty()));
  EXPECT_THAT(found[0].remedy, Not(IsEmpty()));
}

INSTANTIATE_TEST_SUITE_P(All, DomainFaultTest, testing::ValuesIn(domain_faults()),
                         [](const auto& fault) { return std::string(fault.param.name); });

TEST(DomainChecks, ServicesOfTwoRobotsOfOneNameAreOneFinding) {
  DomainFacts facts = healthy_domain();
  for (const char* service : {"sensor_gateway", "planner", "navigator"}) {
    for (const char* host : {"robot", "robot2"})
      facts.services.push_back(service_on(service, host));
  }
  const std::vector<Finding> found = unwell(facts);
  ASSERT_EQ(found.size(), 1U) << findings_text(found);
  EXPECT_EQ(found[0].what, "robot 'r1' has navigator, planner, sensor_gateway on robot and robot2");
  EXPECT_THAT(found[0].remedy, HasSubstr("TOPOGEO_ROBOT"));
}

TEST(DomainChecks, WhatMayBeThereTwiceIsNoSecondRobot) {
  DomainFacts facts = healthy_domain();
  const auto add = [&](const std::string& service, const std::string& host,
                       const std::string& instance) -> msg::ServiceStatus& {
    facts.services.push_back(service_on(service, host));
    messaging::set_service(facts.services.back(), service, instance);
    return facts.services.back();
  };
  add("sensor_gateway", "robot", "started again");
  add("ga_worker", "robot", "as many as there are");
  add("web", "robot", "page 1");
  add("web", "pc", "page 2");
  add("localizer", "robot", "moved to the PC").state(msg::kServiceStopped);
  messaging::set_header(add("sensor_gateway", "robot2", "of another"), "r2", 0, 0);
  add("sensor_gateway", "pc", "of a run").config_fingerprint(9);
  facts.partitions = {{"robot-1", "topogeo"}, {"of a run", "run-17"}};
  messaging::set_header(add("map_store", "pc", "of all 1"), "", 0, 0);
  messaging::set_header(add("map_store", "pc2", "of all 2"), "", 0, 0);
  EXPECT_THAT(unwell(facts), IsEmpty());
}

TEST(DomainChecks, HostsWithoutUnitsNeedNotHaveServices) {
  DomainFacts facts = healthy_domain();
  facts.host = "desk";
  facts.units = 0;
  EXPECT_THAT(unwell(facts), IsEmpty());
}

TEST(DomainChecks, EachHasAFaultThatIsInjected) {
  std::set<std::string> injected;
  for (const DomainFault& fault : domain_faults()) injected.insert(fault.check);
  for (const Check<DomainFacts>& check : domain_checks()) {
    EXPECT_TRUE(injected.contains(check.name)) << check.name;
  }
}

TEST(DomainChecks, TopicsOfOthersAreNotOurs) {
  DomainFacts facts = healthy_domain();
  for (messaging::RemoteEndpoint& endpoint : facts.endpoints) endpoint.topic = "rt/scan";
  facts.endpoints[0].qos.reliable = false;
  EXPECT_THAT(unwell(facts), IsEmpty());
}

TEST(ClockLag, TheTimeAMessageTakesDoesNotCount) {
  ClockLag clock;
  clock.add(0, 700'000'000);  // an old one, which a late reader receives
  clock.add(kSecond_ns, kSecond_ns + 1'000'000);
  clock.add(2 * kSecond_ns, 2 * kSecond_ns + 40'000'000);
  EXPECT_DOUBLE_EQ(clock.lag_s(), 0.001);
  EXPECT_EQ(clock.samples(), 3U);
}

}  // namespace
}  // namespace topogeo::cli
