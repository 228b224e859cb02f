// Maps a recording and measures its loops.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/loop_recall.hpp"
#include "topogeo/pipeline/trajectory_error.hpp"

#include "covariance_checks.hpp"
#include "loop_reliability.hpp"
#include "recordings.hpp"

namespace topogeo::bench {

struct LoopFigures {
  std::string name;
  std::size_t stops = 0;
  pipeline::TrajectoryError error;
  std::optional<pipeline::RelationsError> relations;
  pipeline::LoopRecall recall;
  MeanSquaredDistance triangles;
  MeanSquaredDistance predictions;
  std::vector<JudgedDecision> decisions;
  std::uint64_t match_tasks = 0;
  double cpu_s = 0.0;
};

/// `relations`: the file of hand-checked relative poses, may be empty. Throws std::runtime_error
/// and std::invalid_argument for files that cannot be used.
LoopFigures measure_loops(const Recording& recording, const pipeline::Config& config,
                          const std::optional<std::filesystem::path>& relations);

}  // namespace topogeo::bench
