// Corrects the pose of every stop by matching its local map against earlier ones.
#include <stdexcept>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/service/map_replacement.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/service/sole_service.hpp"

#include "localizer_service.hpp"
#include "shared_localizer_service.hpp"

int main(int argc, char** argv) {
  using namespace topogeo;  // NOLINT(google-build-using-namespace)
  localizer::LocalizerOptions options;
  std::string initial_pose;
  std::vector<std::string> robots;
  return service::run_service(
      argc, argv, "localizer", "Corrects the trajectory by matching local maps.",
      [&](command_line::Command& app) {
        app.add_option("--wait-workers", options.wait_workers,
                       "search workers to wait for before the first step")
            ->capture_default_str();
        constexpr double kLongestWait_s = 3600.0;
        app.add_option("--wait-seconds", options.wait_s, "longest wait for these workers")
            ->check(command_line::range(0.0, kLongestWait_s))
            ->capture_default_str();
        command_line::Option* map =
            app.add_option("--map", options.map, "map.pb to localize in, read-only")
                ->type_name("FILE");
        map->excludes(app.add_option("--continue", options.continued,
                                     "map.pb to extend: the robot is localized in it, then maps on")
                          ->type_name("FILE"));
        app.add_option("--initial-pose", initial_pose,
                       "initial pose of the robot in the map, m and degrees (default: search the "
                       "whole map)")
            ->type_name("X,Y,DEG");
        app.add_flag(
            "--standalone", options.standalone,
            "run without a map store: begin a new map instead of waiting for the stored one");
        service::add_robots_option(app, robots);
        app.add_flag("--replay", options.replay,
                     "the stops come from a log: after a restart, add all of them again to get the "
                     "same map");
        app.add_option("--csv", options.csv,
                       "file for the pose and state of each stop; complete when the localizer ends")
            ->needs(map)
            ->type_name("FILE");
        app.add_option("--memory", options.memory,
                       "file with the pose of the robot, from which a restarted localizer resumes; "
                       "best in /run, because it is written at each stop")
            ->needs(map)
            ->type_name("FILE");
      },
      [&](const service::Setup& setup) {
        try {
          if (!initial_pose.empty() && !options.map && !options.continued) {
            throw service::UsageError("--initial-pose: expected with --map or --continue");
          }
          if (!initial_pose.empty()) options.initial_pose = pipeline::parse_pose(initial_pose);
        } catch (const std::invalid_argument& error) {
          throw service::UsageError(error.what());
        }
        if (!robots.empty()) {
          if (options.map || options.continued || options.replay || options.wait_workers > 0) {
            throw service::UsageError(
                "--with-robots resumes the map of the map store: expected no --map, --continue, "
                "--replay or --wait-workers");
          }
        }
        const auto work = [&] {
          service::Service service(service::with_robots(setup, robots));
          const service::SoleService sole(service);
          if (!robots.empty()) {
            const localizer::SharedLocalizerService localizer(service, options.standalone);
            return service::run_with_one_map(service);
          }
          const localizer::LocalizerService localizer(service, options);
          return service::run_with_one_map(service);
        };
        while (work()) options.continued.reset();  // the map store has the map now
      });
}
