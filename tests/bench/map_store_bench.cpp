// The map store on a large map: 10,000 local maps along a path through a building, a global map of
// 100,000 branch points, all of it made up. Prints the cost of storing, starting, a snapshot and a
// loop that moves everything, the size of the file and the memory of the process.
//
//   topogeo_map_store_bench [LOCAL_MAPS [insert|serve]]
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/storage/map_database.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/random.hpp"

#include "map_store/live_map.hpp"
#include "map_store/map_archive.hpp"
#include "map_store/map_input.hpp"
#include "process_memory.hpp"

using namespace topogeo;  // NOLINT(google-build-using-namespace)

namespace {

constexpr std::uint64_t kBenchSession = 77;
constexpr int kScanPoints = 361;
constexpr int kBranchPoints = 10;
constexpr int kTrackedScans = 4;
constexpr std::size_t kRow = 100;  // stops of a corridor, 1 m apart; corridors 4 m apart

geometry::Pose2 place_of(std::size_t i) {
  const std::size_t row = i / kRow;
  const std::size_t step = row % 2 == 0 ? i % kRow : kRow - 1 - i % kRow;
  return {static_cast<double>(step), 4.0 * static_cast<double>(row), 0.0};
}

topomap::LocalMap local_map(std::uint32_t i, support::Random& random) {
  topomap::LocalMap map;
  map.robot_id = "robot";
  map.id = i;
  map.stop = {kBenchSession, i};
  map.sequence = 5 * std::uint64_t{i};
  map.stamp_ns = 1'000'000'000LL * i;
  map.T_odom_robot = place_of(i);
  const auto noise = [&] { return random.uniform(-0.01, 0.01); };
  for (int side = 0; side < 2; ++side) {
    map.nodes.push_back({static_cast<std::uint32_t>(side),
                         topomap::NodeKind::kFictitious,
                         {side - 0.5, noise()},
                         1.0,
                         {1, 2},
                         true});
  }
  topomap::LocalBranch branch{0, 0, 1, {1, 2}, false, true, true, {}};
  for (int p = 0; p < kBranchPoints; ++p) {
    branch.points.push_back({{-0.5 + p / (kBranchPoints - 1.0), noise()}, 1.0 + noise()});
  }
  map.branches.push_back(branch);
  for (int p = 0; p < kScanPoints; ++p) {
    map.points.push_back({static_cast<float>(random.uniform(-4.0, 4.0)),
                          static_cast<float>(p % 2 == 0 ? 1.0 : -1.0)});
  }
  for (int t = 0; t < kTrackedScans; ++t) {
    map.track.push_back({map.sequence - 1, map.stamp_ns - 1, place_of(i), {0.2 * t, 0, 0}, true});
  }
  return map;
}

/// A node for each stop and a branch to the next one.
topomap::GlobalMap global_map(std::size_t stops, double shift_m, std::uint64_t version) {
  topomap::GlobalMap map;
  map.version = version;
  for (std::size_t i = 0; i < stops; ++i) {
    const auto id = static_cast<std::uint32_t>(i);
    const geometry::Pose2 at = place_of(i);
    map.nodes.push_back({id, topomap::NodeKind::kDoor, {at.x_m + shift_m, at.y_m}, 1.0, 3});
    topomap::MapBranch branch{id, id, static_cast<std::uint32_t>((i + 1) % stops), false, 2, {}};
    for (int p = 0; p < kBranchPoints; ++p) {
      branch.points.push_back({{at.x_m + shift_m + 0.1 * p, at.y_m}, 1.0});
    }
    map.branches.push_back(std::move(branch));
  }
  return map;
}

topomap::Trajectory trajectory(std::size_t stops, double shift_m, std::uint64_t version) {
  topomap::Trajectory out;
  out.version = version;
  for (std::size_t i = 0; i < stops; ++i) {
    geometry::Pose2 pose = place_of(i);
    pose.x_m += shift_m;
    out.stops.push_back({static_cast<std::uint32_t>(i),
                         1'000'000'000LL * static_cast<int>(i),
                         pose,
                         Eigen::Matrix3d::Identity(),
                         {kBenchSession, static_cast<std::uint32_t>(i)}});
  }
  return out;
}

double seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void print(const std::string& what, double value, const char* unit, const char* target) {
  std::cout << fmt::format("{:52} {:9.2f} {:10} target {}\n", what, value, unit, target)
            << std::flush;
}

/// Memory of a running map store.
struct Running {
  explicit Running(const std::filesystem::path& path)
      : archive(storage::MapDatabase::open_existing(path), path) {
    storage::MapDocument document = archive.database().load();
    input = map_store::MapInput(
        map_store::MapInput::Stored{.local_maps = std::move(document.local_maps),
                                    .trajectory = std::move(document.trajectory),
                                    .closures = std::move(document.loop_closures)});
  }
  map_store::MapArchive archive;
  map_store::MapInput input;
};

void insert(const std::filesystem::path& path, std::uint32_t count) {
  support::Random random(1);
  map_store::MapArchive archive(storage::MapDatabase::open_or_create(path, "robot", 1), path);
  std::vector<topomap::LocalMap> maps;
  for (std::uint32_t i = 0; i < count; ++i) maps.push_back(local_map(i, random));
  const topomap::Trajectory poses = trajectory(count, 0.0, 1);
  double stored_s = 0.0;
  double joined_s = 0.0;
  for (std::size_t begin = 0; begin < count; begin += map_store::MapArchive::kBatch) {
    const std::size_t end = std::min<std::size_t>(begin + map_store::MapArchive::kBatch, count);
    stored_s += seconds([&] {
      for (std::size_t i = begin; i < end; ++i) archive.add(maps[i]);
      static_cast<void>(archive.flush());
    });
    topomap::Trajectory part{
        end, {poses.stops.begin(), poses.stops.begin() + static_cast<std::ptrdiff_t>(end)}};
    joined_s += seconds([&] { archive.put(std::span(maps).first(end), part, {}); });
  }
  print("local maps stored, each batch forced to the disk", count / stored_s, "maps/s", ">= 500");
  print("  and joined to a growing trajectory", count / (stored_s + joined_s), "maps/s", ">= 500");
  archive.put(global_map(count, 0.0, count));
  map_store::LiveMap live({});
  const double fuse_s = seconds([&] {
    while (live.step(maps, poses.stops)) {
    }
  });
  print("all local maps fused once (work on the live map)", fuse_s, "s", "-");
}

/// Runs in a process of its own, so that its memory is that of a map store.
void serve(const std::filesystem::path& path, std::uint32_t count) {
  std::optional<Running> running;
  const double start_s = seconds([&] { running.emplace(path); });
  print("start: file checked, map read", start_s, "s", "<= 2");
  std::size_t bytes = 0;
  const double snapshot_s = seconds([&] {
    running->archive.database().write_map_file(
        [&](std::string_view piece) { bytes += piece.size(); });
  });
  print("full snapshot", snapshot_s, "s", "<= 2");
  print("  its size", static_cast<double>(bytes) / 1e6, "MB", "-");
  const topomap::Trajectory moved = trajectory(count, 0.5, count + 1);
  const double poses_s =
      seconds([&] { running->archive.put(running->input.local_maps(), moved, {}); });
  const topomap::GlobalMap map = global_map(count, 0.5, count + 1);
  const double map_s = seconds([&] { running->archive.put(map); });
  print("a loop that moves everything: poses stored", poses_s, "s", "");
  print("  and the whole global map", poses_s + map_s, "s", "<= 3");
  print("largest memory", bench::largest_memory_mb(), "MB", "<= 300");
  running.reset();
  print("file", static_cast<double>(std::filesystem::file_size(path)) / 1e6, "MB", "<= 200");
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const auto count = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 10000);
    const std::string part = argc > 2 ? argv[2] : "";
    const std::filesystem::path directory =
        std::filesystem::temp_directory_path() / "topogeo_map_store_bench";
    const std::filesystem::path path = directory / "map.sqlite";
    if (part == "serve") {
      serve(path, count);
      std::filesystem::remove_all(directory);
      return 0;
    }
    std::filesystem::remove_all(directory);
    std::filesystem::create_directories(directory);
    insert(path, count);
    if (part == "insert") return 0;  // the file stays, for a map store to start with
    const std::string again = std::string(argv[0]) + " " + std::to_string(count) + " serve";
    return std::system(again.c_str()) == 0 ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
