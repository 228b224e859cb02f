// Serves a robot's state to pages and programs, by HTTP and WebSocket.
#include <iostream>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "topogeo/command_line/secret_arguments.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/service/web_access.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/host.hpp"

#include "server/access.hpp"
#include "web_options.hpp"
#include "web_service.hpp"

int main(int argc, char** argv) {
  using namespace topogeo;  // NOLINT(google-build-using-namespace)
  web::WebOptions options;
  const command_line::SecretArguments arguments(argc, argv, {service::kTokenOption});
  return service::run_service(
      arguments.count(), arguments.values(), "web",
      "Shows the robot in a browser and takes the orders of its operator.",
      [&](command_line::Command& app) { web::add_web_options(app, options); },
      [&](const service::Setup& setup) {
        if (arguments.had_secret()) service::warn_of_shown_token();
        const web::ServerConfig config = web::server_config(options, setup.options.robot_id);
        service::Service service(service::with_map_of(setup, options.map_robot));
        const web::WebService web(service, config, web::page_files(options),
                                  web::kept_files(options, setup));
        std::cout << web::links(config, web.port(), options.link_file) << std::flush;
        service.run();
      });
}
