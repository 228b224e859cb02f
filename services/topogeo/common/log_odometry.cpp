#include "common/log_odometry.hpp"

#include <exception>
#include <iostream>
#include <string>

#include "topogeo/service/log_feed.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/format.hpp"

#include "common/configuration.hpp"

namespace topogeo::cli {

JobOptions without_odometry(const JobOptions& options) {
  JobOptions job = options;
  job.topics.odometry_use = service::odometry_use(load(options.config).config);
  return job;
}

pipeline::ScanFeed open_feed(Job& job) {
  const pipeline::Config& config = job.inputs.config.config;
  std::string why;
  try {
    why = service::why_laser_odometry(job.reader, config);
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
  if (!why.empty()) {
    std::cerr << "topogeo: odometry from the scans: " << why << '\n';
    if (!job.options.topics.upside_down) {
      std::cerr
          << "topogeo: scans alone do not show whether their beams are reversed: if the map is "
             "a mirror image of the building, expected --upside-down\n";
    }
  }
  return service::scan_feed(job.reader, config, !why.empty());
}

pipeline::ScanFeed open_feed_again(Job& job, const pipeline::ScanFeed& first) {
  const pipeline::Config& config = job.inputs.config.config;
  const bool from_scans =
      first.laser_counts() != nullptr || config.odometry_source == pipeline::OdometrySource::kLaser;
  return service::scan_feed(job.reader, config, from_scans);
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
  if (counts->unseen > 0) {
    std::cerr << fmt::format(
        "topogeo: {} of {} scans are left out: for too long they see only bare walls, which do not "
        "show how far the robot drives\n",
        counts->unseen, counts->scans);
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
  report.laser_odometry = {counts->unplaced + counts->unseen, counts->breaks,
                           pipeline::usual_step_m(*counts)};
}

}  // namespace topogeo::cli
