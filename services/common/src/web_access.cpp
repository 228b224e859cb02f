#include "topogeo/service/web_access.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/file_content.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/log.hpp"

namespace topogeo::service {
namespace {

constexpr std::size_t kShortestToken = 16;

bool is_loopback(const std::string& address) {
  return address == "::1" || address.starts_with("127.");
}

}  // namespace

void warn_of_shown_token() {
  spdlog::warn(
      "--token: `ps` shows the token to all users of this machine; use --token-file or "
      "TOPOGEO_WEB_TOKEN");
}

std::string read_web_token(const std::filesystem::path& file) {
  try {
    std::string token = support::file_content(file);
    std::erase_if(token, [](unsigned char c) { return std::isspace(c) != 0; });
    return token;
  } catch (const std::runtime_error& error) {
    throw BadInputError(error.what());
  }
}

void check_web_token(const std::string& token) {
  const bool plain = std::ranges::all_of(token, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
  });
  if (token.size() < kShortestToken || !plain) {
    throw command_line::UsageError(
        "--token: expected at least 16 letters, digits, '-', '_' or '.'; see --help");
  }
}

void check_web_address(const std::string& address, bool has_certificate, bool has_key,
                       bool without_tls) {
  if (has_certificate != has_key) {
    throw command_line::UsageError("--certificate and --key go together");
  }
  if (!is_loopback(address) && !has_certificate && !without_tls) {
    throw command_line::UsageError(
        "--bind " + address + ": expected --certificate and --key, or --without-tls; see --help");
  }
}

void check_web_port(const std::string& address, std::uint32_t port) {
  namespace asio = boost::asio;
  boost::system::error_code error;
  const auto host = asio::ip::make_address(address, error);
  if (error || port == 0) return;
  asio::io_context context;
  asio::ip::tcp::acceptor acceptor(context);
  const asio::ip::tcp::endpoint endpoint(host, static_cast<std::uint16_t>(port));
  acceptor.open(endpoint.protocol(), error);
  acceptor.set_option(asio::ip::tcp::acceptor::reuse_address(true), error);
  acceptor.bind(endpoint, error);
  if (error != asio::error::address_in_use) return;
  throw std::runtime_error(fmt::format(
      "another program listens at {} port {}: choose another --port, 0 for any free one", address,
      port));
}

}  // namespace topogeo::service
