// Odometry of the log that a command maps: the log's, or from its scans.
#pragma once

#include "topogeo/pipeline/scan_feed.hpp"
#include "topogeo/storage/report.hpp"

#include "common/job.hpp"

namespace topogeo::cli {

/// The options for prepare() of a command that can do without odometry, by `odometry.source` of the
/// configuration. Throws service::UsageError for a configuration that cannot be used.
JobOptions without_odometry(const JobOptions& options);

/// The scans of the job, whose reader must outlive the feed. Reports on stderr if their odometry is
/// from the scans. Throws service::BadInputError when the log cannot be read.
pipeline::ScanFeed open_feed(Job& job);

/// The same for another job with the same log: with odometry from the scans if its configuration
/// asks for that, else with that of the first feed.
pipeline::ScanFeed open_feed_again(Job& job, const pipeline::ScanFeed& first);

/// Reports on stderr what became of odometry from the scans, once the log is read. Throws
/// service::BadInputError if the scans are too sparse for it.
void check_tracked(const JobOptions& options, const pipeline::ScanFeed& feed);

/// Adds the counts of odometry from the scans to a report.
void add_odometry(storage::Report& report, const pipeline::ScanFeed& feed);

}  // namespace topogeo::cli
