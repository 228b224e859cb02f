#include "web_options.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "topogeo/service/operator_stop.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/service/web_access.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/secret_file.hpp"

#include "server/access.hpp"

namespace topogeo::web {
namespace {

/// Checks for the form that browsers send; programs whose page is a file send "file://".
void check_origins(const std::vector<std::string>& origins) {
  for (const std::string& origin : origins) {
    const std::size_t host = origin.find("://");
    const bool site = host != std::string::npos && host > 0 &&
                      origin.find_first_of("/?# ", host + 3) == std::string::npos;
    if (site && (origin == "file://" || origin.size() > host + 3)) continue;
    throw service::UsageError("--origin " + origin +
                              ": expected scheme and host alone, as https://desk.example or "
                              "https://desk.example:8443");
  }
}

}  // namespace

void add_web_options(command_line::Command& app, WebOptions& options) {
  constexpr std::uint32_t kLargestPort = 65535;
  app.add_option("--port", options.port, "port to listen at, 0: any free one")
      ->check(command_line::range(0U, kLargestPort))
      ->capture_default_str();
  app.add_option("--bind", options.bind,
                 "address to listen at; others than those of this machine alone need --certificate")
      ->type_name("ADDRESS")
      ->capture_default_str();
  app.add_option(service::kTokenOption, options.token,
                 "operator token, which permits to send the robot; default: a new one, which is "
                 "printed. `ps` shows it: prefer --token-file")
      ->environment("TOPOGEO_WEB_TOKEN")
      ->type_name("TEXT");
  app.add_option("--token-file", options.token_file,
                 "file with the token, which `ps` does not show")
      ->type_name("FILE");
  app.add_option("--link-file", options.link_file,
                 "write the operator's link, which holds the token, to this file of mode 0600 "
                 "instead of printing it to logs that others can read")
      ->type_name("FILE");
  app.add_option("--memory", options.memory,
                 "file with an operator's stop that no base reports, which a restarted service "
                 "keeps until the release (default: in the runtime directory of systemd, else in "
                 "/dev/shm)")
      ->type_name("FILE");
  app.add_option("--audit-log", options.audit_log,
                 "append a line for each order to this file: when, who, what")
      ->type_name("FILE");
  app.add_option("--alarms", options.alarms,
                 "file with the newest 200 alarms and who acknowledged them, which a restarted "
                 "service goes on with (default: beside the audit log, none without one)")
      ->type_name("FILE");
  app.add_option("--certificate", options.certificate,
                 "certificate of the server with its chain (PEM)")
      ->type_name("FILE");
  app.add_option("--key", options.key, "key of the certificate (PEM)")->type_name("FILE");
  app.add_flag("--without-tls", options.without_tls,
               "listen at --bind without TLS, although any program on the network can read the "
               "token: behind a proxy or in a closed network");
  app.add_option(
         "--host", options.hosts,
         "name under which pages reach this machine, in addition to its own; may be repeated")
      ->type_name("NAME")
      ->allow_extra_args(false);
  app.add_option(
         "--origin", options.origins,
         "site whose pages may use the service too, as https://desk.example; may be repeated")
      ->type_name("ORIGIN")
      ->allow_extra_args(false);
  app.add_option("--page", options.page, "folder of the page; replaces the installed one")
      ->type_name("DIR");
  app.add_option("--viewers", options.most_viewers, "largest number of simultaneous pages")
      ->check(command_line::range(1U, 1000U))
      ->capture_default_str();
  service::add_map_option(app, options.map_robot);
}

ServerConfig server_config(const WebOptions& options, const std::string& robot_id) {
  ServerConfig config;
  config.address = options.bind;
  config.port = options.port;
  if (options.token && options.token_file) {
    throw service::UsageError("expected --token or --token-file, not both");
  }
  if (options.token) {
    config.token = *options.token;
  } else {
    config.token = options.token_file ? service::read_web_token(*options.token_file) : new_token();
  }
  service::check_web_token(config.token);
  config.life = new_token().substr(0, 16);
  config.robot_id = robot_id;
  config.hosts = options.hosts;
  config.hosts.push_back(support::host_name());
  check_origins(options.origins);
  config.origins = options.origins;
  config.certificate_file = options.certificate.string();
  config.key_file = options.key.string();
  config.most_viewers = options.most_viewers;
  service::check_web_address(options.bind, !config.certificate_file.empty(),
                             !config.key_file.empty(), options.without_tls);
  return config;
}

KeptFiles kept_files(const WebOptions& options, const service::Setup& setup) {
  KeptFiles kept{options.memory, options.audit_log, options.alarms};
  if (kept.memory.empty()) kept.memory = service::OperatorStop::place_of(setup);
  if (kept.alarms.empty() && !kept.audit.empty()) {
    kept.alarms = kept.audit;
    kept.alarms.replace_extension(".alarms.jsonl");
  }
  return kept;
}

PageFiles page_files(const WebOptions& options) {
  if (!options.page.empty()) return PageFiles(options.page);
  // Paths in a build and in an installation, where programs are in libexec/topogeo.
  const std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path();
  for (const char* folder : {"../share/topogeo/web", "../../share/topogeo/web"}) {
    const std::filesystem::path page = (program / folder).lexically_normal();
    if (std::filesystem::exists(page / "index.html")) return PageFiles(page);
  }
  return PageFiles();
}

std::string links(const ServerConfig& config, std::uint32_t port,
                  const std::filesystem::path& link_file) {
  std::string host = config.address;
  if (host == "0.0.0.0" || host == "::") host = support::host_name();
  if (host.find(':') != std::string::npos) host = "[" + host + "]";
  const std::string scheme = config.certificate_file.empty() ? "http" : "https";
  const std::string link = fmt::format("{}://{}:{}/", scheme, host, port);
  std::string of_operator = fmt::format("{}#token={}", link, config.token);
  if (!link_file.empty()) {
    try {
      support::write_secret_file(link_file, of_operator + '\n');
    } catch (const std::runtime_error& error) {
      throw service::BadInputError(error.what());
    }
    of_operator = fmt::format("in {}, which its owner and root can read", link_file.string());
  }
  return fmt::format("operator:   {}\nspectators: {}\n", of_operator, link);
}

}  // namespace topogeo::web
