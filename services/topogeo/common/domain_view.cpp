#include "common/domain_view.hpp"

#include <chrono>
#include <cstdlib>
#include <iostream>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/patience.hpp"

#include "common/collect_window.hpp"
#include "common/elsewhere.hpp"
#include "common/host_processes.hpp"

namespace topogeo::cli {
namespace {

constexpr std::chrono::milliseconds kSlice{100};
// Interval between two tables of --watch: a dead service is detected after a second and must be
// shown within two.
constexpr std::chrono::milliseconds kAgain{500};

messaging::ParticipantOptions options_of(const DomainView& view, const std::string& name) {
  messaging::ParticipantOptions options;
  options.domain = view.domain;
  options.partition = view.partition;
  options.name = name;
  options.profiles_file = view.profiles_file;
  return options;
}

}  // namespace

void add_robot_option(command_line::Command& app, std::string& robot_id, const char* description) {
  app.add_option("--robot,--robot-id", robot_id, description)
      ->environment("TOPOGEO_ROBOT")
      ->capture_default_str();
}

void add_domain_options(command_line::Command& app, DomainView& view) {
  service::add_domain_option(app, view.domain);
  app.add_option("--partition", view.partition, "only services in this partition; *: all")
      ->capture_default_str();
  app.add_option("--profiles", view.profiles_file, "QoS profiles instead of the built-in ones")
      ->type_name("FILE");
}

void add_watch_flags(command_line::Command& app, bool& watch, bool& once, const char* standard) {
  const std::string ending = *standard == '\0' ? "" : std::string(", ") + standard;
  app.add_flag("--watch", watch, "refresh twice a second until Ctrl-C" + ending);
  app.add_flag("--once", once, *standard == '\0' ? "one table, the default" : "one table")
      ->excludes(app.get_option("--watch"));
}

void add_view_options(command_line::Command& app, DomainView& view) {
  add_domain_options(app, view);
  add_watch_flags(app, view.watch, view.once, "");
  app.add_option("--wait-seconds", view.wait_s,
                 "longest wait for the first service, and for late ones")
      ->check(command_line::range(0.1, kLongestWait_s))
      ->capture_default_str();
}

messaging::Participant join(const DomainView& view, const std::string& name,
                            const std::string& identity, bool observe) {
  messaging::ParticipantOptions options = options_of(view, name);
  options.identity = identity;
  options.observe = observe;
  return messaging::Participant(options);
}

messaging::Participant join_for(const DomainView& view, const std::string& name,
                                const std::string& robot_id, bool observe) {
  messaging::ParticipantOptions options = options_of(view, name);
  options.observe = observe;
  options.robots = {robot_id};
  return messaging::Participant(options);
}

Collected collect_and_show(const DomainView& view, messaging::EventLoop& loop,
                           const std::function<std::size_t()>& count,
                           const std::function<void()>& show) {
  const messaging::SignalStop signals([&](int) { loop.stop(); });
  support::Patience patience(view.wait_s, support::monotonic_s());
  CollectWindow window(view.wait_s);
  do {
    if (loop.run_for(kSlice)) return {count() > 0, {}};
    static_cast<void>(patience.is_over(support::monotonic_s()));
  } while (window.goes_on(patience.waited_s(), count()));
  do {
    if (count() > 0 || view.watch) show();
    std::cout << std::flush;
  } while (view.watch && !loop.run_for(kAgain));
  return {count() > 0, patience.reason()};
}

std::string unanswered_servers(std::size_t peers) {
  const char* const value = std::getenv("ROS_DISCOVERY_SERVER");  // NOLINT(concurrency-mt-unsafe)
  const std::string servers = value == nullptr ? "" : value;
  if (peers > 0 || servers.find_first_not_of(';') == std::string::npos) return {};
  return "no discovery server answers at " + servers + " (ROS_DISCOVERY_SERVER)";
}

std::string nothing_alive(const DomainView& view, const std::string& what,
                          std::span<const messaging::RemoteEndpoint> discovered) {
  const std::vector<HostProcess> processes = host_processes();
  return "no " + what + " is alive on domain " + std::to_string(view.domain) + ", partition '" +
         view.partition + "'" + services_elsewhere(view, discovered, processes) +
         "; services with other settings are not seen (TOPOGEO_DOMAIN, TOPOGEO_SECURITY, " +
         "ROS_DISCOVERY_SERVER, TOPOGEO_PEERS)";
}

}  // namespace topogeo::cli
