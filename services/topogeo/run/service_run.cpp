#include "run/service_run.hpp"

#include <chrono>
#include <filesystem>
#include <system_error>
#include <utility>

#include <unistd.h>

#include "topogeo/service/own_partition.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/host.hpp"

#include "common/domain_view.hpp"
#include "common/service_table.hpp"

namespace topogeo::cli {
namespace {

/// Fast enough for a smooth progress line; process ends need not be detected sooner.
constexpr std::chrono::milliseconds kRunTick{50};

/// Services publish their first status a second after their start.
constexpr std::chrono::seconds kFirstReport{5};

messaging::Participant join(const RunOptions& options, const std::string& partition) {
  messaging::ParticipantOptions participant;
  participant.domain = options.domain;
  participant.partition = partition;
  participant.name = options.job.robot_id + "/topogeo";
  participant.profiles_file = options.profiles_file;
  participant.robots = {options.job.robot_id};
  participant.observe = true;  // for discovery servers
  return messaging::Participant(participant);
}

std::filesystem::path folder_of_this_program() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

}  // namespace

ServiceRun::ServiceRun(const RunOptions& options)
    : partition_(service::own_partition("run")),
      source_(scan_source(options)),
      host_(support::host_name()),
      participant_(join(options, partition_)),
      statuses_(participant_),
      processes_(folder_of_this_program(), options.job.out / "logs", end_observer()) {
  loop_.add<msg::ServiceStatus>(
      statuses_, [this](const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
        on_status(status, info);
      });
}

ServiceRun::~ServiceRun() {
  forget_memories();
}

void ServiceRun::forget_memories(const std::filesystem::path& except) const {
  std::error_code ignored;
  for (const std::filesystem::path& path : memories_of_run(partition_)) {
    if (path != except) std::filesystem::remove(path, ignored);
  }
}

void ServiceRun::start(const RunOptions& options, Hooks hooks) {
  hooks_ = std::move(hooks);
  signals_.emplace([this](int number) { on_signal(number); });
  loop_.add_timer(kRunTick, [this] { tick(); });
  loop_.call_after(kFirstReport, [this] { log_if_deaf(); });
  if (options.web) web_log_ = options.job.out / "logs" / "web.log";
  start_all(options);
}

void ServiceRun::log_if_deaf() {
  if (!reports_.empty() || ended_) return;
  const std::string servers = unanswered_servers(participant_.peers());
  if (servers.empty()) {
    hooks_.log("no service is heard yet; `topogeo doctor` checks this machine and its network");
  } else {
    hooks_.log(servers +
               ", so services do not find each other: start one (fast-discovery-server -i 0), or "
               "unset the variable");
  }
}

void ServiceRun::start_all(const RunOptions& options) {
  recorder_there_ = !options.record.empty();
  other_readers_ = readers_of_scans(options, false);
  start_services(processes_, options, partition_);
}

// A second signal stops everything.
void ServiceRun::on_signal(int number) {
  ++signals_came_;
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
  if (next_ && processes_.retired()) {
    // The base of the previous simulator was switched off. The page goes on.
    forget_memories(memory_of_run(partition_, kWebMemory));
    start_all(*std::exchange(next_, std::nullopt));
  }
  if (recorder_there_ && processes_.has_ended(kRecorder)) forget_recorder();
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
  look_for_links();
  hooks_.on_tick();
}

void ServiceRun::look_for_links() {
  if (web_log_.empty()) return;
  const std::string with_token = links_in(web_log_, true);
  if (with_token.empty()) return;
  const std::string without_token = links_in(web_log_, false);
  web_log_.clear();
  if (hooks_.on_links) {
    hooks_.on_links(with_token, without_token);
    return;
  }
  // The token is shown only on a terminal, that is to the user: a log might be read by others.
  std::string links = ::isatty(STDERR_FILENO) == 1 ? with_token : without_token;
  while (!links.empty()) {
    const std::size_t end = links.find('\n');
    hooks_.log(links.substr(0, end));
    links.erase(0, end + 1);
  }
}

void ServiceRun::begin_again(const RunOptions& options) {
  restarts_.clear();
  next_ = options;
  processes_.retire("web");
}

void ServiceRun::restart(const std::string& name, const std::string& description) {
  const RestartLog::Restart restart = restarts_.died(name, support::monotonic_s());
  hooks_.log(fmt::format("{}; started again ({})", description, restart.number));
  loop_.call_after(restart.delay, [this, name] {
    if (!ended_ && !next_) processes_.restart(name);
  });
}

void ServiceRun::forget_recorder() {
  recorder_there_ = false;
  processes_.set_at_restart(source_, "--readers", std::to_string(other_readers_));
  // A source restarted before waits for the recorder, too.
  if (restarts_.is_away(source_)) processes_.kill(source_);
}

bool ServiceRun::has_started(const msg::ServiceStatus& status) const {
  return status.host() == host_.c_str() && processes_.has(static_cast<pid_t>(status.process_id()));
}

supervision::EndObserver ServiceRun::end_observer() {
  supervision::EndObserver observer;
  observer.progress = [this](pid_t pid) {
    supervision::Progress progress = supervision::read_progress(pid);
    progress.reports = reports_[pid];
    return progress;
  };
  observer.log = [this](const std::string& line) { hooks_.log(line); };
  return observer;
}

void ServiceRun::on_status(const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
  if (status.host() == host_.c_str()) ++reports_[static_cast<pid_t>(status.process_id())];
  note_state(status);
  note_cpu(status);
  if (hooks_.on_status) hooks_.on_status(status, info);
}

void ServiceRun::note_cpu(const msg::ServiceStatus& status) {
  const std::string service = status.service().to_string();
  if (!has_started(status)) return;
  if (cpu_shortage(status).empty()) {
    short_of_cpu_.erase(service);
    return;
  }
  short_of_cpu_.insert(service);
  if (!std::exchange(busy_logged_, true)) hooks_.log(too_busy() + "; the run takes longer");
}

std::string ServiceRun::too_busy() const {
  std::string names;
  for (const std::string& name : short_of_cpu_) names += (names.empty() ? "" : ", ") + name;
  return names.empty() ? "" : "this machine is too busy: the CPU is short for " + names;
}

void ServiceRun::note_state(const msg::ServiceStatus& status) {
  // A worker of another host, which serves every partition, may have the same process id.
  if (!has_worked(status.state()) || !has_started(status)) return;
  for (const std::string& name : restarts_.away()) {
    const pid_t pid = processes_.pid(name);
    if (pid < 0 || status.process_id() != static_cast<std::uint32_t>(pid)) continue;
    const auto away_s = restarts_.at_work(name, support::monotonic_s());
    hooks_.log(fmt::format("{} is at work again after {:.1f} s", name, away_s.value_or(0.0)));
    return;
  }
}

void ServiceRun::note_failure(const std::string& why) {
  if (failure_.empty()) failure_ = why;
}

void ServiceRun::fail(const std::string& why) {
  note_failure(why);
  loop_.stop();
}

void ServiceRun::stay() {
  while (signal_.load() == 0) static_cast<void>(loop_.run_for(kRunTick));
}

bool ServiceRun::wait_for_end(const std::string& name) {
  while (!processes_.has_ended(name) && !processes_.hangs(name)) {
    if (loop_.run_for(kRunTick)) break;  // a signal
  }
  return processes_.has_ended(name);
}

// First the source alone: a writer whose reader goes while samples are under way to it can deadlock
// inside Fast DDS 2.9.1 (matched_reader_remove against the flow controller's thread).
std::vector<support::StageTime> ServiceRun::stop(bool source_first) {
  const auto pause = [this](std::chrono::milliseconds duration) { loop_.run_for(duration); };
  const int came = signals_came_.load();
  const auto at_once = [this, came] { return signals_came_.load() > came; };
  const auto killed = processes_.stop(pause, at_once, source_first ? source_ : "");
  for (const std::string& name : killed) {
    if (at_once()) hooks_.log(name + " was killed: a second signal arrived before it ended");
  }
  loop_.run_for(std::chrono::milliseconds(20));
  return by_stage(processes_.wait());
}

}  // namespace topogeo::cli
