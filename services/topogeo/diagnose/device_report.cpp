#include "diagnose/device_report.hpp"

#include <string_view>

#include <nlohmann/json.hpp>

#include "topogeo/devices/base_models.hpp"
#include "topogeo/devices/laser_models.hpp"
#include "topogeo/devices/network_address.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/printable.hpp"

namespace topogeo::cli {
namespace {

using devices::DeviceKind;
using devices::RecognizedDevice;

std::string_view kind_name(const RecognizedDevice& device) {
  return device.kind == DeviceKind::kLaser ? "laser" : "base";
}

std::string title_of(const RecognizedDevice& device) {
  return std::string(device.kind == DeviceKind::kLaser ? devices::laser_model(device.model).title
                                                       : devices::base_model(device.model).title);
}

/// Keys of a device below "laser:" or "base:", each on its line.
std::string keys_of(const SearchedPort& port, std::string_view indent) {
  const RecognizedDevice& device = *port.device;
  std::string keys = fmt::format("{0}port: {1}\n{0}model: {2}\n", indent, port.name, device.model);
  if (device.kind == DeviceKind::kBase) {
    keys += fmt::format("{}baud: {}\n", indent, device.line.baud);
  }
  return keys;
}

std::string facts_of(const SearchedPort& port) {
  const RecognizedDevice& device = *port.device;
  std::string facts = title_of(device) + (port.asked ? ", answers" : ", sends");
  if (!devices::is_network_address(port.port)) {
    facts += fmt::format(" at {} baud", device.line.baud);
  }
  if (!device.device.empty()) facts += ", " + support::printable(device.device);
  if (!device.note.empty()) facts += "; " + device.note;
  return facts;
}

}  // namespace

std::string ports_text(std::span<const SearchedPort> ports, std::size_t /*columns*/) {
  std::string text;
  for (const SearchedPort& port : ports) {
    text += support::printable(port.port) + "\n";
    if (!port.error.empty()) {
      text += "  problem  " + support::printable(port.error) + "\n";
    } else if (port.device) {
      text += fmt::format("  {:<8} {}\n", kind_name(*port.device), facts_of(port));
      text += fmt::format(
          "  {:<8} {}: {{port: {}, model: {}{}}}\n", "settings", kind_name(*port.device),
          support::printable(port.name), port.device->model,
          port.device->kind == DeviceKind::kBase ? fmt::format(", baud: {}", port.device->line.baud)
                                                 : "");
    } else {
      text += "  unknown  " + port.why_none + "\n";
    }
  }
  return text;
}

std::string ports_json(std::span<const SearchedPort> ports) {
  nlohmann::ordered_json report = {{"ports", nlohmann::ordered_json::array()}};
  for (const SearchedPort& port : ports) {
    nlohmann::ordered_json entry = {
        {"port", port.port}, {"name", port.name},
        {"kind", nullptr},   {"model", nullptr},
        {"title", nullptr},  {"baud", nullptr},
        {"device", nullptr}, {"asked", nullptr},
        {"note", nullptr},   {"problem", port.error.empty() ? port.why_none : port.error}};
    if (port.device) {
      entry["kind"] = kind_name(*port.device);
      entry["model"] = port.device->model;
      entry["title"] = title_of(*port.device);
      entry["baud"] = port.device->line.baud;
      entry["device"] = port.device->device;
      entry["asked"] = port.asked;
      entry["note"] = port.device->note;
      entry["problem"] = "";
    }
    report["ports"].push_back(std::move(entry));
  }
  return report.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string devices_file(std::span<const SearchedPort> ports) {
  std::string file;
  for (const DeviceKind kind : {DeviceKind::kLaser, DeviceKind::kBase}) {
    bool first = true;
    for (const SearchedPort& port : ports) {
      if (!port.device || port.device->kind != kind) continue;
      file += fmt::format("# {}\n", facts_of(port));
      if (first) {
        file += fmt::format("{}:\n{}", kind_name(*port.device), keys_of(port, "  "));
        if (kind == DeviceKind::kBase) {
          file += "  # Measure base.ticks_per_m and base.track_m before the first drive.\n";
        }
      } else {
        file += keys_of(port, "#   ");
      }
      first = false;
    }
  }
  if (file.empty()) return file;
  return "# Written by `topogeo devices`; `topogeo config --devices` explains every key.\n" + file;
}

}  // namespace topogeo::cli
