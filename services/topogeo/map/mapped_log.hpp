// Maps a log in this process: once, and again with other settings where the map is poor.
#pragma once

#include <memory>
#include <optional>

#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/pipeline/scan_feed.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/storage/report.hpp"
#include "topogeo/support/cpu_time.hpp"

#include "common/job.hpp"
#include "map/interruption.hpp"

namespace topogeo::cli {

/// A map of a log, and the settings that made it.
struct MappedLog {
  std::unique_ptr<Job> job;
  std::unique_ptr<pipeline::ScanFeed> feed;
  std::unique_ptr<pipeline::MappingRun> run;
  storage::MapDocument document;
  storage::Report report;  ///< with the quality of a new map, without times
  support::StageTimes times;
};

/// Maps the log of a job once; empty after a signal. Reports progress and skipped scans on stderr.
/// Throws service::BadInputError if the log cannot be used.
std::optional<MappedLog> map_log_once(Job job, Interruption& interruption);

/// The best of a map and of others that the remedies for a poor map give (results::Remedy), each
/// with a line on stderr; empty after a signal. Values that the configuration file sets stay as
/// they are.
std::optional<MappedLog> improved(MappedLog mapped, Interruption& interruption);

}  // namespace topogeo::cli
