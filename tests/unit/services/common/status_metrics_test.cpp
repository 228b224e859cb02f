// The values of a status as metrics, and the files that name these metrics.
#include "topogeo/service/status_metrics.hpp"

#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "topogeo/messaging/message.hpp"

namespace topogeo::service {
namespace {

using testing::Contains;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::Not;
using testing::UnorderedElementsAre;

const std::filesystem::path kMonitoring =
    std::filesystem::path(TOPOGEO_SOURCE_DIR) / "deploy/monitoring";

msg::ServiceStatus status_with(const std::vector<std::pair<std::string, double>>& counters) {
  msg::ServiceStatus status;
  messaging::set_header(status, "r1", 20'000'000'000, 0);
  messaging::set_service(status, "localizer", "pc-1");
  messaging::set_text(status.host(), "pc", "host");
  messaging::set_text(status.version(), "1.2", "version");
  status.state(msg::kServiceRunning);
  status.config_fingerprint(0xABC);
  for (const auto& [name, value] : counters) {
    msg::Counter counter;
    messaging::set_text(counter.name(), name, "counter");
    counter.value(value);
    status.counters().push_back(counter);
  }
  return status;
}

const MetricFamily* find(const std::vector<MetricFamily>& families, const std::string& name) {
  for (const MetricFamily& family : families) {
    if (family.name == name) return &family;
  }
  return nullptr;
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream input(file);
  return {std::istreambuf_iterator<char>(input), {}};
}

std::set<std::string> metrics_in(const std::string& text) {
  const std::regex name("topogeo_[a-z0-9_]+");
  std::set<std::string> found;
  for (std::sregex_iterator i(text.begin(), text.end(), name), end; i != end; ++i) {
    found.insert(i->str());
  }
  return found;
}

TEST(StatusMetrics, LabelsSayWhoseTheyAre) {
  const auto families = metrics_of(status_with({}));
  const MetricFamily* info = find(families, "topogeo_service_info");
  ASSERT_NE(info, nullptr);
  EXPECT_EQ(info->samples.at(0).value, 1.0);
  EXPECT_THAT(info->samples.at(0).labels,
              UnorderedElementsAre(std::pair("service", "localizer"), std::pair("robot", "r1"),
                                   std::pair("host", "pc"), std::pair("version", "1.2"),
                                   std::pair("config", "0000000000000abc")));
}

TEST(StatusMetrics, CountersComeInBaseUnitsUnderOneNameWithLabels) {
  const auto families = metrics_of(status_with({{"cpu_s", 12.5},
                                                {"recovery_ms", 250.0},
                                                {"accepted", 7.0},
                                                {"rejected: little overlap", 3.0},
                                                {"never heard of", 1.0}}));
  EXPECT_EQ(find(families, "topogeo_cpu_seconds_total")->samples.at(0).value, 12.5);
  EXPECT_EQ(find(families, "topogeo_cpu_seconds_total")->kind, MetricKind::kTotal);
  EXPECT_DOUBLE_EQ(find(families, "topogeo_pool_recovery_seconds")->samples.at(0).value, 0.25);
  const MetricFamily* matches = find(families, "topogeo_matches_total");
  ASSERT_EQ(matches->samples.size(), 2U);
  EXPECT_THAT(matches->samples[0].labels, Contains(std::pair("result", "accepted")));
  EXPECT_THAT(matches->samples[1].labels, Contains(std::pair("result", "little overlap")));
  EXPECT_EQ(matches->samples[1].value, 3.0);
  for (const MetricFamily& family : families) EXPECT_THAT(family.name, Not("never heard of"));
}

TEST(StatusMetrics, StateFaultsDropsTrafficAndQueues) {
  msg::ServiceStatus status = status_with({});
  msg::FaultCount fault;
  messaging::set_text(fault.reason(), "send blocked", "reason");
  fault.count(4);
  status.faults().push_back(fault);
  messaging::set_text(status.last_error(), "send blocked: scan", "error");
  status.last_error_age_s(5.0);
  messaging::set_text(fault.reason(), "other robot", "reason");
  status.drops().push_back(fault);
  msg::TopicTraffic traffic;
  messaging::set_text(traffic.topic(), "scan", "topic");
  traffic.messages(9);
  traffic.waiting(2);
  status.traffic().push_back(traffic);
  traffic.sent(true);
  status.traffic().push_back(traffic);
  msg::QueueDepth queue;
  messaging::set_text(queue.name(), "match tasks", "name");
  queue.depth(5);
  status.queues().push_back(queue);
  const auto families = metrics_of(status);
  double states = 0.0;
  for (const MetricSample& sample : find(families, "topogeo_service_state")->samples) {
    states += sample.value;
    if (sample.value == 1.0) {
      EXPECT_THAT(sample.labels, Contains(std::pair("state", "running")));
    }
  }
  EXPECT_EQ(states, 1.0);
  EXPECT_THAT(find(families, "topogeo_faults_total")->samples.at(0).labels,
              Contains(std::pair("reason", "send blocked")));
  EXPECT_DOUBLE_EQ(find(families, "topogeo_last_error_time_seconds")->samples.at(0).value, 15.0);
  EXPECT_THAT(find(families, "topogeo_drops_total")->samples.at(0).labels,
              Contains(std::pair("reason", "other robot")));
  ASSERT_EQ(find(families, "topogeo_messages_total")->samples.size(), 2U);
  EXPECT_THAT(find(families, "topogeo_messages_total")->samples[1].labels,
              Contains(std::pair("direction", "sent")));
  ASSERT_EQ(find(families, "topogeo_messages_waiting")->samples.size(), 1U);
  EXPECT_EQ(find(families, "topogeo_queue_depth")->samples.at(0).value, 5.0);
  EXPECT_EQ(find(families, "topogeo_queue_capacity"), nullptr) << "this queue has none";
  EXPECT_EQ(find(families, "topogeo_input_age_seconds"), nullptr) << "nothing has come";
}

TEST(StatusMetrics, NamesFollowTheConventions) {
  std::map<std::string_view, std::pair<MetricKind, std::string_view>> declared;
  for (const CounterMetric& metric : counter_metrics()) {
    EXPECT_THAT(std::string(metric.metric), MatchesRegex("topogeo_[a-z][a-z0-9_]*"));
    EXPECT_EQ(metric.metric.ends_with("_total"), metric.kind == MetricKind::kTotal)
        << metric.metric;
    EXPECT_FALSE(metric.metric.find("_ms") != metric.metric.npos) << "not a base unit";
    EXPECT_FALSE(metric.help.empty());
    const auto [known, is_new] = declared.try_emplace(metric.metric, metric.kind, metric.help);
    EXPECT_TRUE(is_new || (known->second.first == metric.kind &&
                           known->second.second == metric.help && !metric.label.empty()))
        << metric.metric << " is declared twice and differs";
  }
}

TEST(StatusMetrics, ADeclarationStandsForItsCounterAlone) {
  std::set<std::string_view> counters;
  for (const CounterMetric& metric : counter_metrics()) {
    EXPECT_TRUE(counters.insert(metric.counter).second) << metric.counter;
  }
  EXPECT_EQ(find_metric("tasks")->metric, "topogeo_match_tasks_total");
  EXPECT_EQ(find_metric("rejected: "), find_metric("rejected: few inliers"));
  EXPECT_EQ(find_metric("task"), nullptr);
}

TEST(MonitoringFiles, DashboardIsOneOfGrafana) {
  const auto dashboard =
      nlohmann::json::parse(text_of(kMonitoring / "grafana-dashboard.json"), nullptr, false);
  ASSERT_TRUE(dashboard.is_object()) << "not JSON";
  EXPECT_TRUE(dashboard.at("id").is_null()) << "Grafana gives the number";
  EXPECT_FALSE(dashboard.at("uid").get<std::string>().empty());
  EXPECT_FALSE(dashboard.at("title").get<std::string>().empty());
  EXPECT_GE(dashboard.at("schemaVersion").get<int>(), 30);
  EXPECT_TRUE(dashboard.at("time").contains("from") && dashboard.at("time").contains("to"));
  std::set<std::string> variables;
  for (const auto& variable : dashboard.at("templating").at("list")) {
    variables.insert(variable.at("name").get<std::string>());
    EXPECT_TRUE(variable.contains("type") && variable.contains("query"));
  }
  std::set<int> ids;
  std::size_t queries = 0;
  for (const auto& panel : dashboard.at("panels")) {
    EXPECT_TRUE(ids.insert(panel.at("id").get<int>()).second) << panel.at("id");
    EXPECT_FALSE(panel.at("title").get<std::string>().empty());
    const auto& place = panel.at("gridPos");
    EXPECT_LE(place.at("x").get<int>() + place.at("w").get<int>(), 24);
    EXPECT_GT(place.at("h").get<int>(), 0);
    EXPECT_GE(place.at("y").get<int>(), 0);
    if (panel.at("type") == "row") continue;
    EXPECT_THAT(panel.at("type").get<std::string>(), testing::AnyOf("timeseries", "stat"));
    EXPECT_TRUE(panel.at("fieldConfig").contains("defaults"));
    ASSERT_FALSE(panel.at("targets").empty());
    for (const auto& target : panel.at("targets")) {
      ++queries;
      EXPECT_FALSE(target.at("refId").get<std::string>().empty());
      const auto expression = target.at("expr").get<std::string>();
      EXPECT_FALSE(metrics_in(expression).empty()) << expression;
      EXPECT_EQ(target.at("datasource").at("type"), "prometheus");
      EXPECT_EQ(std::ranges::count(expression, '('), std::ranges::count(expression, ')'));
      if (expression.find("$robot") != std::string::npos) {
        EXPECT_THAT(variables, Contains("robot"));
      }
    }
  }
  EXPECT_GT(queries, 20U);
}

TEST(MonitoringFiles, NameMetricsThatThereAre) {
  const std::vector<std::string> names = metric_names();
  for (const char* file : {"grafana-dashboard.json", "alerts.yaml"}) {
    const std::set<std::string> used = metrics_in(text_of(kMonitoring / file));
    EXPECT_FALSE(used.empty()) << file;
    for (const std::string& name : used) EXPECT_THAT(names, Contains(name)) << file;
  }
  EXPECT_THAT(metrics_in("rate(topogeo_cpu_ms[1m])"), Not(IsEmpty()));
  EXPECT_THAT(names, Not(Contains("topogeo_cpu_ms"))) << "a wrong name would be found";
}

}  // namespace
}  // namespace topogeo::service
