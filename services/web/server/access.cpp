#include "server/access.hpp"

#include <algorithm>
#include <random>

#include "topogeo/support/format.hpp"
#include "topogeo/support/lower_case.hpp"

namespace topogeo::web {
namespace {

bool is_address(std::string_view host) {
  const auto all = [&](std::string_view allowed) {
    return host.find_first_not_of(allowed) == std::string_view::npos;
  };
  if (host.find(':') != std::string_view::npos) return all("0123456789abcdefABCDEF:.");
  return host.find('.') != std::string_view::npos && all("0123456789.");
}

}  // namespace

std::string new_token() {
  std::random_device random;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", random());
  return token;
}

bool equal_in_constant_time(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  }
  return difference == 0;
}

bool is_authorized(std::string_view authorization, std::string_view token) {
  constexpr std::string_view kScheme = "Bearer ";
  if (token.empty() || !authorization.starts_with(kScheme)) return false;
  return equal_in_constant_time(authorization.substr(kScheme.size()), token);
}

std::vector<std::string_view> names_in(std::string_view list) {
  std::vector<std::string_view> names;
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    std::string_view name = list.substr(0, comma);
    list.remove_prefix(std::min(comma + 1, list.size()));
    name.remove_prefix(std::min(name.find_first_not_of(" \t"), name.size()));
    names.push_back(name.substr(0, name.find_last_not_of(" \t") + 1));
  }
  return names;
}

bool offers_token(const std::vector<std::string_view>& names, std::string_view token) {
  if (token.empty()) return false;
  std::string shown = "token.";
  for (const char byte : token) shown += fmt::format("{:02x}", static_cast<unsigned char>(byte));
  return std::ranges::any_of(
      names, [&](std::string_view name) { return equal_in_constant_time(name, shown); });
}

bool shows_token(std::string_view authorization, std::string_view protocols,
                 std::string_view token) {
  return is_authorized(authorization, token) || offers_token(names_in(protocols), token);
}

std::string_view host_of(std::string_view authority) {
  if (authority.starts_with('[')) {
    const std::size_t end = authority.find(']');
    return end == std::string_view::npos ? std::string_view{} : authority.substr(1, end - 1);
  }
  return authority.substr(0, authority.find(':'));
}

bool is_own_host(std::string_view authority, const std::vector<std::string>& names) {
  const std::string host = support::lower_case(host_of(authority));
  if (host.empty()) return false;
  if (is_address(host) || host == "localhost") return true;
  return std::ranges::any_of(
      names, [&](const std::string& name) { return support::lower_case(name) == host; });
}

bool is_own_origin(std::string_view origin, std::string_view host,
                   const std::vector<std::string>& allowed) {
  if (origin.empty()) return true;
  if (std::ranges::find(allowed, origin) != allowed.end()) return true;
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (origin.starts_with(scheme) &&
        support::lower_case(origin.substr(scheme.size())) == support::lower_case(host)) {
      return true;
    }
  }
  return false;
}

}  // namespace topogeo::web
