// Checks that services which run for long do not grow.
//
//   topogeo_soak [--hours H] [--rate R] [--workers N] [--warm-up SHARE] [--csv FILE]
//
// A floor is mapped in one drive and driven there and back in it for H hours of robot time, which
// the services follow R times faster: sensor gateway, local mapper, localizer, map store, planner,
// navigator and N workers, as processes. Samples while they work: resident memory, open files and
// threads of each, shared memory, and the disk space of the results. The first half is warm-up
// (another share with --warm-up), because caches and histories fill. The caches of the workers fill
// last, sooner with less --worker-memory-mb. On a machine too slow for the rate, this program,
// which reads the scans like the services, holds the log up until the localizer has caught up,
// because a queue is no growth. After the warm-up the memory of each service must stay within 5 %
// of its value at the end of the warm-up, plus 1 MB for noise between samples; open files and
// shared memory must not grow at all; and after the end no shared memory of the services may
// remain. Exits with 1 when something grew.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <sys/stat.h>
#include <unistd.h>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/status.h"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/scan/carmen_log_writer.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/supervision/child_process.hpp"
#include "topogeo/world/world.hpp"

namespace {

using namespace topogeo;
using Clock = std::chrono::steady_clock;
using Path = std::filesystem::path;

struct SoakOptions {
  double hours = 1.0;
  std::string rate = "25";
  std::size_t workers = 2;
  std::uint32_t worker_memory_mb = 64;
  double warm_up = 0.5;
  Path csv;
};

/// Resources of a process, from /proc.
struct Usage {
  double rss_mb = 0.0;
  std::size_t files = 0;
  std::size_t threads = 0;
};

struct Footprint {
  double at_s = 0.0;
  std::map<std::string, Usage> services;  // by name
  std::set<Path> shared;                  // of all services
  double disk_mb = 0.0;
};

/// All samples, and the shared memory that remained after the end.
struct Soaked {
  std::vector<Footprint> samples;
  std::set<Path> left;
};

std::size_t entries(const Path& folder) {
  std::error_code gone;
  std::size_t count = 0;
  for (std::filesystem::directory_iterator it(folder, gone), end; !gone && it != end;
       it.increment(gone)) {
    ++count;
  }
  return count;
}

/// Disk space of a file, MB; 0 without the file.
double file_mb(const Path& file) {
  struct stat status {};
  return ::lstat(file.c_str(), &status) == 0 ? static_cast<double>(status.st_blocks) / 2048.0 : 0.0;
}

/// Disk space of the files of a folder, MB.
double space_mb(const Path& folder) {
  std::error_code gone;
  double sum_mb = 0.0;
  for (std::filesystem::recursive_directory_iterator it(folder, gone), end; !gone && it != end;
       it.increment(gone)) {
    sum_mb += file_mb(it->path());
  }
  return sum_mb;
}

/// Adds a process's files of shared memory, without those of other programs.
void add_shared_memory(const std::string& pid, std::set<Path>& files) {
  std::ifstream maps("/proc/" + pid + "/maps");
  for (std::string line; std::getline(maps, line);) {
    const std::size_t at = line.find("/dev/shm/");
    if (at != std::string::npos) files.insert(line.substr(at));
  }
}

Usage usage_of(const std::string& pid) {
  Usage usage;
  std::ifstream status("/proc/" + pid + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) usage.rss_mb = std::stod(line.substr(6)) / 1024.0;
    if (line.starts_with("Threads:")) usage.threads = std::stoul(line.substr(8));
  }
  usage.files = entries("/proc/" + pid + "/fd");
  return usage;
}

/// A tour there and back through the floor for so many hours.
world::World laps_of(world::World world, double hours) {
  const std::vector<Eigen::Vector2d> there = world.tour_m;
  double lap_m = 0.0;
  for (std::size_t i = 1; i < there.size(); ++i) lap_m += 2.0 * (there[i] - there[i - 1]).norm();
  const double path_m = hours * 3600.0 * simulation::SimulationOptions{}.drive.speed_m_per_s;
  world.tour_m.clear();
  for (double driven_m = 0.0; driven_m < path_m; driven_m += lap_m) {
    world.tour_m.insert(world.tour_m.end(), there.begin(), there.end() - 1);
    world.tour_m.insert(world.tour_m.end(), there.rbegin(), there.rend() - 1);
  }
  world.tour_m.push_back(there.front());
  return world;
}

