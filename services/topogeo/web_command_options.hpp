// The web service of a command: what its command line says of it.
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
/// --origin; with `needed` they go with that option alone. What they mean is in `topogeo-web
/// --help`.
void add_web_options(command_line::Command& app, WebOptions& options,
                     command_line::Option* needed = nullptr);

/// Throws service::UsageError for what the service refuses: a token that is too short, of the
/// command line, a file or the environment, two tokens, or an address that asks for a certificate;
/// service::BadInputError for a file that cannot be read; std::runtime_error when another program
/// listens at the port.
void check_web_options(const WebOptions& options);

/// Hands the token, or one that is made here, to the programs that are started from here on: by the
/// environment, which `ps` does not show. A service that is started again has the same. Throws like
/// check_web_options().
void export_token(const WebOptions& options);

/// As arguments of the program `web`, without the token.
std::vector<std::string> web_arguments(const WebOptions& options);

/// For a web service whose log is this file: where it writes the operator's link (--link-file).
std::filesystem::path link_file_beside(const std::filesystem::path& log);

/// The lines with the links that a web service has written to its log and beside it; empty: it has
/// not yet. `with_token`: the operator's link is in them; else the file that has it.
std::string links_in(const std::filesystem::path& log, bool with_token);

}  // namespace topogeo::cli
