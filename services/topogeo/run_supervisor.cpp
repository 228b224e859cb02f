#include "run_supervisor.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <iostream>
#include <random>

#include <unistd.h>

#include "topogeo/support/format.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::cli {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kTick{50};
/// Speeds change more slowly than the base could change them, so that it keeps up.
constexpr double kShareOfAcceleration = 0.6;
constexpr double kLastWord_s = 30.0;  // for what was sent on a topic of its own

}  // namespace

messaging::Participant join(const RunOptions& options, const std::string& partition) {
  messaging::ParticipantOptions participant;
  participant.domain = options.domain;
  participant.partition = partition;
  participant.name = options.job.robot_id + "/topogeo";
  participant.profiles_file = options.profiles_file;
  return messaging::Participant(participant);
}

std::string own_partition() {
  // The process id tells people whose it is, the random number keeps containers apart.
  return fmt::format("run-{}-{:08x}", ::getpid(), std::random_device{}());
}

RunSupervisor::RunSupervisor(const RunOptions& options, std::uint64_t laser_lines)
    : RunSupervisor(options, laser_lines, own_partition()) {}

RunSupervisor::RunSupervisor(const RunOptions& options, std::uint64_t laser_lines,
                             const std::string& partition)
    : options_(options),
      laser_lines_(laser_lines),
      start_s_(support::monotonic_s()),
      bar_(std::cerr, support::stderr_is_terminal(), "mapping", "scans"),
      stall_(start_s_),
      participant_(join(options, partition)),
      status_reader_(participant_),
      end_reader_(participant_),
      decision_reader_(participant_),
      signals_([this](int number) { on_signal(number); }),
      services_(options, partition) {
  loop_.add<msg::ServiceStatus>(
      status_reader_, [this](const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
        result_.services.update(status, info);
      });
  loop_.add<msg::StreamEnd>(
      end_reader_, [this](const msg::StreamEnd& end, const messaging::SampleInfo&) {
        if (end.stage() != "map_store" || end.robot_id() != options_.job.robot_id.c_str()) return;
        result_.finished = true;
        loop_.stop();
      });
  loop_.add<msg::LoopDecisions>(
      decision_reader_, [this](const msg::LoopDecisions& segment, const messaging::SampleInfo&) {
        if (segment.robot_id() == options_.job.robot_id.c_str()) decisions_.add(segment);
      });
  loop_.add_timer(kTick, [this] { tick(); });
  if (options_.explore) exploration_.emplace(participant_, loop_, options_.job.robot_id);
  if (!options_.simulation) return;
  simulation::DriveOptions drive;
  drive.speed_m_per_s = options_.simulation->speed_m_per_s;
  drive.turn_rad_per_s = kSimulatedTurn_rad_s;
  drive.acceleration_m_per_s2 = kShareOfAcceleration * kSimulatedAcceleration;
  drive.turn_gain_per_s = 2.0;
  tour_.emplace(participant_, loop_, options_.job.robot_id,
                world::load_world(options_.simulation->world).tour_m, drive);
}

// A second signal stops everything.
void RunSupervisor::on_signal(int number) {
  const bool may_finish = !options_.devices.empty() && signal_ == 0;
  signal_ = number;
  if (may_finish) {
    loop_.post([this] { end_stream(); });
  } else {
    loop_.stop();
  }
}

RunResult RunSupervisor::run() {
  loop_.run();
  ended_ = true;
  result_.signal_number = result_.finished ? 0 : signal_.load();
  if (tour_) {
    result_.truth = tour_->truth();
    result_.collisions = tour_->last().collisions();
  }
  finish_bar();
  if (result_.finished) wait_for_last_words();
  // Without the end of the stream samples are still on their way.
  stop(services_, loop_, !result_.finished, [this](const std::string& text) { say(text); });
  result_.times = services_.wait();
  return std::move(result_);
}

void RunSupervisor::tick() {
  if (ended_) return;
  check_deaths();
  check_stall();
  if (exploration_) {
    watch_exploration();
    return;
  }
  if (tour_) watch_tour();
  show_progress();
}

void RunSupervisor::watch_tour() {
  // Nobody misses the start of the drive: a scan has come through.
  if (counter(result_.services.find("local_mapper"), "scans") > 0.0) tour_->set_out();
  if (tour_->arrived()) end_stream();
  if (tour_->overdue()) {
    fail(fmt::format("the robot does not arrive, {:.0f} % of the tour were driven",
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
  say(exploration_->summary());
  end_stream();
}

void RunSupervisor::end_stream() {
  if (stream_ended_) return;
  stream_ended_ = true;
  services_.send_signal(SIGTERM, "sensor_gateway");
}

void RunSupervisor::check_deaths() {
  while (const std::optional<ServiceGroup::Death> death = services_.next_death()) {
    if (stream_ended_ && death->clean && death->name == "sensor_gateway") continue;
    if (death->clean && death->name == "record") continue;  // the stream is at its end
    if (!death->is_worker) {
      fail(death->what);
      return;
    }
    say(death->what + "; going on without it");
  }
  for (const msg::ServiceStatus* service : result_.services.rows()) {
    if (service->state() != msg::kServiceFailed) continue;
    const std::string what =
        fmt::format("{} has failed: {}", service->service().c_str(), service->message().c_str());
    if (service->service() != "ga_worker") fail(what);
  }
}

void RunSupervisor::check_stall() {
  switch (stall_.look(result_.services.progress_mark(), support::monotonic_s())) {
    case StallWatch::Verdict::kMoving:
      return;
    case StallWatch::Verdict::kTell:
      say(fmt::format("no progress for {:.0f} s: {}", kStallTold_s,
                      describe_states(result_.services)));
      return;
    case StallWatch::Verdict::kGiveUp:
      fail(fmt::format("no progress for {:.0f} s: {}", kStallFailed_s,
                       describe_states(result_.services)));
  }
}

void RunSupervisor::show_progress() {
  // The localizer is the last to see a scan, but it counts stops, so these are put in scans.
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

void RunSupervisor::say(const std::string& text) {
  if (support::stderr_is_terminal() && !bar_done_) std::cerr << '\n';
  std::cerr << "topogeo: " << text << '\n';
}

void RunSupervisor::fail(const std::string& why) {
  if (result_.failure.empty()) result_.failure = why;
  loop_.stop();
}

// What the localizer counted and decided was sent before the end of the stream, but on topics of
// their own, whose writers may not even be known yet when the machine is busy.
void RunSupervisor::wait_for_last_words() {
  const auto localizer = [this] { return result_.services.find("localizer"); };
  const auto expected = [&] {
    return static_cast<std::size_t>(counter(localizer(), "loop_decisions"));
  };
  const auto finished = [&] {
    return localizer() != nullptr && localizer()->state() == msg::kServiceFinished;
  };
  const double end_s = support::monotonic_s() + kLastWord_s;
  while ((!finished() || decisions_.all().size() < expected()) && support::monotonic_s() < end_s) {
    if (loop_.run_for(milliseconds(5))) break;  // a signal
  }
  result_.loop_decisions = decisions_.all();
  if (finished() && result_.loop_decisions.size() == expected()) return;
  result_.finished = false;
  fail(finished() ? fmt::format("{} of {} loop decisions came from the localizer",
                                result_.loop_decisions.size(), expected())
                  : "the localizer has not said what it has done: there is a map, but no report");
}

}  // namespace topogeo::cli