simulation::SimulatedLog drive(const world::World& world, std::uint64_t seed) {
  simulation::SimulationOptions options;
  options.seed = seed;
  options.scan_step_m = 0.5;
  options.scan_step_rad = 20.0 * std::numbers::pi / 180.0;
  return simulation::simulate_log(world, options);
}

/// Writes map and log; returns the robot time of the log.
double prepare(const SoakOptions& options, const Path& work) {
  const world::World world =
      world::load_world(std::string(TOPOGEO_SOURCE_DIR) + "/share/worlds/floor.world.yaml");
  pipeline::MappingRun mapping({}, "robot");
  for (const scan::Scan& scan : drive(world, 1).scans) mapping.add(scan);
  storage::write_map_file(work / "map.pb", mapping.finish());
  const simulation::SimulatedLog log = drive(laps_of(world, options.hours), 2);
  scan::CarmenLogWriter writer(work / "laps.clf");
  for (const scan::Scan& scan : log.scans) writer.write(scan);
  writer.close();
  const double robot_s =
      1e-9 * static_cast<double>(log.scans.back().stamp_ns - log.scans.front().stamp_ns);
  std::printf("%zu scans, %.2f h of robot time\n", log.scans.size(), robot_s / 3600.0);
  std::fflush(stdout);
  return robot_s;
}

messaging::ParticipantOptions own_domain() {
  messaging::ParticipantOptions options;
  options.domain = static_cast<std::uint32_t>(101 + ::getpid() % 99);
  options.partition = "soak-" + std::to_string(::getpid());
  options.name = std::string("soak");
  return options;
}

/// Reads the scans only while the localizer keeps up with the local mapper, by their status: a
/// reader with a full history holds the log up for all.
class Pace {
 public:
  Pace() {
    loop_.add<msg::ServiceStatus>(statuses_, [this](const msg::ServiceStatus& status, const auto&) {
      const std::string service = status.service().to_string();
      for (const msg::Counter& counter : status.counters()) {
        const std::string name = counter.name().to_string();
        if (service == "local_mapper" && name == "local_maps") made_ = counter.value();
        if (service == "localizer" && name == "stops") localized_ = counter.value();
      }
      finished_ |= service == "localizer" && status.state() == msg::kServiceFinished;
    });
  }

  void keep(std::chrono::milliseconds duration) {
    constexpr std::chrono::milliseconds kPeriod{10};  // the history holds 128 scans
    constexpr double kMostBehind = 20.0;              // stops; made of 256 scans
    for (const auto end = Clock::now() + duration; Clock::now() < end;) {
      static_cast<void>(loop_.run_for(kPeriod));
      scans_.take_events([](const messaging::Event&) {});
      if (made_ - localized_ < kMostBehind) scans_.take([](const msg::Scan&, const auto&) {});
    }
  }

  /// The localizer has processed the whole log.
  [[nodiscard]] bool finished() const { return finished_; }

 private:
  messaging::Participant participant_{own_domain()};
  messaging::Reader<msg::ServiceStatus> statuses_{participant_};
  messaging::Reader<msg::Scan> scans_{participant_, {.role = std::string(messaging::kReplayRole)}};
  messaging::EventLoop loop_;
  double made_ = 0.0;
  double localized_ = 0.0;
  bool finished_ = false;
};

/// Starts the services of a robot that follows a finished map; the source of its scans is the last.
std::vector<supervision::ChildProcess> start(const SoakOptions& options, const Path& work) {
  const Path bin = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const std::vector<std::string> common{"--domain", std::to_string(own_domain().domain),
                                        "--partition", own_domain().partition};
  std::vector<supervision::ChildProcess> services;
  const auto add = [&](const std::string& service, std::vector<std::string> words) {
    words.insert(words.end(), common.begin(), common.end());
    const std::string number = std::to_string(services.size());
    services.emplace_back(service, bin / service, words, work / (service + number + ".log"));
  };
  add("map_store", {"--map", work / "map.pb"});
  add("planner", {});
  add("navigator", {});
  for (std::size_t i = 0; i < options.workers; ++i) add("ga_worker", {"--slots", "1"});
  // No --replay, as on a robot: a localizer that reads a log keeps all of its stops.
  add("localizer", {"--map", work / "map.pb", "--wait-workers", std::to_string(options.workers)});
  add("local_mapper", {"--replay"});
  // The readers are the local mapper, the navigator and this program.
  add("sensor_gateway", {"--log", work / "laps.clf", "--rate", options.rate, "--readers", "3"});
  return services;
}

