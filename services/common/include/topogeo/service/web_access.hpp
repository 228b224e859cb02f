// Who may reach a web service: checked by it and by the commands that start it, before they start
// anything.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace topogeo::service {

/// Option with the operator's token: programs hide its value (command_line::SecretArguments).
inline constexpr const char* kTokenOption = "--token";

/// Logs that the token was on the command line, and where it belongs.
void warn_of_shown_token();

/// The token in a file, without white space. Throws BadInputError when it cannot be read.
std::string read_web_token(const std::filesystem::path& file);

/// Throws command_line::UsageError unless it has 16 letters, digits, '-', '_' or '.' or more.
void check_web_token(const std::string& token);

/// Throws command_line::UsageError for a certificate without its key or the reverse, and for an
/// address that others reach than this machine alone with neither certificate nor `without_tls`.
void check_web_address(const std::string& address, bool has_certificate, bool has_key,
                       bool without_tls);

/// Throws std::runtime_error when another program listens there. What else may be wrong with the
/// address the service says itself.
void check_web_port(const std::string& address, std::uint32_t port);

}  // namespace topogeo::service
