// Cost of the bridge to ROS 2: time from a ROS scan to ours, CPU time while it passes scans on,
// time until a late reader has a large map. Starts ros_bridge and plays both sides; prints three
// lines.
//
//   topogeo_ros_bridge_bench PATH_OF_ROS_BRIDGE [SECONDS]
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/plain_participant.hpp"
#include "topogeo/msg/hybrid_map.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/ros_messaging/topic.hpp"
#include "topogeo/support/format.hpp"

#include "sample_quantile.hpp"

namespace {

using namespace topogeo;  // NOLINT(google-build-using-namespace)
using Clock = std::chrono::steady_clock;
using messaging::SampleInfo;
using std::chrono::milliseconds;

constexpr std::uint32_t kDomain = 97;
constexpr const char* kPartition = "ros-bridge-bench";
constexpr double kRate_hz = 40.0;
constexpr std::size_t kBeams = 1080;
constexpr std::uint32_t kMapCells = 4000;

messaging::Participant join(const std::string& profile) {
  messaging::ParticipantOptions options;
  options.domain = kDomain;
  options.partition = kPartition;
  options.profile = profile;
  return messaging::Participant(options);
}

ros::Header header(const std::string& frame, std::int64_t stamp_ns) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  ros::Header header;
  header.frame_id_(frame);
  header.stamp_().sec_(static_cast<std::int32_t>(stamp_ns / kSecond_ns));
  header.stamp_().nanosec_(static_cast<std::uint32_t>(stamp_ns % kSecond_ns));
  return header;
}

