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

/// The scans of another job with the same log. Their odometry is from the scans if the
/// configuration of that job requires it, else that of the first feed.
pipeline::ScanFeed open_feed_again(Job& job, const pipeline::ScanFeed& first);

/// Reports the result of odometry from the scans on stderr, once the log is read. Throws
/// service::BadInputError if the scans are too sparse for it.
void check_tracked(const JobOptions& options, const pipeline::ScanFeed& feed);

/// Adds the counts of odometry from the scans to a report.
void add_odometry(storage::Report& report, const pipeline::ScanFeed& feed);

}  // namespace topogeo::cli
