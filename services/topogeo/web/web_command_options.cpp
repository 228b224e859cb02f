#include "web/web_command_options.hpp"

#include <cstdlib>
#include <fstream>
#include <random>

#include "topogeo/service/service_options.hpp"
#include "topogeo/service/web_access.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::cli {
namespace {

constexpr const char* kTokenVariable = "TOPOGEO_WEB_TOKEN";

/// The value of the environment variable; empty if it is not set.
std::string token_of_environment() {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): no other thread uses the environment yet
  const char* const given = std::getenv(kTokenVariable);
  return given != nullptr ? given : "";
}

/// The token from the command line, from its file or from the environment.
std::optional<std::string> given_token(const WebOptions& options) {
  if (options.token && options.token_file) {
    throw service::UsageError("expected --token or --token-file, not both");
  }
  if (options.token) return options.token;
  if (options.token_file) return service::read_web_token(*options.token_file);
  const std::string token = token_of_environment();
  return token.empty() ? std::nullopt : std::optional(token);
}

std::string new_token() {
  std::random_device random;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", random());
  return token;
}

}  // namespace

void add_web_options(command_line::Command& app, WebOptions& options,
                     command_line::Option* needed) {
  constexpr std::uint32_t kLargestPort = 65535;
  const std::vector<command_line::Option*> added = {
      app.add_option("--port", options.port, "port of the page (default: 8080), 0: any free one")
          ->check(command_line::range(0U, kLargestPort)),
      app.add_option("--bind", options.bind,
                     "address of the page (default: 127.0.0.1); others than those of this machine "
                     "alone need --certificate")
          ->type_name("ADDRESS"),
      app.add_option(service::kTokenOption, options.token,
                     "operator token, which permits to send the robot; default: a new one, which "
                     "is printed. `ps` shows it: prefer --token-file")
          ->type_name("TEXT"),
      app.add_option("--token-file", options.token_file,
                     "file with the token, which `ps` does not show")
          ->type_name("FILE"),
      app.add_option("--certificate", options.certificate, "certificate of the page (PEM)")
          ->type_name("FILE"),
      app.add_option("--key", options.key, "key of the certificate (PEM)")->type_name("FILE"),
      app.add_flag(
          "--without-tls", options.without_tls,
          "listen at --bind without TLS, although any program on the network can read the token"),
      app.add_option("--host", options.hosts,
                     "name under which pages reach this machine or the proxy before it; may be "
                     "repeated")
          ->type_name("NAME")
          ->allow_extra_args(false),
      app.add_option("--origin", options.origins,
                     "site whose pages may use the service, as https://desk.example: that of a "
                     "reverse proxy; may be repeated")
          ->type_name("ORIGIN")
          ->allow_extra_args(false)};
  if (needed == nullptr) return;
  for (command_line::Option* option : added) option->needs(needed);
}

void check_web_options(const WebOptions& options) {
  if (const auto token = given_token(options)) service::check_web_token(*token);
  const std::string address = options.bind.value_or("127.0.0.1");
  service::check_web_address(address, options.certificate.has_value(), options.key.has_value(),
                             options.without_tls);
  constexpr std::uint32_t kUsualPort = 8080;
  service::check_web_port(address, options.port.value_or(kUsualPort));
}

void export_token(const WebOptions& options) {
  if (options.token) service::warn_of_shown_token();
  const auto given = given_token(options);
  const std::string token = given ? *given : new_token();
  if (token == token_of_environment()) return;
  // NOLINTNEXTLINE(concurrency-mt-unsafe): the same
  ::setenv(kTokenVariable, token.c_str(), 1);
}

std::vector<std::string> web_arguments(const WebOptions& options) {
  std::vector<std::string> arguments;
  const auto add = [&arguments](const std::string& name, const std::string& value) {
    arguments.push_back(name);
    arguments.push_back(value);
  };
  if (options.port) add("--port", std::to_string(*options.port));
  if (options.bind) add("--bind", *options.bind);
  if (options.certificate) add("--certificate", options.certificate->string());
  if (options.key) add("--key", options.key->string());
  for (const std::string& host : options.hosts) add("--host", host);
  for (const std::string& origin : options.origins) add("--origin", origin);
  if (options.without_tls) arguments.emplace_back("--without-tls");
  return arguments;
}

std::filesystem::path link_file_beside(const std::filesystem::path& log) {
  return log.parent_path() / "web.link";
}

std::string links_in(const std::filesystem::path& log, bool with_token) {
  std::ifstream file(log);
  std::string links;
  std::string line;
  while (std::getline(file, line)) {
    const bool of_spectators = line.starts_with("spectators:");
    if (line.starts_with("operator:")) {
      if (with_token) {
        std::ifstream link(link_file_beside(log));
        std::getline(link, line);
        line.insert(0, "operator:   ");
      }
      links += line + '\n';
    }
    // The second line is complete once its end has arrived.
    if (of_spectators && !file.eof()) return links + line + '\n';
  }
  return {};
}

}  // namespace topogeo::cli
