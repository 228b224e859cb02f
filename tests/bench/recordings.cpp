#include "recordings.hpp"

#include <cstdlib>
#include <filesystem>
#include <utility>

#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/storage/tum.hpp"

namespace topogeo::bench {
namespace {

std::string stem(const std::string& file) {
  const std::string name = std::filesystem::path(file).filename().string();
  return name.substr(0, name.find('.'));
}

}  // namespace

Recording simulated(const std::string& world_file) {
  simulation::SimulatedLog log = simulation::simulate_log(world::load_world(world_file), {});
  Recording recording{stem(world_file), std::move(log.scans), {}};
  recording.T_world_robot.assign(log.T_world_robot.begin(), log.T_world_robot.end());
  return recording;
}

Recording recorded(const std::string& log_file, const std::string& reference_file,
                   const scan::CarmenLogOptions& options) {
  constexpr std::int64_t kApart_ns = 1'000'000;
  const auto truth = storage::read_trajectory_tum(reference_file);
  scan::CarmenLogReader reader(log_file, options);
  Recording recording{stem(log_file), {}, {}};
  std::size_t next = 0;
  while (auto scan = reader.next()) {
    while (next < truth.size() && truth[next].stamp_ns < scan->stamp_ns - kApart_ns) ++next;
    const bool known =
        next < truth.size() && std::abs(truth[next].stamp_ns - scan->stamp_ns) <= kApart_ns;
    recording.T_world_robot.push_back(known ? std::optional(truth[next].pose) : std::nullopt);
    recording.scans.push_back(std::move(*scan));
  }
  return recording;
}

Recording thinned(const Recording& recording, std::size_t every) {
  Recording kept{recording.name + "/" + std::to_string(every), {}, {}};
  for (std::size_t i = 0; i < recording.scans.size(); i += every) {
    kept.scans.push_back(recording.scans[i]);
    kept.T_world_robot.push_back(recording.T_world_robot[i]);
  }
  return kept;
}

}  // namespace topogeo::bench