/// Runs until the localizer has processed the whole log.
Soaked run(const SoakOptions& options, const Path& work) {
  Pace pace;
  std::vector<supervision::ChildProcess> services = start(options, work);
  Soaked soaked;
  std::set<Path> shared;
  const Clock::time_point begin = Clock::now();
  constexpr std::chrono::milliseconds kPeriod{100};
  while (!pace.finished()) {
    pace.keep(kPeriod);
    Footprint& sample = soaked.samples.emplace_back();
    sample.at_s = std::chrono::duration<double>(Clock::now() - begin).count();
    for (supervision::ChildProcess& service : services) {
      if (const auto& exit = service.poll()) {
        throw std::runtime_error(service.name() + " " + supervision::describe(*exit) + ": " +
                                 service.last_line());
      }
      std::string name = service.name();
      for (int i = 2; sample.services.contains(name); ++i) {
        name = service.name() + " " + std::to_string(i);
      }
      sample.services[name] = usage_of(std::to_string(service.pid()));
      add_shared_memory(std::to_string(service.pid()), sample.shared);
    }
    shared.insert(sample.shared.begin(), sample.shared.end());
    sample.disk_mb = space_mb(work);
  }
  for (supervision::ChildProcess& service : services) service.send_signal(SIGTERM);
  for (supervision::ChildProcess& service : services) service.wait();
  std::set<Path> own;  // shared memory of this program, where services write to its reader
  add_shared_memory("self", own);
  for (const Path& file : shared) {
    if (std::filesystem::exists(file) && !own.contains(file)) soaked.left.insert(file);
  }
  return soaked;
}

/// Median of a value over some samples.
template <class Value>
double middle(const std::vector<Footprint>& samples, std::size_t first, std::size_t count,
              Value value) {
  std::vector<double> values;
  for (std::size_t i = first; i < std::min(first + count, samples.size()); ++i) {
    values.push_back(value(samples[i]));
  }
  std::sort(values.begin(), values.end());
  return values.at(values.size() / 2);
}

class Report {
 public:
  Report(const std::vector<Footprint>& samples, std::size_t warm)
      : samples_(samples), warm_(warm), few_(std::max<std::size_t>(1, samples.size() / 20)) {}

  /// A row; the value may grow by `share` of itself plus `most` after the warm-up.
  template <class Value>
  void row(const std::string& name, Value value, double share, double most) {
    const Rise rise = rise_of(value);
    judge(name, rise, rise.peak > rise.warm * (1.0 + share) + most);
  }
  /// A row; the value may grow for a while and must return: a service whose input pauses opens a
  /// second participant, for example.
  template <class Value>
  void row_that_goes_back(const std::string& name, Value value) {
    const Rise rise = rise_of(value);
    // A leak goes on. A file that is opened late and once, or two, is none.
    const std::size_t half = warm_ + (samples_.size() - warm_) / 2;
    const double between = middle(samples_, half, few_, value);
    const bool goes_on = between > rise.warm && rise.last > between;
    judge(name, rise, goes_on || rise.last > rise.warm + 2.0);
  }
  [[nodiscard]] bool flat() const { return flat_; }

 private:
  struct Rise {
    double warm;
    double peak;
    double last;
  };

  template <class Value>
  [[nodiscard]] Rise rise_of(Value value) const {
    const double warm = middle(samples_, warm_, few_, value);
    const double last = middle(samples_, samples_.size() - few_, few_, value);
    double peak = 0.0;
    for (std::size_t i = warm_; i + few_ <= samples_.size(); ++i) {
      peak = std::max(peak, middle(samples_, i, few_, value));
    }
    return {warm, peak, last};
  }
  void judge(const std::string& name, const Rise& rise, bool grew) {
    flat_ &= !grew;
    std::printf("| %s | %.1f | %.1f | %.1f | %s |\n", name.c_str(), rise.warm, rise.peak, rise.last,
                grew ? "GREW" : "flat");
  }

