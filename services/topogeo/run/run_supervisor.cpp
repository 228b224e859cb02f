#include "run/run_supervisor.hpp"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iostream>
#include <string>

#include "topogeo/pipeline/config.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::cli {
namespace {

using std::chrono::milliseconds;

/// Keeps speed changes below the base's limit, so that it can follow.
constexpr double kShareOfAcceleration = 0.6;

}  // namespace

RunSupervisor::RunSupervisor(const RunOptions& options, std::uint64_t laser_lines)
    : options_(options),
      laser_lines_(laser_lines),
      start_s_(support::monotonic_s()),
      bar_(std::cerr, support::stderr_is_terminal(), "mapping", "scans"),
      stall_(start_s_),
      run_(options),
      end_reader_(run_.participant()),
      decision_reader_(run_.participant()),
      summary_reader_(run_.participant()) {
  messaging::EventLoop& loop = run_.loop();
  loop.add<msg::StreamEnd>(
      end_reader_, [this](const msg::StreamEnd& end, const messaging::SampleInfo&) {
        if (end.stage() != msg::kStageMapStore || end.robot_id() != options_.job.robot_id.c_str())
          return;
        // Output of services that are being stopped does not end the run.
        if (run_.ended()) return;
        result_.finished = true;
        run_.loop().stop();
      });
  loop.add<msg::LoopDecisions>(
      decision_reader_, [this](const msg::LoopDecisions& segment, const messaging::SampleInfo&) {
        if (segment.robot_id() == options_.job.robot_id.c_str()) decisions_.add(segment);
      });
  loop.add<msg::RunSummary>(summary_reader_,
                            [this](const msg::RunSummary& summary, const messaging::SampleInfo&) {
                              if (summary.robot_id() != options_.job.robot_id.c_str()) return;
                              result_.summary = summary;
                              summary_came_ = true;
                            });
  if (options_.explore) {
    exploration_.emplace(run_.participant(), loop, options_.job.robot_id,
                         pipeline::load_config(options_.job.config).config.exploration);
  }
  if (options_.simulation) {
    simulation::DriveOptions drive;
    drive.speed_m_per_s = options_.simulation->speed_m_per_s;
    drive.turn_rad_per_s = kSimulatedTurn_rad_s;
    drive.acceleration_m_per_s2 = kShareOfAcceleration * kSimulatedAcceleration;
    drive.turn_gain_per_s = 2.0;
    tour_.emplace(run_.participant(), loop, options_.job.robot_id,
                  world::load_world(options_.simulation->world).tour_m, drive);
  }
  ServiceRun::Hooks hooks;
  hooks.on_tick = [this] { tick(); };
  hooks.on_status = [this](const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
    result_.services.update(status, info);
  };
  if (options_.job.log.empty()) hooks.on_first_signal = [this] { end_stream(); };
  hooks.log = [this](const std::string& line) { print(line); };
  run_.start(options_, std::move(hooks));
}

RunResult RunSupervisor::run() {
  run_.run();
  result_.signal_number = result_.finished ? 0 : run_.signal_number();
  if (tour_) {
    result_.truth = tour_->truth().poses();
    result_.collisions = tour_->truth().last().collisions();
  }
  finish_bar();
  if (result_.finished) wait_for_summary();
  if (result_.finished && !options_.record.empty()) wait_for_recorder();
  if (result_.finished && options_.web) stay_for_page();
  // Without the end of the stream, samples are still under way.
  result_.times = run_.stop(!result_.finished);
  result_.failure = run_.failure();
  return std::move(result_);
}

void RunSupervisor::tick() {
  check_states();
  check_stall();
  if (exploration_) {
    watch_exploration();
    return;
  }
  if (tour_) watch_tour();
  show_progress();
}

void RunSupervisor::watch_tour() {
  // A mapped scan means that all services are ready for the drive.
  if (counter(result_.services.find("local_mapper"), "scans") > 0.0) tour_->set_out();
  if (tour_->arrived()) end_stream();
  if (tour_->overdue()) {
    run_.fail(fmt::format("the robot does not arrive, {:.0f} % of the tour were driven",
                          100.0 * tour_->share()));
  }
}

void RunSupervisor::watch_exploration() {
  if (stream_ended_ || !exploration_->client().missing().empty() ||
      !exploration_->client().status()) {
    return;
  }
  exploration_->tick();
  if (!exploration_->done()) return;
  exploration_->client().cancel();
  print(exploration_->summary());
  end_stream();
}

void RunSupervisor::end_stream() {
  if (stream_ended_) return;
  stream_ended_ = true;
  run_.end_stream();
}

