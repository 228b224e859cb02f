// Makes a local topo-geometric map at each stop of the robot.

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/service/map_replacement.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/service/service_options.hpp"

#include "local_mapper_service.hpp"

int main(int argc, char** argv) {
  using namespace topogeo;  // NOLINT(google-build-using-namespace)
  bool replay = false;
  bool standalone = false;
  return service::run_service(
      argc, argv, "local_mapper", "Makes local topo-geometric maps of laser scans.",
      [&](command_line::Command& app) {
        app.add_flag("--replay", replay,
                     "the scans come from a log: slow down the replay instead of losing scans");
        app.add_flag(
            "--standalone", standalone,
            "run without a map store: begin a new session instead of resuming the last one");
      },
      [&](const service::Setup& setup) {
        const auto work = [&] {
          service::Service service(setup);
          const local_mapper::LocalMapperService mapper(service, replay, standalone);
          return service::run_with_one_map(service);
        };
        while (work()) {
        }
      });
}
