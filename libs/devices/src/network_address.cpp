#include "topogeo/devices/network_address.hpp"

#include <charconv>
#include <stdexcept>

namespace topogeo::devices {
namespace {

constexpr std::string_view kScheme = "tcp://";
constexpr std::string_view kDatagramScheme = "udp://";

std::invalid_argument wrong(std::string_view path) {
  return std::invalid_argument(
      "'" + std::string(path) +
      "': expected tcp://HOST:PORT or udp://HOST:PORT, with a port from 1 to 65535");
}

}  // namespace

bool is_network_address(std::string_view path) {
  return path.starts_with(kScheme) || path.starts_with(kDatagramScheme);
}

NetworkAddress network_address(std::string_view path) {
  if (!is_network_address(path)) throw wrong(path);
  std::string_view rest = path.substr(kScheme.size());
  NetworkAddress address;
  address.datagrams = path.starts_with(kDatagramScheme);
  const bool bracketed = rest.starts_with('[');
  const std::size_t end = bracketed ? rest.find(']') : rest.find(':');
  if (bracketed && end == std::string_view::npos) throw wrong(path);
  address.host = bracketed ? rest.substr(1, end - 1) : rest.substr(0, end);
  rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + bracketed);
  if (address.host.empty() || address.host.find_first_of("/ ") != std::string::npos) {
    throw wrong(path);
  }
  if (rest.empty()) return address;
  if (rest.front() != ':') throw wrong(path);
  rest.remove_prefix(1);
  std::uint16_t port = 0;
  const auto [at, error] = std::from_chars(rest.data(), rest.data() + rest.size(), port);
  if (error != std::errc() || at != rest.data() + rest.size() || port == 0) throw wrong(path);
  address.port = port;
  return address;
}

std::string with_port(const std::string& path, std::uint16_t default_port) {
  if (!is_network_address(path)) return path;
  if (network_address(path).port || default_port == 0) return path;
  return path + ":" + std::to_string(default_port);
}

}  // namespace topogeo::devices
