#include "service_run.hpp"

#include <algorithm>
#include <chrono>
#include <random>
#include <utility>

#include <unistd.h>

#include "topogeo/support/format.hpp"

namespace topogeo::cli {
namespace {

/// Often enough for a progress line that moves; ends of processes need not be seen sooner.
constexpr std::chrono::milliseconds kRunTick{50};
constexpr std::chrono::milliseconds kFirstRestart{100};
constexpr std::chrono::milliseconds kLongestRestart{5000};
constexpr double kStopTime_s = 5.0;  // that services have to end after they are asked to

messaging::Participant join(const RunOptions& options, const std::string& partition) {
  messaging::ParticipantOptions participant;
  participant.domain = options.domain;
  participant.partition = partition;
  participant.name = options.job.robot_id + "/topogeo";
  participant.profiles_file = options.profiles_file;
  return messaging::Participant(participant);
}

/// A partition that no other run has.
std::string own_partition() {
  // The process id shows people whose it is, the random number keeps containers apart.
  return fmt::format("run-{}-{:08x}", ::getpid(), std::random_device{}());
}

std::filesystem::path folder_of_this_program() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

}  // namespace

ServiceRun::ServiceRun(const RunOptions& options)
    : partition_(own_partition()),
      participant_(join(options, partition_)),
      processes_(folder_of_this_program(), options.job.out / "logs") {}

void ServiceRun::start(const RunOptions& options, Hooks hooks) {
  hooks_ = std::move(hooks);
  signals_.emplace([this](int number) { on_signal(number); });
  loop_.add_timer(kRunTick, [this] { tick(); });
  start_services(processes_, options, partition_);
}

// A second signal stops everything.
void ServiceRun::on_signal(int number) {
  if (signal_.exchange(number) == 0 && hooks_.on_first_signal) {
    loop_.post([this] {
      if (!ended_) hooks_.on_first_signal();
    });
  } else {
    loop_.stop();
  }
}

void ServiceRun::run() {
  loop_.run();
  ended_ = true;
}

void ServiceRun::tick() {
  if (ended_) return;
  while (const auto end = processes_.next_unexpected_end()) {
    if (end->can_restart && signal_.load() == 0) {
      restart(end->name, end->description);
    } else if (end->fatal) {
      fail(end->description);
      break;
    } else {
      hooks_.log(end->description + "; the run continues without it");
    }
  }
  hooks_.on_tick();
}

// One that dies again and again is started less and less often.
void ServiceRun::restart(const std::string& name, const std::string& description) {
  const std::uint32_t times = ++restarts_[name];
  const std::chrono::milliseconds delay =
      std::min(kFirstRestart * (1U << std::min(times - 1, 10U)), kLongestRestart);
  hooks_.log(fmt::format("{}; started again ({})", description, times));
  loop_.call_after(delay, [this, name] {
    if (!ended_) processes_.restart(name);
  });
}

void ServiceRun::note_failure(const std::string& why) {
  if (failure_.empty()) failure_ = why;
}

void ServiceRun::fail(const std::string& why) {
  note_failure(why);
  loop_.stop();
}

// The source alone and first: a writer whose reader goes while samples are on their way to it can
// lock up inside Fast DDS 2.9.1 (matched_reader_remove against the flow controller's thread).
std::vector<support::StageTime> ServiceRun::stop(bool source_first) {
  const auto pause = [this](std::chrono::milliseconds duration) { loop_.run_for(duration); };
  for (const std::string& name :
       processes_.stop(kStopTime_s, pause, source_first ? kScanSource : "")) {
    hooks_.log(name + " did not stop in time and is killed");
  }
  loop_.run_for(std::chrono::milliseconds(20));
  return by_stage(processes_.wait());
}

}  // namespace topogeo::cli
