// Access rules of a web service, checked by the service itself and beforehand by the commands that
// start it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace topogeo::service {

/// Option with the operator's token: programs hide its value (command_line::SecretArguments).
inline constexpr const char* kTokenOption = "--token";

/// Logs a warning that the token was on the command line, and where it belongs.
void warn_of_shown_token();

/// The token in a file, without white space. Throws BadInputError when it cannot be read.
std::string read_web_token(const std::filesystem::path& file);

/// Throws command_line::UsageError unless it is 16 or more letters, digits, '-', '_' or '.'.
void check_web_token(const std::string& token);

/// Throws command_line::UsageError for a certificate without its key or the reverse, and for an
/// address reachable from other machines with neither certificate nor `without_tls`.
void check_web_address(const std::string& address, bool has_certificate, bool has_key,
                       bool without_tls);

/// Throws std::runtime_error when another program listens there. The service itself reports other
/// problems with the address.
void check_web_port(const std::string& address, std::uint32_t port);

}  // namespace topogeo::service
