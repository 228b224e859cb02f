// Flags and timing shared by the commands that show the services of a domain.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/discovery.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"

namespace topogeo::cli {

/// Limit of --wait-seconds.
constexpr double kLongestWait_s = 3600.0;

struct DomainView {
  std::uint32_t domain = 0;
  std::string partition = messaging::kAnyPartition;
  std::filesystem::path profiles_file;
  bool watch = false;
  bool once = false;    ///< the opposite of `watch`
  double wait_s = 3.2;  ///< for the first service
};

/// Adds --robot, with TOPOGEO_ROBOT of the environment as default, else the value of `robot_id`.
void add_robot_option(command_line::Command& app, std::string& robot_id, const char* description);

/// Adds --domain, --partition and --profiles; `view` must outlive the app.
void add_domain_options(command_line::Command& app, DomainView& view);

/// Adds --watch and --once, which exclude each other. `standard`: what the help says of --watch,
/// "the default" or nothing, where --once is.
void add_watch_flags(command_line::Command& app, bool& watch, bool& once, const char* standard);

/// Adds the flags of add_domain_options, --watch, --once and --wait-seconds.
void add_view_options(command_line::Command& app, DomainView& view);

/// Joins the domain under a name that DDS tools show. `identity`, `observe`: see
/// ParticipantOptions. Throws like messaging::Participant.
messaging::Participant join(const DomainView& view, const std::string& name,
                            const std::string& identity = "topogeo", bool observe = false);
/// The same for a command about one robot, which the keys must name when security is on.
messaging::Participant join_for(const DomainView& view, const std::string& name,
                                const std::string& robot_id, bool observe = false);

struct Collected {
  bool found = false;
  std::string reason;  ///< see support::Patience::reason
};

/// Receives until all publishers of a status have been heard, then shows them; with --watch
/// repeatedly, until Ctrl-C. `count`: number of services heard so far.
Collected collect_and_show(const DomainView& view, messaging::EventLoop& loop,
                           const std::function<std::size_t()>& count,
                           const std::function<void()>& show);

/// "no discovery server answers at 10.0.0.1:11811 (ROS_DISCOVERY_SERVER)", if the environment names
/// servers and discovery has found no participant, not even a server; else empty. Callers wait
/// until discovery had its time.
std::string unanswered_servers(std::size_t peers);

/// "no <what> is alive on domain 3, partition '*'", with the domains and partitions where services
/// are: those of this host and the `discovered` ones of the domain.
std::string nothing_alive(const DomainView& view, const std::string& what,
                          std::span<const messaging::RemoteEndpoint> discovered = {});

}  // namespace topogeo::cli
