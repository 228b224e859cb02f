// topogeo doctor: checks this machine and the services of its domain for faults.
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/version.hpp"

#include "commands.hpp"
#include "common/domain_view.hpp"
#include "common/elsewhere.hpp"
#include "common/host_processes.hpp"
#include "common/host_units.hpp"
#include "diagnose/domain_checks.hpp"
#include "diagnose/machine_checks.hpp"

namespace topogeo::cli {
namespace {

/// Paths of the installed package.
constexpr const char* kInstalledState = "/var/lib/topogeo";  // created by the packages
constexpr const char* kInstalledDevices = "/etc/topogeo/devices.yaml";

struct DoctorOptions {
  DomainView view;
  std::optional<std::filesystem::path> map;
  std::optional<std::filesystem::path> devices;
  bool alone = false;
  bool json = false;
};

MachineQuestions questions_of(const DoctorOptions& options) {
  MachineQuestions questions;
  questions.domain = options.view.domain;
  std::error_code unknown;
  questions.map_folder = options.map.value_or(std::filesystem::exists(kInstalledState, unknown)
                                                  ? std::filesystem::path(kInstalledState) / "map"
                                                  : std::filesystem::current_path(unknown));
  if (questions.map_folder.empty()) questions.map_folder = ".";  // the current folder was removed
  questions.devices = options.devices;
  if (!questions.devices && std::filesystem::exists(kInstalledDevices, unknown)) {
    questions.devices = kInstalledDevices;
  }
  return questions;
}

DomainFacts gather_domain_facts(const DomainView& view) {
  DomainFacts facts;
  facts.version = support::kVersion;
  facts.domain = view.domain;
  facts.host = support::host_name();
  facts.units = host_units().on_domain;
  const messaging::Participant participant =
      join(view, "topogeo doctor", "status", /*observe=*/true);
  messaging::EventLoop loop;
  std::map<messaging::Handle, msg::ServiceStatus> services;
  std::map<messaging::Handle, std::string> instances;  // by writer
  loop.add<msg::ServiceStatus>(
      messaging::Reader<msg::ServiceStatus>(participant),
      [&](const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
        services[info.instance] = status;
        instances[info.writer] = status.instance().to_string();
        facts.clocks[status.host().to_string()].add(status.stamp_ns(), support::wall_clock_ns());
      },
      [&](const messaging::SampleInfo& info) { services.erase(info.instance); });
  static_cast<void>(collect_and_show(
      view, loop, [&] { return services.size(); }, [] {}));
  for (auto& [instance, status] : services) facts.services.push_back(std::move(status));
  facts.endpoints = participant.discovered();
  facts.unanswered_servers = unanswered_servers(participant.peers());
  facts.elsewhere = services_elsewhere(view, facts.endpoints, host_processes());
  for (const messaging::RemoteEndpoint& endpoint : facts.endpoints) {
    const auto instance = instances.find(endpoint.id);
    if (instance == instances.end() || endpoint.partitions.empty()) continue;
    facts.partitions[instance->second] = endpoint.partitions.front();
  }
  return facts;
}

std::vector<Finding> examine_domain(const DomainView& view) {
  try {
    return run_checks(domain_checks(), gather_domain_facts(view));
  } catch (const std::runtime_error& error) {
    return {{"domain", Severity::kProblem,
             "this program cannot join the domain: " + std::string(error.what()),
             "services would fail in the same way",
             "fix the problems above, or the file that the message names"}};
  }
}

int examine(const DoctorOptions& options) {
  // The machine first: a participant cleans up after dead processes.
  std::vector<Finding> findings =
      run_checks(machine_checks(), gather_machine_facts(questions_of(options)));
  if (!options.alone) {
    for (Finding& finding : examine_domain(options.view)) findings.push_back(std::move(finding));
  }
  std::cout << (options.json ? findings_json(findings) : findings_text(findings));
  return count(findings, Severity::kProblem) == 0 ? service::kOk : service::kFailure;
}

}  // namespace

void add_doctor_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command = app.add_subcommand(
      "doctor", "Check this machine and the services on the network for problems");
  auto options = std::make_shared<DoctorOptions>();
  add_domain_options(*command, options->view);
  command
      ->add_option("--map", options->map,
                   "folder of the map (default: that of the package, else this folder)")
      ->type_name("DIR");
  command
      ->add_option("--devices", options->devices,
                   "file of the robot's devices (default: that of the package, else every USB "
                   "serial port)")
      ->type_name("FILE");
  command->add_flag("--alone", options->alone, "this machine only: join no domain");
  command->add_flag("--json", options->json,
                    "for programs: severity, problem, reason and remedy of each");
  command->footer(
      "Run it as the user that the services run as, with their environment and options:\n"
      "  sudo -u topogeo topogeo doctor\n"
      "Exit code: 0 no problem (there may be hints), 1 at least one problem.");
  command->callback([options, &exit_code] { exit_code = examine(*options); });
}

}  // namespace topogeo::cli
