// Command-line options of a command's web service.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"

namespace topogeo::cli {

struct WebOptions {
  std::optional<std::uint32_t> port;
  std::optional<std::string> bind;
  std::optional<std::string> token;
  std::optional<std::filesystem::path> token_file;
  std::optional<std::filesystem::path> certificate;
  std::optional<std::filesystem::path> key;
  bool without_tls = false;
  std::vector<std::string> hosts;
  std::vector<std::string> origins;
};

/// Adds --port, --bind, --token, --token-file, --certificate, --key, --without-tls, --host and
/// --origin, explained by `topogeo-web --help`; with `needed` they require that option.
void add_web_options(command_line::Command& app, WebOptions& options,
                     command_line::Option* needed = nullptr);

/// Throws service::UsageError for options that the service refuses: a token that is too short (from
/// the command line, a file or the environment), two tokens, or an address that requires a
/// certificate; service::BadInputError for an unreadable file; std::runtime_error when another
/// program listens at the port.
void check_web_options(const WebOptions& options);

/// Passes the given or a newly made token to all programs started later, by the environment, which
/// `ps` does not show. A restarted service gets the same token. Throws like check_web_options().
void export_token(const WebOptions& options);

/// Arguments for the program `web`, without the token.
std::vector<std::string> web_arguments(const WebOptions& options);

/// Path to which a web service with this log writes the operator's link (--link-file).
std::filesystem::path link_file_beside(const std::filesystem::path& log);

/// The lines with links that a web service has written to its log and beside it; empty until then.
/// `with_token`: includes the operator's link; otherwise the file that contains it.
std::string links_in(const std::filesystem::path& log, bool with_token);

}  // namespace topogeo::cli
