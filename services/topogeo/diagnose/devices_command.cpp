// topogeo devices: finds the devices on the serial ports and the settings that fit them.
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/devices/laser_models.hpp"
#include "topogeo/devices/network_address.hpp"
#include "topogeo/devices/port_search.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/atomic_file.hpp"

#include "commands.hpp"
#include "diagnose/device_report.hpp"
#include "diagnose/port_names.hpp"
#include "serial_line.hpp"

namespace topogeo::cli {
namespace {

constexpr std::chrono::milliseconds kPoll{20};

struct DevicesOptions {
  std::vector<std::string> ports;
  bool listen_only = false;
  bool json = false;
  std::optional<std::filesystem::path> write;
  bool force = false;
};

/// The search on one port. Must be used in its loop only.
class OpenPort {
 public:
  OpenPort(messaging::EventLoop& loop, std::string path, bool asks)
      : path_(std::move(path)),
        search_(asks, devices::is_network_address(path_) ? devices::PortSearch::Link::kNetwork
                                                         : devices::PortSearch::Link::kSerial),
        line_(loop, search_, sensor_gateway::PortOptions{path_}, {}) {}

  /// The search does not wait for a port that cannot be opened or is unplugged.
  [[nodiscard]] bool over() const { return search_.done() || !line_.why_closed().empty(); }

  [[nodiscard]] SearchedPort result() const {
    SearchedPort port;
    port.port = path_;
    port.name = lasting_name(path_).string();
    if (!search_.done()) {
      port.error = line_.why_closed();
      return port;
    }
    port.device = search_.device();
    port.asked = search_.asked();
    if (!port.device) port.why_none = search_.why_none();
    return port;
  }

 private:
  std::string path_;
  devices::PortSearch search_;
  sensor_gateway::SerialLine line_;
};

/// A host without a port is searched at the ports of the lasers in the table.
std::vector<std::string> ports_of(const std::string& path) {
  try {
    if (devices::is_network_address(path) && devices::network_address(path).datagrams) {
      throw service::UsageError("'" + path +
                                "': a laser that sends datagrams is not searched for; set "
                                "laser.port and laser.model");
    }
    if (!devices::is_network_address(path) || devices::network_address(path).port) {
      return {path};
    }
  } catch (const std::invalid_argument& error) {
    throw service::UsageError(error.what());
  }
  std::set<std::uint16_t> numbers;
  for (const devices::LaserModel& model : devices::laser_models()) {
    if (model.network_port == 0 || devices::sends_datagrams(model)) continue;
    numbers.insert(model.network_port);
  }
  std::vector<std::string> ports;
  ports.reserve(numbers.size());
  for (const std::uint16_t number : numbers) {
    ports.push_back(devices::with_port(path, number));
  }
  return ports;
}

std::vector<std::string> paths_of(const DevicesOptions& options) {
  std::vector<std::string> paths;
  if (options.ports.empty()) {
    for (const std::filesystem::path& port : serial_ports()) paths.push_back(port.string());
  }
  for (const std::string& path : options.ports) {
    for (std::string& port : ports_of(path)) paths.push_back(std::move(port));
  }
  return paths;
}

std::vector<SearchedPort> search_all(const DevicesOptions& options) {
  const std::vector<std::string> paths = paths_of(options);
  messaging::EventLoop loop;
  std::vector<std::unique_ptr<OpenPort>> ports;
  ports.reserve(paths.size());
  for (const std::string& path : paths) {
    ports.push_back(std::make_unique<OpenPort>(loop, path, !options.listen_only));
  }
  for (const auto& port : ports) {
    while (!port->over()) static_cast<void>(loop.run_for(kPoll));
  }
  std::vector<SearchedPort> results;
  results.reserve(ports.size());
  for (const auto& port : ports) results.push_back(port->result());
  return results;
}

int list_devices(const DevicesOptions& options) {
  if (options.write && !options.force && std::filesystem::exists(*options.write)) {
    throw service::UsageError(options.write->string() +
                              ": exists already; --force replaces it, or name another file");
  }
  const std::vector<SearchedPort> ports = search_all(options);
  std::cout << (options.json ? ports_json(ports) : ports_text(ports));
  if (ports.empty() && !options.json) {
    std::cout << "no serial port is here: plug a device in, or name a port\n";
  }
  const std::string file = devices_file(ports);
  if (!options.write) return file.empty() ? service::kFailure : service::kOk;
  if (file.empty()) {
    std::cerr << "topogeo: no device was found, so " << options.write->string()
              << " was not written\n";
    return service::kFailure;
  }
  support::write_file_atomically(*options.write, file);
  std::cerr << "written: " << options.write->string() << "; start with `topogeo run --devices "
            << options.write->string() << " --out DIR`\n";
  return service::kOk;
}

}  // namespace

void add_devices_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("devices", "Find the lasers and bases at the serial ports");
  auto options = std::make_shared<DevicesOptions>();
  command
      ->add_option(
          "port", options->ports,
          "ports to search; tcp://HOST for a laser on the network (default: every USB port "
          "and UART)")
      ->type_name("PORT");
  command->add_flag("--listen-only", options->listen_only, "send no requests to devices");
  command
      ->add_option("--write", options->write,
                   "write the devices file for --devices of other commands")
      ->type_name("FILE");
  command->add_flag("--force", options->force, "replace FILE");
  command->add_flag("--json", options->json, "for programs");
  command->footer(
      "Each port is listened to first. Only a port that is silent is asked, by requests of lasers\n"
      "that move no base. The search of a port takes up to 15 seconds; all are searched at once.\n"
      "`topogeo doctor` explains ports that cannot be opened.\n"
      "Exit codes: 0 a device was found, 1 none was found, 2 wrong flag or FILE exists.");
  command->callback([options, &exit_code] { exit_code = list_devices(*options); });
}

}  // namespace topogeo::cli
