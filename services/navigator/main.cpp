// Drives the robot along the routes of the planner.
#include <filesystem>
#include <string>

#include "topogeo/service/operator_stop.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/service/service_options.hpp"

#include "navigator_service.hpp"

int main(int argc, char** argv) {
  using namespace topogeo;  // NOLINT(google-build-using-namespace)
  std::string map_robot;
  std::filesystem::path memory;
  std::filesystem::path stop_memory;
  return service::run_service(
      argc, argv, "navigator", "Drives to goals along the planner's routes.",
      [&](command_line::Command& app) {
        service::add_map_option(app, map_robot);
        app.add_option(
               "--memory", memory,
               "file with the goal, to which a restarted navigator drives on, even without "
               "its client; best in /run. FILE.stop has an operator's stop until the release")
            ->type_name("FILE");
        app.add_option("--stop-memory", stop_memory,
                       "another file with the operator's stop, for example one that outlives the "
                       "goal")
            ->type_name("FILE");
      },
      [&](const service::Setup& setup) {
        service::Service service(service::with_map_of(setup, map_robot));
        if (stop_memory.empty()) {
          stop_memory = memory.empty() ? service::OperatorStop::place_of(setup)
                                       : std::filesystem::path(memory.string() + ".stop");
        }
        const navigator::NavigatorService navigator(service, memory, stop_memory);
        service.run();
      });
}
