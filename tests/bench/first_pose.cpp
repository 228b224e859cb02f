// Time from the start of all services to the first pose of the robot.
//
//   topogeo_first_pose [--runs N]
//
// Starts `topogeo run --sim` (simulator with emulated laser and base, gateway, local mapper,
// localizer, map store, planner, a worker), the same with `--explore` (and the navigator) and,
// without a simulator, `topogeo run --log` of a drive through the same floor, each from the
// beginning, and reads the topic of the pose.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/msg/trajectory.h"
#include "topogeo/scan/carmen_log_writer.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/supervision/child_process.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/world/world.hpp"

namespace {

using namespace topogeo;
using Clock = std::chrono::steady_clock;
using Path = std::filesystem::path;

/// Seconds from the start of the program to the first pose; then ends the program.
double seconds_to_pose(const std::vector<std::string>& arguments, const Path& work,
                       std::uint32_t domain) {
  messaging::ParticipantOptions options;
  options.domain = domain;
  options.partition = std::string(messaging::kAnyPartition);
  options.name = std::string("first_pose");
  const messaging::Participant participant(options);
  messaging::Reader<msg::LivePose> poses(participant);
  messaging::EventLoop loop;
  std::optional<Clock::time_point> came;
  loop.add<msg::LivePose>(poses, [&](const msg::LivePose&, const auto&) {
    if (!came) came = Clock::now();
    loop.stop();
  });
  const Path bin = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const Clock::time_point start = Clock::now();
  supervision::ChildProcess run("run", bin / "topogeo", arguments, work / "run.log");
  constexpr std::chrono::seconds kPatience{60};
  static_cast<void>(loop.run_for(kPatience));
  run.send_signal(SIGTERM);
  run.wait();
  if (!came) throw std::runtime_error(fmt::format("no pose in a minute: {}", run.last_line()));
  return std::chrono::duration<double>(*came - start).count();
}

void measure(std::size_t runs) {
  const Path work =
      std::filesystem::temp_directory_path() / fmt::format("first-pose-{}", ::getpid());
  std::filesystem::create_directories(work);
  const std::string world = TOPOGEO_SOURCE_DIR "/share/worlds/floor.world.yaml";
  {
    scan::CarmenLogWriter writer(work / "floor.clf");
    for (const scan::Scan& scan : simulation::simulate_log(world::load_world(world), {}).scans) {
      writer.write(scan);
    }
    writer.close();
  }
  const auto domain = static_cast<std::uint32_t>(100 + ::getpid() % 100);
  std::printf(
      "| start | runs | first pose after s, median | least | most |\n|---|---|---|---|---|\n");
  const std::vector<std::pair<const char*, std::vector<std::string>>> starts = {
      {"--log", {"--log", work / "floor.clf", "--rate", "realtime"}},
      {"--sim, with emulated devices", {"--sim", world}},
      {"--sim --explore, the navigator, too", {"--sim", world, "--explore"}}};
  for (const auto& [name, source] : starts) {
    std::vector<double> times_s;
    for (std::size_t i = 0; i < runs; ++i) {
      std::vector<std::string> arguments{"run", "--out",    work / "out",          "--workers",
                                         "1",   "--domain", std::to_string(domain)};
      arguments.insert(arguments.end(), source.begin(), source.end());
      times_s.push_back(seconds_to_pose(arguments, work, domain));
      std::filesystem::remove_all(work / "out");
    }
    std::sort(times_s.begin(), times_s.end());
    std::printf("| topogeo run %s | %zu | %.2f | %.2f | %.2f |\n", name, runs,
                times_s[times_s.size() / 2], times_s.front(), times_s.back());
    std::fflush(stdout);
  }
  std::filesystem::remove_all(work);
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Command app{"from the start of all services to the first pose"};
  std::size_t runs = 5;
  app.add_option("--runs", runs, "of each way to start")
      ->capture_default_str()
      ->check(command_line::range(1, 1000));
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    measure(runs);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_first_pose: %s\n", error.what());
    return 1;
  }
  return 0;
}
