#include "topogeo/service/log_feed.hpp"

#include <utility>

namespace topogeo::service {
namespace {

using pipeline::OdometrySource;

/// The log from its beginning, by another reader.
pipeline::NextScan read_again(const recording::LogReader& reader) {
  auto again = std::make_shared<recording::LogReader>(reader.from_start());
  return [again] { return again->next(); };
}

}  // namespace

recording::OdometryUse odometry_use(const pipeline::Config& config) {
  switch (config.odometry_source) {
    case OdometrySource::kAuto:
      return recording::OdometryUse::kIfRecorded;
    case OdometrySource::kLaser:
      return recording::OdometryUse::kIgnored;
    case OdometrySource::kRecorded:
      break;
  }
  return recording::OdometryUse::kRequired;
}

std::string why_laser_odometry(const recording::LogReader& reader, const pipeline::Config& config) {
  if (config.odometry_source == OdometrySource::kRecorded) return {};
  if (config.odometry_source == OdometrySource::kLaser) return "odometry.source is laser";
  if (!reader.odometry_fault().empty()) {
    return "none of the log's poses is usable (" + reader.odometry_fault() + ")";
  }
  if (!reader.has_odometry()) return "the log has none";
  if (!pipeline::odometry_stands(read_again(reader))) return {};
  if (!pipeline::laser_moves(read_again(reader), pipeline::laser_odometry(config.local_mapper)))
    return {};
  return "the log's stays at one pose while the scans move";
}

pipeline::ScanFeed scan_feed(recording::LogReader& reader, const pipeline::Config& config,
                             bool from_scans) {
  const pipeline::NextScan next = [&reader] { return reader.next(); };
  if (!from_scans) return pipeline::ScanFeed(next);
  return {next, pipeline::laser_odometry(config.local_mapper)};
}

LogFeed::LogFeed(recording::LogReader reader, const pipeline::Config& config, std::string why_laser)
    : config_(config),
      reader_(std::make_unique<recording::LogReader>(std::move(reader))),
      why_laser_(std::move(why_laser)),
      feed_(scan_feed(*reader_, config_, !why_laser_.empty())) {}

LogFeed::LogFeed(recording::LogReader reader, const pipeline::Config& config)
    : config_(config),
      reader_(std::make_unique<recording::LogReader>(std::move(reader))),
      why_laser_(why_laser_odometry(*reader_, config_)),
      feed_(scan_feed(*reader_, config_, !why_laser_.empty())) {}

LogFeed LogFeed::from_start() const {
  return {reader_->from_start(), config_, why_laser_};
}

}  // namespace topogeo::service
