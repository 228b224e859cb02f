// Does a robot of 1.2 x 0.6 m get where it is sent without touching anything? Simulated drives on
// drawn floors between random poses, with noise of laser, sonars, wheels and poses.
//
//   topogeo_outline_drives [--runs 200] [--first-run 1] [--radius 0.8 [--axle 0.3]] [--verbose]
//
// With a radius the base cannot turn on the spot, and the table has the tightest turn that it was
// commanded.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <numbers>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/simulation/random_floors.hpp"

#include "navigation/outline_task.hpp"

namespace {

using namespace topogeo;  // NOLINT(google-build-using-namespace)

struct Row {
  std::string name;
  world::World world;
  std::uint64_t runs = 0;
  std::uint64_t arrived = 0;
  std::uint64_t refused = 0;
  std::uint64_t contacts = 0;
  std::uint32_t guard_stops = 0;
  double worst_m = 0.0;
  double path_m = 0.0;
  double route_m = 0.0;
  double worst_rad = 0.0;
  double tightest_m = std::numeric_limits<double>::infinity();
};

/// Drives until the robot arrives or has stood without a path for longer than it waits for another.
bool arrives(navigation::TestDrive& drive, Row& row) {
  constexpr double kLongest_s = 600.0;
  constexpr double kRefused_s = 30.0;
  double refused_s = 0.0;
  return drive.run_until(
             [&] {
               const geometry::Velocity& command = drive.command;
               if (command.angular_rad_per_s != 0.0) {
                 row.tightest_m = std::min(
                     row.tightest_m, std::fabs(command.linear_m_per_s / command.angular_rad_per_s));
               }
               const bool refused = drive.halted(navigation::HaltReason::kNoRoute);
               refused_s = refused ? refused_s + navigation::kStep_ns * 1e-9 : 0.0;
               return drive.status().state == navigation::NavigatorState::kArrived ||
                      refused_s > kRefused_s;
             },
             kLongest_s) &&
         drive.status().state == navigation::NavigatorState::kArrived;
}

void drive(Row& row, std::uint64_t run, const navigation::OutlineBase& base, bool verbose) {
  const navigation::OutlineTask task = navigation::draw_outline_task(row.world, run, base);
  navigation::TestDrive drive(row.world, navigation::settings_of(task));
  drive.go_to(task.T_goal.position_m(), task.T_goal.theta_rad);
  const auto began = std::chrono::steady_clock::now();
  const bool arrived = arrives(drive, row);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  ++row.runs;
  row.arrived += arrived ? 1 : 0;
  row.refused += drive.halted(navigation::HaltReason::kNoRoute) ? 1 : 0;
  row.contacts += drive.robot.collisions();
  row.guard_stops += drive.status().guard_stops;
  row.path_m += drive.robot.path_m();
  row.route_m += task.route_m;
  if (arrived) {
    row.worst_m = std::max(row.worst_m, drive.off_m());
    row.worst_rad = std::max(row.worst_rad,
                             std::fabs(geometry::wrap_angle(drive.robot.T_world_robot().theta_rad -
                                                            task.T_goal.theta_rad)));
  }
  if (!verbose && arrived && drive.robot.collisions() == 0) return;
  std::fprintf(
      stderr, "%s, run %llu: %s, %llu contacts, %.0f s, computed in %.1f s\n", row.name.c_str(),
      static_cast<unsigned long long>(run), drive.status().message.c_str(),
      static_cast<unsigned long long>(drive.robot.collisions()), drive.time_s(), took.count());
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Command app("Does a robot that is not round get where it is sent?");
  std::uint64_t runs = 200;
  std::uint64_t first_run = 1;
  bool verbose = false;
  navigation::OutlineBase base;
  app.add_option("--runs", runs, "drives, dealt out to the floors by turns")->capture_default_str();
  app.add_option("--first-run", first_run, "number and seed of the first one")
      ->capture_default_str();
  app.add_option("--radius", base.radius_m,
                 "smallest turning radius of the base, m; 0: on the spot")
      ->capture_default_str();
  app.add_option("--axle", base.axle_m, "distance of its axle behind the middle of the body, m")
      ->capture_default_str();
  app.add_flag("--verbose", verbose, "one line for each drive as it ends");
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    constexpr std::uint64_t kLoopsSeed = 5;
    std::array<Row, 3> rows;
    rows[0] = {"office", world::load_world(TOPOGEO_SOURCE_DIR "/share/worlds/floor.world.yaml")};
    rows[1] = {"warehouse", world::load_world(TOPOGEO_SOURCE_DIR "/share/worlds/hall.world.yaml")};
    rows[2] = {"two loops", simulation::two_loops(kLoopsSeed)};
    for (std::uint64_t run = first_run; run < first_run + runs; ++run) {
      drive(rows.at(run % rows.size()), run, base, verbose);
    }
    std::printf(
        "| floor | drives | arrived | refused | contacts | guard stops | worst end, cm, degrees | "
        "driven / route | tightest turn, m |\n|---|---|---|---|---|---|---|---|---|\n");
    for (const Row& row : rows) {
      std::printf("| %s | %llu | %llu | %llu | %llu | %u | %.1f, %.1f | %.2f | %.3f |\n",
                  row.name.c_str(), static_cast<unsigned long long>(row.runs),
                  static_cast<unsigned long long>(row.arrived),
                  static_cast<unsigned long long>(row.refused),
                  static_cast<unsigned long long>(row.contacts), row.guard_stops,
                  100.0 * row.worst_m, row.worst_rad * 180.0 / std::numbers::pi,
                  row.route_m > 0.0 ? row.path_m / row.route_m : 0.0, row.tightest_m);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_outline_drives: %s\n", error.what());
    return 1;
  }
  return 0;
}
