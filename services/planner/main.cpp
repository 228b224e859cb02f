// Plans routes on the live hybrid map.
#include "topogeo/service/service.hpp"
#include "topogeo/service/service_options.hpp"

#include "planner_service.hpp"

int main(int argc, char** argv) {
  using namespace topogeo;  // NOLINT(google-build-using-namespace)
  std::string map_robot;
  return service::run_service(
      argc, argv, "planner", "Answers goals with routes on the map.",
      [&](command_line::Command& app) { service::add_map_option(app, map_robot); },
      [&](const service::Setup& setup) {
        service::Service service(service::with_map_of(setup, map_robot));
        const planner::PlannerService planner(service);
        service.run();
      });
}