/// User and system CPU time of a process, s.
double cpu_s(pid_t pid) {
  std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
  std::string word;
  double ticks = 0.0;
  constexpr int kUserTime = 14;
  for (int field = 1; field <= kUserTime + 1 && stat >> word; ++field) {
    if (field >= kUserTime) ticks += std::stod(word);
  }
  return ticks / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

class Bridge {
 public:
  explicit Bridge(const std::string& program) {
    std::vector<std::string> words = {
        program,    "--domain",     std::to_string(kDomain), "--partition",
        kPartition, "--ros-domain", std::to_string(kDomain), "--log-level",
        "error"};
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    if (::posix_spawn(&pid_, program.c_str(), nullptr, nullptr, arguments.data(), environ) != 0) {
      throw std::runtime_error(program + " cannot be started");
    }
  }
  Bridge(const Bridge&) = delete;
  Bridge& operator=(const Bridge&) = delete;
  ~Bridge() {
    ::kill(pid_, SIGTERM);
    ::waitpid(pid_, nullptr, 0);
  }
  [[nodiscard]] pid_t pid() const { return pid_; }

 private:
  pid_t pid_ = -1;
};

void measure_scans(const Bridge& bridge, double seconds) {
  const messaging::Participant ros_side = join(messaging::kRosProfile);
  const messaging::Participant our_side = join("");
  messaging::EventLoop loop;
  messaging::Writer<ros::LaserScan> scans(ros_side, ros::Topic{"/scan", ros::Qos::kReliable});
  messaging::Writer<ros::Odometry> odometry(ros_side, ros::Topic{"/odom", ros::Qos::kReliable});
  messaging::Writer<ros::TFMessage> frames(ros_side, ros::Topic{"/tf_static", ros::Qos::kLatched});
  const messaging::Reader<msg::Scan> reader(our_side);
  ros::TFMessage mounting;
  mounting.transforms_().emplace_back();
  mounting.transforms_()[0].header_(header("base_link", 0));
  mounting.transforms_()[0].child_frame_id_("laser");
  mounting.transforms_()[0].transform_().rotation_().w_(1.0);
  if (!frames.write(mounting)) throw std::runtime_error("/tf_static was not sent");

  std::map<std::int64_t, Clock::time_point> sent;
  std::vector<double> latencies_ms;
  loop.add<msg::Scan>(reader, [&](const msg::Scan& scan, const SampleInfo&) {
    const auto at = sent.find(scan.stamp_ns());
    if (at == sent.end()) return;
    latencies_ms.push_back(
        std::chrono::duration<double, std::milli>(Clock::now() - at->second).count());
  });
  while (scans.matched() == 0 || odometry.matched() == 0 || reader.matched() == 0) {
    loop.run_for(milliseconds(10));
  }
  ros::LaserScan scan;
  scan.angle_min_(static_cast<float>(-0.75 * std::numbers::pi));
  scan.angle_increment_(static_cast<float>(1.5 * std::numbers::pi / kBeams));
  scan.range_min_(0.1F);
  scan.range_max_(30.0F);
  std::int64_t stamp_ns = 1'000'000'000'000;
  double first_cpu_s = 0.0;
  const auto start = Clock::now();
  const int warm_up = static_cast<int>(2.0 * kRate_hz);
  const int count = static_cast<int>(seconds * kRate_hz);
  for (int i = 0; i < warm_up + count; ++i) {
    if (i == warm_up) {
      first_cpu_s = cpu_s(bridge.pid());
      sent.clear();
      latencies_ms.clear();
    }
    stamp_ns += static_cast<std::int64_t>(1e9 / kRate_hz);
    ros::Odometry pose;
    pose.header_(header("odom", stamp_ns));
    pose.child_frame_id_("base_link");
    pose.pose_().pose_().orientation_().w_(1.0);
    if (!odometry.write(pose)) throw std::runtime_error("/odom was not sent");
    scan.header_(header("laser", stamp_ns));
    scan.ranges_().assign(kBeams, 2.0F + 0.001F * static_cast<float>(i % 100));
    sent[stamp_ns] = Clock::now();
    if (!scans.write(scan)) throw std::runtime_error("/scan was not sent");
    const auto next = start + std::chrono::duration_cast<Clock::duration>(
                                  std::chrono::duration<double>((i + 1) / kRate_hz));
    while (Clock::now() < next) loop.run_for(next - Clock::now());
  }
  const double used_s = cpu_s(bridge.pid()) - first_cpu_s;
  std::cout << fmt::format(
      "/scan to ours, {} beams at {:.0f} Hz: {} of {} came, median {:.2f} ms, 99 % {:.2f} ms\n"
      "CPU of the bridge: {:.1f} % of a core\n",
      kBeams, kRate_hz, latencies_ms.size(), count, bench::sample_quantile(latencies_ms, 0.5),
      bench::sample_quantile(latencies_ms, 0.99), 100.0 * used_s / seconds);
}

void measure_map() {
  const messaging::Participant our_side = join("");
  messaging::Writer<msg::GridTile> tiles(our_side);
  messaging::Writer<msg::HybridMap> summaries(our_side);
  const std::uint32_t across = (kMapCells + msg::kTileCells - 1) / msg::kTileCells;
  msg::HybridMap summary;
  messaging::set_header(summary, "robot", 0, 0);
  summary.version(1);
  summary.columns(kMapCells);
  summary.rows(kMapCells);
  summary.resolution_m(0.05);
  summary.tile_versions().assign(static_cast<std::size_t>(across) * across, 1);
  for (std::uint32_t i = 0; i < across * across; ++i) {
    msg::GridTile tile;
    messaging::set_header(tile, "robot", 0, i);
    tile.tile(i);
    tile.version(1);
    tile.states().assign(msg::kTileArea, static_cast<std::uint8_t>(i % 3));
    tile.zones().assign(msg::kTileArea, msg::kNoZone);
    while (!tiles.write(tile)) {
    }
  }
  while (!summaries.write(summary)) {
  }
  const auto has_map = [](double patience_s) -> std::optional<double> {
    const auto start = Clock::now();
    const messaging::Participant late = join(messaging::kRosProfile);
    const messaging::Reader<ros::OccupancyGrid> reader(late,
                                                       ros::Topic{"/map", ros::Qos::kLatched});
    messaging::EventLoop loop;
    std::optional<double> took_s;
    loop.add<ros::OccupancyGrid>(reader, [&](const ros::OccupancyGrid& grid, const SampleInfo&) {
      if (grid.data_().size() != static_cast<std::size_t>(kMapCells) * kMapCells) return;
      took_s = std::chrono::duration<double>(Clock::now() - start).count();
      loop.stop();
    });
    loop.run_for(std::chrono::duration_cast<std::chrono::nanoseconds>(
        std::chrono::duration<double>(patience_s)));
    return took_s;
  };
  constexpr double kFirst_s = 60.0;
  if (!has_map(kFirst_s)) throw std::runtime_error("no map came");
  std::vector<double> took_s;
  took_s.reserve(5);
  for (int i = 0; i < 5; ++i) took_s.push_back(has_map(kFirst_s).value_or(kFirst_s));
  std::cout << fmt::format(
      "/map of {0} x {0} cells to a late reader: median {1:.2f} s, most {2:.2f} s\n", kMapCells,
      bench::sample_quantile(took_s, 0.5), *std::ranges::max_element(took_s));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc < 2 || argc > 3) throw std::runtime_error("expected PATH_OF_ROS_BRIDGE [SECONDS]");
    const Bridge bridge(argv[1]);
    measure_scans(bridge, argc == 3 ? std::stod(argv[2]) : 20.0);
    measure_map();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "topogeo_ros_bridge_bench: " << error.what() << '\n';
    return 1;
  }
}
