#include "common/log_odometry.hpp"

#include <exception>
#include <iostream>
#include <memory>
#include <string>

#include "topogeo/service/service_options.hpp"
#include "topogeo/support/format.hpp"

#include "common/configuration.hpp"

namespace topogeo::cli {
namespace {

using pipeline::OdometrySource;

localization::LaserOdometry laser_odometry(const pipeline::Config& config) {
  return {config.local_mapper.T_robot_laser, config.local_mapper.local_map.points_range_m};
}

/// The log from its beginning, by another reader.
pipeline::NextScan read_again(const Job& job) {
  auto reader = std::make_shared<recording::LogReader>(job.reader.from_start());
  return [reader] { return reader->next(); };
}

/// Why odometry is from the scans; empty if it is the log's.
std::string why_laser(const Job& job) {
  const pipeline::Config& config = job.inputs.config.config;
  if (config.odometry_source == OdometrySource::kRecorded) return {};
  if (config.odometry_source == OdometrySource::kLaser) return "odometry.source is laser";
  if (!job.reader.has_odometry()) return "the log has none";
  if (!pipeline::odometry_stands(read_again(job))) return {};
  if (!pipeline::laser_moves(read_again(job), laser_odometry(config))) return {};
  return "the log's stays at one pose while the scans move";
}

}  // namespace

JobOptions without_odometry(const JobOptions& options) {
  JobOptions job = options;
  switch (load(options.config).config.odometry_source) {
    case OdometrySource::kRecorded:
      break;
    case OdometrySource::kAuto:
      job.topics.odometry_use = recording::OdometryUse::kIfRecorded;
      break;
    case OdometrySource::kLaser:
      job.topics.odometry_use = recording::OdometryUse::kIgnored;
      break;
  }
  return job;
}

pipeline::ScanFeed open_feed(Job& job) {
  const pipeline::NextScan next = [&job] { return job.reader.next(); };
  std::string why;
  try {
    why = why_laser(job);
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
  if (why.empty()) return pipeline::ScanFeed(next);
  std::cerr << "topogeo: odometry from the scans: " << why << '\n';
  return {next, laser_odometry(job.inputs.config.config)};
}

pipeline::ScanFeed open_feed_again(Job& job, const pipeline::ScanFeed& first) {
  const pipeline::NextScan next = [&job] { return job.reader.next(); };
  const pipeline::Config& config = job.inputs.config.config;
  if (first.laser_counts() == nullptr && config.odometry_source != OdometrySource::kLaser) {
    return pipeline::ScanFeed(next);
  }
  return {next, laser_odometry(config)};
}

void check_tracked(const JobOptions& options, const pipeline::ScanFeed& feed) {
  const localization::LaserOdometryCounts* counts = feed.laser_counts();
  if (counts == nullptr) return;
  const std::string sparse = pipeline::too_sparse(*counts);
  if (!sparse.empty()) throw service::BadInputError(options.log.string() + ": " + sparse);
  if (counts->unplaced > 0) {
    std::cerr << fmt::format("topogeo: {} of {} scans are left out: they match no others\n",
                             counts->unplaced, counts->scans);
  }
  if (counts->breaks > 0) {
    std::cerr << fmt::format(
        "topogeo: the scans lose their track {} times: the place is found again by the scans\n",
        counts->breaks);
  }
  // Dense logs lose it at most twice in a thousand scans (docs/decisions/laser_odometry.md).
  constexpr std::uint64_t kOften = 100;
  if (counts->breaks * kOften > counts->scans) {
    std::cerr << "topogeo: warning: a track that is lost so often also goes wrong unnoticed: "
                 "parts of the map may be in a wrong place\n";
  }
}

void add_odometry(storage::Report& report, const pipeline::ScanFeed& feed) {
  const localization::LaserOdometryCounts* counts = feed.laser_counts();
  if (counts == nullptr) return;
  report.laser_odometry = {counts->unplaced, counts->breaks, pipeline::usual_step_m(*counts)};
}

}  // namespace topogeo::cli