void RunSupervisor::check_states() {
  for (const msg::ServiceStatus* service : result_.services.rows()) {
    if (service->state() != msg::kServiceFailed || !run_.has_started(*service)) continue;
    const std::string what =
        fmt::format("{} has failed: {}", service->service().c_str(), service->message().c_str());
    if (service->service() != "ga_worker") run_.fail(what);
  }
}

void RunSupervisor::check_stall() {
  switch (stall_.check(result_.services.progress_mark(), support::monotonic_s())) {
    case supervision::StallWatch::Verdict::kMoving:
      return;
    case supervision::StallWatch::Verdict::kReport:
      print(fmt::format("no progress for {:.0f} s: {}", supervision::kStallReported_s,
                        describe_states(result_.services)));
      return;
    case supervision::StallWatch::Verdict::kGiveUp:
      run_.fail(fmt::format("no progress for {:.0f} s: {}", supervision::kStallFailed_s,
                            describe_states(result_.services)));
  }
}

void RunSupervisor::show_progress() {
  // The localizer is the last stage but counts stops, which are converted to scans here.
  const msg::ServiceStatus* mapper = result_.services.find("local_mapper");
  const msg::ServiceStatus* localizer = result_.services.find("localizer");
  const double maps = counter(mapper, "local_maps");
  const double localized = counter(localizer, "local_maps");
  const double scans = counter(mapper, "scans");
  const double share = maps > 0.0 ? std::min(1.0, localized / maps) : 0.0;
  const auto done = static_cast<std::uint64_t>(scans * share);
  const bool all_read = mapper != nullptr && mapper->state() == msg::kServiceFinished;
  if (bar_done_) return;
  const double elapsed_s = support::monotonic_s() - start_s_;
  if (all_read && localized >= maps) {
    bar_done_ = true;
    bar_.finish(done, done, elapsed_s);
    std::cerr << "matching revisited places\n";
    return;
  }
  std::uint64_t total = laser_lines_;
  if (tour_) total = static_cast<std::uint64_t>(scans / std::max(tour_->share(), 0.01));
  bar_.update(done, std::max(total, done), elapsed_s);
}

void RunSupervisor::finish_bar() {
  if (bar_done_) return;
  bar_done_ = true;
  if (support::stderr_is_terminal()) std::cerr << '\n';
}

void RunSupervisor::print(const std::string& text) {
  if (support::stderr_is_terminal() && !bar_done_) std::cerr << '\n';
  std::cerr << "topogeo: " << text << '\n';
}

// Summary and decisions were sent before the end of the stream, but on topics of their own, whose
// writers may not even be discovered yet on a busy machine.
void RunSupervisor::wait_for_summary() {
  const auto complete = [this] {
    return summary_came_ && decisions_.all().size() >= result_.summary.loop_decisions();
  };
  using Verdict = supervision::StallWatch::Verdict;
  supervision::StallWatch stall(support::monotonic_s());
  while (!complete()) {
    const Verdict verdict = stall.check(
        fmt::format("{} {}", summary_came_, decisions_.all().size()), support::monotonic_s());
    if (verdict == Verdict::kGiveUp) break;
    if (verdict == Verdict::kReport) print("still waiting for the summary of the localizer");
    if (run_.loop().run_for(milliseconds(5))) break;  // a signal
  }
  result_.loop_decisions = decisions_.all();
  if (complete()) return;
  result_.finished = false;
  run_.fail(summary_came_
                ? fmt::format("{} of {} loop decisions came from the localizer",
                              result_.loop_decisions.size(), result_.summary.loop_decisions())
                : "no summary came from the localizer: there is a map, but no report");
}

// A user who asked for a page wants to see the map on it.
void RunSupervisor::stay_for_page() {
  if (run_.signal_number() != 0) return;
  print("the map is finished and in " + options_.job.out.string() +
        "; the page runs until Ctrl-C, then the report is written");
  const double since_s = support::monotonic_s();
  run_.stay();
  result_.stayed_s = support::monotonic_s() - since_s;
}

// Data published last still has to be written.
void RunSupervisor::wait_for_recorder() {
  if (!run_.wait_for_end(kRecorder)) {
    print("the recording is incomplete: its program did not end by itself");
  }
  std::ifstream log(options_.job.out / "logs" / (std::string(kRecorder) + ".log"));
  for (std::string line; std::getline(log, line);) {
    if (line.starts_with("topogeo: ")) std::cerr << line << '\n';
  }
}

}  // namespace topogeo::cli