  const std::vector<Footprint>& samples_;
  std::size_t warm_;
  std::size_t few_;
  bool flat_ = true;
};

bool report(const std::vector<Footprint>& samples, double warm_up) {
  if (samples.size() < 30) throw std::runtime_error("too short a run to tell: drive longer");
  const auto warm = static_cast<std::size_t>(warm_up * static_cast<double>(samples.size()));
  Report report(samples, warm);
  std::printf("| what | after warm-up | most | at the end | |\n|---|---|---|---|---|\n");
  for (const auto& [name, usage] : samples[warm].services) {
    const auto of = [&name = name](const Footprint& sample) {
      const auto found = sample.services.find(name);
      return found == sample.services.end() ? Usage{} : found->second;
    };
    report.row(
        name + ", memory MB", [&](const Footprint& s) { return of(s).rss_mb; }, 0.05, 1.0);
    report.row_that_goes_back(name + ", open files",
                              [&](const Footprint& s) { return static_cast<double>(of(s).files); });
    report.row_that_goes_back(
        name + ", threads", [&](const Footprint& s) { return static_cast<double>(of(s).threads); });
  }
  report.row(
      "shared memory, files",
      [](const Footprint& s) { return static_cast<double>(s.shared.size()); }, 0.0, 0.0);
  report.row(
      "disk, MB", [](const Footprint& s) { return s.disk_mb; }, 0.05, 1.0);
  return report.flat();
}

void write_csv(const Path& file, const std::vector<Footprint>& samples) {
  std::ofstream out(file);
  out << "at_s,name,rss_mb,files,threads\n";
  for (const Footprint& sample : samples) {
    for (const auto& [name, usage] : sample.services) {
      out << sample.at_s << ',' << name << ',' << usage.rss_mb << ',' << usage.files << ','
          << usage.threads << '\n';
    }
    out << sample.at_s << ",shared memory,," << sample.shared.size() << ",\n";
    out << sample.at_s << ",disk," << sample.disk_mb << ",,\n";
  }
}

bool soak(const SoakOptions& options) {
  const Path work = std::filesystem::temp_directory_path() / ("soak-" + std::to_string(::getpid()));
  std::filesystem::create_directories(work);
  const double robot_s = prepare(options, work);
  const Clock::time_point start = Clock::now();
  const Soaked soaked = run(options, work);
  const std::vector<Footprint>& samples = soaked.samples;
  const double wall_s = std::chrono::duration<double>(Clock::now() - start).count();
  std::printf("%.0f s, %.0f times faster than the robot; %zu samples\n", wall_s, robot_s / wall_s,
              samples.size());
  if (!options.csv.empty()) write_csv(options.csv, samples);
  bool good = report(samples, options.warm_up);
  std::printf("left in shared memory at the end: %zu files\n", soaked.left.size());
  good &= soaked.left.empty();
  if (good) std::filesystem::remove_all(work);
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Command app{"services that run for long: does anything grow?"};
  SoakOptions options;
  app.add_option("--hours", options.hours, "of robot time; a night: 10")
      ->capture_default_str()
      ->check(command_line::range(0.05, 1000.0));
  app.add_option("--rate", options.rate, "times faster than the robot, or lossless")
      ->capture_default_str();
  app.add_option("--workers", options.workers, "search workers")
      ->capture_default_str()
      ->check(command_line::range(0, 16));
  app.add_option("--worker-memory-mb", options.worker_memory_mb, "for the maps of a worker")
      ->capture_default_str()
      ->check(command_line::range(std::uint32_t{4}, std::uint32_t{1024}));
  app.add_option("--warm-up", options.warm_up, "share of the run after which nothing may grow")
      ->capture_default_str()
      ->check(command_line::range(0.1, 0.9));
  app.add_option("--csv", options.csv, "write all samples there");
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    return soak(options) ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_soak: %s\n", error.what());
    return 2;
  }
}
