#include "map/mapped_log.hpp"

#include <cstdint>
#include <iostream>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/calibration/odometry_calibration.hpp"
#include "topogeo/results/outputs.hpp"
#include "topogeo/results/stages.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/progress_bar.hpp"

#include "calibrate/calibration_log.hpp"
#include "common/log_odometry.hpp"

namespace topogeo::cli {
namespace {

using results::Remedy;

/// Takes all scans of the log; false after a signal.
bool add_scans(MappedLog& mapped, const Interruption& interruption) {
  support::ProgressBar bar(std::cerr, support::stderr_is_terminal(), "mapping", "scans");
  const double start_s = support::monotonic_s();
  std::uint64_t done = 0;
  while (interruption.received() == 0) {
    std::optional<scan::Scan> scan;
    {
      const auto scope = mapped.times.measure("reading");
      scan = mapped.feed->next();
    }
    if (!scan) {
      bar.finish(done, done, support::monotonic_s() - start_s);
      return true;
    }
    mapped.run->add(*scan);
    bar.update(++done, mapped.job->laser_lines, support::monotonic_s() - start_s);
  }
  bar.finish(done, mapped.job->laser_lines, support::monotonic_s() - start_s);
  std::cerr << "topogeo: stopped, nothing was written\n";
  return false;
}

void judge(storage::Report& report, const MappedLog& mapped, const std::set<Remedy>& tried) {
  const localization::MappingSession* session = mapped.run->session();
  add_quality(report, *mapped.job, mapped.document,
              {session == nullptr ? 0 : session->waiting_stops(), tried});
}

storage::Report make_report(const MappedLog& mapped) {
  const Job& job = *mapped.job;
  const pipeline::MappingRun& run = *mapped.run;
  storage::Report report;
  report.command = run.map_tracker() != nullptr ? "localize" : "map";
  report.log = job.options.log.filename().string();
  report.configuration = job.inputs.config.effective;
  results::add_map(report, mapped.document);
  results::add_matches(report, run.match_counts());
  results::add_loop_candidates(report, run.loop_decisions());
  results::add_log(report, job.reader.statistics());
  add_odometry(report, *mapped.feed);
  add_mounting(report, job.inputs);
  judge(report, mapped, {});
  if (run.map_tracker() != nullptr) {
    report.localization = pipeline::localization_counts(*run.map_tracker());
  }
  if (job.inputs.continued) report.continuation = pipeline::continuation_counts(*run.session());
  return report;
}

std::unique_ptr<pipeline::MappingRun> make_run(const Job& job) {
  const JobOptions& options = job.options;
  std::optional<geometry::Pose2> initial_pose;
  if (options.initial_pose) initial_pose = pipeline::parse_pose(*options.initial_pose);
  if (job.inputs.continued) {
    return std::make_unique<pipeline::MappingRun>(job.inputs.config.config, options.robot_id,
                                                  job.inputs.continued, initial_pose);
  }
  if (!job.inputs.map)
    return std::make_unique<pipeline::MappingRun>(job.inputs.config.config, options.robot_id);
  return std::make_unique<pipeline::MappingRun>(job.inputs.config.config, options.robot_id,
                                                job.inputs.map, initial_pose);
}

/// Ends the drive in the map, after its last scan.
void finish(MappedLog& mapped, Interruption& interruption) {
  if (!mapped.job->inputs.map) std::cerr << "matching revisited places\n";
  const Interruption::Immediate immediate(interruption);
  mapped.document = mapped.run->finish();
  mapped.report = make_report(mapped);
}

/// The same log from its beginning, read for a configuration. If odometry comes from the scans,
/// scans without odometry at their time are used, too.
recording::LogReader read_again(const Job& job, const pipeline::Config& config) {
  if (config.odometry_source != pipeline::OdometrySource::kLaser) return job.reader.from_start();
  recording::TopicChoice topics = job.options.topics;
  topics.odometry_use = recording::OdometryUse::kIgnored;
  return recording::LogReader(job.options.log, config.log, topics);
}

std::unique_ptr<Job> job_again(const Job& job, pipeline::LoadedConfig config) {
  recording::LogReader reader = read_again(job, config.config);
  Inputs inputs = job.inputs;
  inputs.config = std::move(config);
  return std::make_unique<Job>(
      Job{job.options, std::move(inputs), std::move(reader), job.laser_lines});
}

std::optional<MappedLog> map_again(const MappedLog& first, pipeline::LoadedConfig config,
                                   Interruption& interruption) {
  MappedLog mapped;
  mapped.job = job_again(*first.job, std::move(config));
  mapped.feed = std::make_unique<pipeline::ScanFeed>(open_feed_again(*mapped.job, *first.feed));
  mapped.run = make_run(*mapped.job);
  if (!add_scans(mapped, interruption)) return std::nullopt;
  finish(mapped, interruption);
  return mapped;
}

/// Whether a map is better than the one before it, and can be trusted.
bool is_better(const MappedLog& mapped, const MappedLog& before) {
  const localization::LaserOdometryCounts* counts = mapped.feed->laser_counts();
  if (counts != nullptr && !pipeline::too_sparse(*counts).empty()) return false;
  return results::is_better(mapped.report, before.report);
}

/// The noise of the odometry as measured by matches; empty if the log does not show it.
std::optional<localization::OdometryNoise> measured_noise(const Job& job) {
  const pipeline::Config& config = job.inputs.config.config;
  OpenLog log{job.reader.from_start(), job.laser_lines};
  const MatchedLog matched = match_log(config, log);
  try {
    return localization::calibrate_odometry(localization::odometry_stretches(matched.maps),
                                            matched.matched.motions, config.calibration,
                                            [](std::size_t, std::size_t) {})
        .noise;
  } catch (const std::runtime_error&) {
    return std::nullopt;  // too little motion
  }
}

/// Whether a remedy may be tried: the configuration file leaves its settings open, and a remedy of
/// the odometry does not meet odometry that already comes from the scans.
bool may_change(Remedy remedy, const MappedLog& mapped) {
  const pipeline::LoadedConfig& config = mapped.job->inputs.config;
  if (remedy == Remedy::kMoreStops) return !config.stop_distance_set;
  if (mapped.feed->laser_counts() != nullptr) return false;
  if (remedy == Remedy::kOdometryNoise) return !config.odometry_noise_set;
  return config.config.odometry_source == pipeline::OdometrySource::kAuto;
}

/// The configuration with a remedy, which is reported on stderr; empty if the log does not show the
/// values.
std::optional<pipeline::LoadedConfig> with_remedy(Remedy remedy, const Job& job,
                                                  const std::string& reason) {
  pipeline::LoadedConfig config = job.inputs.config;
  if (remedy == Remedy::kMoreStops) {
    set_stop_distance(config, 0.5 * config.config.local_mapper.stop_distance_m);
    std::cerr << fmt::format("topogeo: few stops match: mapping again with a stop each {:g} m\n",
                             config.config.local_mapper.stop_distance_m);
    return config;
  }
  if (remedy == Remedy::kLaserOdometry) {
    use_laser_odometry(config);
    std::cerr << "topogeo: " << reason << ": mapping again with odometry from the scans\n";
    return config;
  }
  std::cerr << "topogeo: few stops match: measuring the noise of the odometry\n";
  const std::optional<localization::OdometryNoise> noise = measured_noise(job);
  if (!noise) {
    std::cerr << "topogeo: the drive is too short to measure it\n";
    return std::nullopt;
  }
  set_odometry_noise(config, *noise);
  std::cerr << "topogeo: mapping again with the measured noise\n";
  return config;
}

}  // namespace

std::optional<MappedLog> map_log_once(Job job, Interruption& interruption) {
  MappedLog mapped;
  mapped.job = std::make_unique<Job>(std::move(job));
  mapped.feed = std::make_unique<pipeline::ScanFeed>(open_feed(*mapped.job));
  mapped.run = make_run(*mapped.job);
  if (!add_scans(mapped, interruption)) return std::nullopt;
  report_skipped(mapped.job->reader.statistics());
  check_usable(mapped.job->options, mapped.job->reader.statistics());
  check_tracked(mapped.job->options, *mapped.feed);
  if (interruption.received() != 0) return std::nullopt;
  finish(mapped, interruption);
  return mapped;
}

std::optional<MappedLog> improved(MappedLog mapped, Interruption& interruption) {
  std::set<Remedy> tried;
  for (;;) {
    const std::optional<Remedy> remedy = results::advised_remedy(mapped.report);
    if (!remedy || !may_change(*remedy, mapped)) return mapped;
    tried.insert(*remedy);
    std::optional<pipeline::LoadedConfig> config =
        with_remedy(*remedy, *mapped.job, mapped.report.quality.reasons.front());
    if (config) {
      std::optional<MappedLog> again = map_again(mapped, std::move(*config), interruption);
      if (!again) return std::nullopt;
      if (is_better(*again, mapped)) {
        mapped = std::move(*again);
      } else {
        std::cerr << "topogeo: the map is no better: the one before stays\n";
      }
    }
    // The advice must not name a remedy that was tried.
    judge(mapped.report, mapped, tried);
  }
}

}  // namespace topogeo::cli
