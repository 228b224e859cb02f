#include "topogeo/service/web_access.hpp"

#include <algorithm>
#include <cctype>

#include "topogeo/command_line/command_line.hpp"

namespace topogeo::service {
namespace {

constexpr std::size_t kShortestToken = 16;

bool is_loopback(const std::string& address) {
  return address == "::1" || address.starts_with("127.");
}

}  // namespace

void check_web_token(const std::string& token) {
  const bool plain = std::ranges::all_of(token, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
  });
  if (token.size() < kShortestToken || !plain) {
    throw command_line::UsageError(
        "--token: expected 16 letters, digits, '-', '_' or '.' or more; see --help");
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

}  // namespace topogeo::service
