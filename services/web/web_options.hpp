// Command line of the service.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/service/service_options.hpp"

#include "kept_files.hpp"
#include "server/page_files.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {

struct WebOptions {
  std::uint32_t port = 8080;
  std::string bind = "127.0.0.1";
  std::optional<std::string> token;
  std::optional<std::filesystem::path> token_file;
  std::filesystem::path link_file;  ///< gets the operator's link; empty: it is printed
  std::filesystem::path memory;     ///< of an operator's stop; empty: its usual place
  std::filesystem::path audit_log;  ///< gets each order; empty: none is kept
  std::filesystem::path alarms;     ///< empty: beside the audit log
  std::filesystem::path certificate;
  std::filesystem::path key;
  std::vector<std::string> hosts;
  std::vector<std::string> origins;
  std::filesystem::path page;  ///< empty: the one beside the program
  std::uint32_t most_viewers = 64;
  bool without_tls = false;
  std::string map_robot;
};

void add_web_options(command_line::Command& app, WebOptions& options);

/// Makes a token if none is given. Throws service::UsageError for options that do not go together,
/// and service::BadInputError for an unreadable token file.
ServerConfig server_config(const WebOptions& options, const std::string& robot_id);

/// The files that are given, and the usual places of others.
KeptFiles kept_files(const WebOptions& options, const service::Setup& setup);

/// Throws std::runtime_error for a given folder that cannot be used.
PageFiles page_files(const WebOptions& options);

/// Two lines: the link of operators and that of spectators. With a link file the operator's link,
/// which contains the token, goes only there, and the line names the file. Throws
/// service::BadInputError when the file cannot be written.
std::string links(const ServerConfig& config, std::uint32_t port,
                  const std::filesystem::path& link_file);

}  // namespace topogeo::web
