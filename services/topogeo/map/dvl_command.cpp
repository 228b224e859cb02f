// topogeo dvl: pictures of the local Voronoi diagram and map of one scan or many scans of a log.
#include <algorithm>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/recording/log_reader.hpp"
#include "topogeo/render/contact_sheet.hpp"
#include "topogeo/render/scan_picture.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/progress_bar.hpp"

#include "commands.hpp"
#include "common/job.hpp"

namespace topogeo::cli {
namespace {

struct DvlOptions {
  std::filesystem::path log;
  recording::TopicChoice topics;
  std::filesystem::path out;
  std::optional<std::filesystem::path> config;
  std::optional<std::uint64_t> scan;
  bool all = false;
  std::uint64_t count = 48;
  std::optional<std::uint64_t> every;
  std::uint32_t width_px = 1600;
};

/// Shows progress on stderr, but only for work that takes longer than a second.
class SlowProgress {
 public:
  explicit SlowProgress(const char* label)
      : bar_(std::cerr, support::stderr_is_terminal(), label, "scans"),
        start_s_(support::monotonic_s()) {}

  void update(std::uint64_t done, std::uint64_t total) {
    const double elapsed_s = support::monotonic_s() - start_s_;
    if (elapsed_s < kSilent_s) return;
    bar_.update(done, total, elapsed_s);
    shown_ = true;
  }
  void finish(std::uint64_t done) {
    if (shown_) bar_.finish(done, done, support::monotonic_s() - start_s_);
  }

 private:
  static constexpr double kSilent_s = 1.0;
  support::ProgressBar bar_;
  double start_s_;
  bool shown_ = false;
};

/// The diagrams and maps of the scans of a log, with the settings of a configuration.
class ScanViews {
 public:
  explicit ScanViews(const pipeline::LocalMapperConfig& config)
      : config_(config), diagram_maker_(config.voronoi) {}
  render::ScanView make(const scan::Scan& scan) {
    return render::make_scan_view(scan, diagram_maker_, config_.local_map, config_.T_robot_laser);
  }

 private:
  pipeline::LocalMapperConfig config_;
  voronoi::LocalVoronoi diagram_maker_;
};

recording::LogReader open_scans(const DvlOptions& options, const pipeline::Config& config) {
  try {
    return recording::LogReader(options.log, config.log, options.topics);
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

/// Number of usable scans, which may be smaller than that of laser lines.
std::uint64_t count_usable(recording::LogReader reader) {
  const std::uint64_t laser_lines = reader.scan_count();
  SlowProgress progress("counting scans");
  std::uint64_t count = 0;
  while (reader.next()) progress.update(++count, laser_lines);
  progress.finish(count);
  return count;
}

std::string picture_of_scan(const DvlOptions& options, const pipeline::Config& config) {
  recording::LogReader reader = open_scans(options, config);
  SlowProgress progress("reading up to the scan");
  std::uint64_t read = 0;
  while (const std::optional<scan::Scan> scan = reader.next()) {
    progress.update(++read, *options.scan + 1);
    if (scan->sequence != *options.scan) continue;
    progress.finish(read);
    report_skipped(reader.statistics());
    return render::scan_picture(
        ScanViews(config.local_mapper).make(*scan), options.log.filename().string(),
        render::picture_format(options.out), {.max_width_px = options.width_px});
  }
  report_skipped(reader.statistics());
  throw service::UsageError(fmt::format("--scan {}: {} has {} usable scans, 0 to {}", *options.scan,
                                        options.log.string(), read, read - 1));
}

/// Sequence numbers of the scans to show, ascending: evenly spread, each in the middle of its share
/// of the log, or every N-th from the first.
std::vector<std::uint64_t> chosen_scans(const DvlOptions& options, std::uint64_t scans) {
  std::vector<std::uint64_t> chosen;
  if (options.every) {
    const std::uint64_t every = *options.every;
    const std::uint64_t least = (scans + render::kMostThumbnails - 1) / render::kMostThumbnails;
    if (every < least) {
      throw service::UsageError(
          fmt::format("--every {}: a sheet holds {} of the {} scans, so {} at least", every,
                      render::kMostThumbnails, scans, least));
    }
    for (std::uint64_t i = 0; i < scans; i += every) chosen.push_back(i);
  } else {
    const std::uint64_t count = std::min(options.count, scans);
    for (std::uint64_t i = 0; i < count; ++i) chosen.push_back((2 * i + 1) * scans / (2 * count));
  }
  return chosen;
}

std::string sheet_of_log(const DvlOptions& options, const pipeline::Config& config) {
  recording::LogReader reader = open_scans(options, config);
  const std::uint64_t scans = count_usable(reader.from_start());
  const std::vector<std::uint64_t> chosen = chosen_scans(options, scans);
  ScanViews maker(config.local_mapper);
  SlowProgress progress("drawing");
  std::vector<render::ScanView> views;
  while (views.size() < chosen.size()) {
    const std::optional<scan::Scan> scan = reader.next();
    if (!scan) break;  // the log has become shorter meanwhile
    progress.update(scan->sequence + 1, scans);
    if (scan->sequence != chosen[views.size()]) continue;
    views.push_back(maker.make(*scan));
    views.back().cells.clear();  // large, and not shown in a thumbnail
  }
  progress.finish(scans);
  report_skipped(reader.statistics());
  const std::string title = fmt::format("{}   {} of {} scans (counted from 0), range limit {:g} m",
                                        options.log.filename().string(), views.size(), scans,
                                        config.local_mapper.voronoi.range_limit_m);
  return render::contact_sheet(views, title, render::picture_format(options.out),
                               {.max_width_px = options.width_px});
}

int draw(DvlOptions options) {
  if (options.all == options.scan.has_value()) {
    throw service::UsageError("expected either --scan K or --all (see --help)");
  }
  pipeline::LoadedConfig config;
  try {
    (void)render::picture_format(options.out);
    config = pipeline::load_config(options.config);
  } catch (const std::exception& error) {
    throw service::UsageError(error.what());
  }
  choose_mounting(config, options.log, options.topics);
  support::write_file_atomically(options.out, options.all
                                                  ? sheet_of_log(options, config.config)
                                                  : picture_of_scan(options, config.config));
  return service::kOk;
}

}  // namespace

void add_dvl_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command = app.add_subcommand(
      "dvl", "Picture of the local Voronoi diagram and map of one scan, or of many (--all)");
  auto options = std::make_shared<DvlOptions>();
  add_topic_options(*command, options->topics);
  command->add_option("log,--log", options->log, recording::kLogFormats)
      ->required()
      ->type_name("FILE");
  command->add_option("--out", options->out, "picture to write: .png or .svg")
      ->required()
      ->type_name("FILE");
  command_line::Option* scan =
      command->add_option("--scan", options->scan, "the usable scan of that number, from 0")
          ->type_name("K");
  command_line::Option* all =
      command->add_flag("--all", options->all, "a contact sheet of scans through the whole log")
          ->excludes(scan);
  command_line::Option* count =
      command->add_option("--count", options->count, "evenly spread scans of --all")
          ->needs(all)
          ->check(command_line::range(std::uint64_t{1}, std::uint64_t{render::kMostThumbnails}))
          ->type_name("N")
          ->capture_default_str();
  command->add_option("--every", options->every, "instead of --count: every N-th scan")
      ->needs(all)
      ->excludes(count)
      ->check(command_line::positive_number())
      ->type_name("N");
  add_width_option(*command, options->width_px);
  add_config_option(*command, options->config);
  command->callback([options, &exit_code] { exit_code = draw(*options); });
}

}  // namespace topogeo::cli
