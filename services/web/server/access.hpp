// Access control: the operator's token, and the sites whose pages may talk to the service.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace topogeo::web {

/// 128 random bits as 32 hexadecimal digits.
std::string new_token();

/// Takes the same time wherever the texts differ.
bool equal_in_constant_time(std::string_view a, std::string_view b);

/// Checks "Bearer TOKEN" of the header Authorization. False for an empty token: nobody may write
/// then.
bool is_authorized(std::string_view authorization, std::string_view token);

/// The names in a comma-separated header, without spaces.
std::vector<std::string_view> names_in(std::string_view list);

/// Whether one of `names` is "token." with the token's bytes in hexadecimal digits, the form in
/// which a page passes the token when it opens a WebSocket. False for an empty token.
bool offers_token(const std::vector<std::string_view>& names, std::string_view token);

/// Whether a request has the token in either header: Authorization, or Sec-WebSocket-Protocol, the
/// only one that a page can set when it opens a WebSocket.
bool shows_token(std::string_view authorization, std::string_view protocols,
                 std::string_view token);

/// The name in "name:port", without brackets of IPv6.
std::string_view host_of(std::string_view authority);

/// Whether a foreign site cannot have taken over this name (DNS rebinding): a numeric address,
/// localhost, or one of `names` (this machine's, and those that the user allows). Case does not
/// matter.
bool is_own_host(std::string_view authority, const std::vector<std::string>& names);

/// Whether a request comes from a page of this service: `origin` is the header Origin (empty: not
/// from a page), `host` the header Host, `allowed` lists further origins, "https://desk.example".
bool is_own_origin(std::string_view origin, std::string_view host,
                   const std::vector<std::string>& allowed);

}  // namespace topogeo::web
