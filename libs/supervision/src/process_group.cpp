#include "topogeo/supervision/process_group.hpp"

#include <algorithm>
#include <csignal>
#include <utility>

namespace topogeo::supervision {

namespace {

/// Time between two checks for running processes: short compared with the end of a service.
constexpr std::chrono::milliseconds kCheckPeriod{20};
/// Time between two checks for hanging processes, which read files for each thread.
constexpr double kProgressPeriod_s = 0.5;

}  // namespace

ProcessGroup::ProcessGroup(std::filesystem::path programs, std::filesystem::path logs,
                           EndObserver observer)
    : programs_(std::move(programs)), logs_(std::move(logs)), observer_(std::move(observer)) {
  std::filesystem::create_directories(logs_);
}

void ProcessGroup::start(const std::string& name, const std::string& program,
                         const std::vector<std::string>& arguments, Importance importance,
                         Restart restart) {
  Member member{nullptr, importance, restart, program, arguments};
  for (Member& before : members_) {
    if (before.process->name() != name) continue;
    if (!before.retires) return;
    member.process = std::move(before.process);
    member.lives = before.lives;
    member.earlier_wall_s = before.earlier_wall_s;
    member.earlier_cpu_s = before.earlier_cpu_s;
    before = std::move(member);
    begin_life(before);
    return;
  }
  member.process = make(member, name);
  members_.push_back(std::move(member));
}

/// Starts the next life of a member whose process has ended.
void ProcessGroup::begin_life(Member& member) {
  if (const auto& exit = member.process->poll()) {
    member.earlier_wall_s += exit->wall_s;
    member.earlier_cpu_s += exit->cpu_s;
  }
  ++member.lives;
  member.process = make(member, member.process->name());
  member.reported = false;
  member.asked = false;
  member.end.reset();
}

std::unique_ptr<ChildProcess> ProcessGroup::make(const Member& member, const std::string& name) {
  const std::string life = member.lives == 1 ? "" : "-" + std::to_string(member.lives);
  return std::make_unique<ChildProcess>(name, programs_ / member.program, member.arguments,
                                        logs_ / (name + life + ".log"));
}

void ProcessGroup::leave_out_at_restart(const std::string& name, const std::string& argument) {
  for (Member& member : members_) {
    if (member.process->name() == name) member.left_out = argument;
  }
}

void ProcessGroup::set_at_restart(const std::string& name, const std::string& option,
                                  const std::string& value) {
  for (Member& member : members_) {
    if (member.process->name() != name) continue;
    const auto found = std::ranges::find(member.arguments, option);
    if (found != member.arguments.end() && found + 1 != member.arguments.end()) found[1] = value;
  }
}

void ProcessGroup::restart(const std::string& name) {
  for (Member& member : members_) {
    if (member.process->name() != name) continue;
    ++member.restarts;
    if (!member.left_out.empty()) std::erase(member.arguments, member.left_out);
    begin_life(member);
  }
}

pid_t ProcessGroup::pid(const std::string& name) const {
  for (const Member& member : members_) {
    if (member.process->name() == name) return member.process->pid();
  }
  return -1;
}

bool ProcessGroup::has(pid_t pid) const {
  return std::ranges::any_of(members_,
                             [pid](const Member& member) { return member.process->pid() == pid; });
}

bool ProcessGroup::has_ended(const std::string& name) {
  return std::ranges::all_of(members_, [&](Member& member) {
    return member.process->name() != name || member.process->poll().has_value();
  });
}

std::optional<UnexpectedEnd> ProcessGroup::next_unexpected_end() {
  for (Member& member : members_) {
    if (member.reported) continue;
    const std::optional<ChildExit>& exit = member.process->poll();
    if (!exit) continue;
    member.reported = true;
    if (member.importance == Importance::kMayFinish && exit->clean()) continue;
    const std::string last = member.process->last_line();
    // Other exit codes mean that the process rejected its input.
    const bool died = exit->signal_number != 0 || exit->exit_code == 1;
    return UnexpectedEnd{
        member.process->name(),
        member.process->name() + " " + describe(*exit) +
            (last.empty() ? ", its log is empty" : "; last line of its log: " + last),
        member.importance != Importance::kExpendable,
        member.restart == Restart::kWhenItDies && died && member.restarts < kMostRestarts};
  }
  return std::nullopt;
}

void ProcessGroup::finish(const std::string& name) {
  for (Member& member : members_) {
    if (member.process->name() == name) member.importance = Importance::kMayFinish;
  }
  send_signal(SIGTERM, name);
}

void ProcessGroup::retire(const std::string& all_but) {
  for (Member& member : members_) {
    if (member.process->name() == all_but) continue;
    member.retires = true;
    member.asked = true;
    member.reported = true;
    member.process->send_signal(SIGTERM);
  }
}

bool ProcessGroup::retired() {
  kill_hung();
  return std::ranges::none_of(members_, [](Member& member) {
    return member.retires && !member.process->poll().has_value();
  });
}

bool ProcessGroup::hangs(const std::string& name) {
  const double now_s = observer_.now_s();
  if (now_s < check_s_) return false;
  check_s_ = now_s + kProgressPeriod_s;
  return std::ranges::any_of(members_, [&](Member& member) {
    return member.process->name() == name && !member.process->poll() && hangs(member);
  });
}

bool ProcessGroup::hangs(Member& member) {
  const Progress progress = observer_.progress(member.process->pid());
  if (!member.end) member.end.emplace(progress, observer_.now_s());
  const EndWatch::Verdict verdict = member.end->check(progress, observer_.now_s());
  if (verdict == EndWatch::Verdict::kReport) {
    observer_.log("waits for " + member.process->name() + " to end: " + member.end->text());
  }
  return verdict == EndWatch::Verdict::kHangs;
}

std::vector<std::string> ProcessGroup::kill_hung() {
  const double now_s = observer_.now_s();
  if (now_s < check_s_) return {};
  check_s_ = now_s + kProgressPeriod_s;
  std::vector<std::string> killed;
  for (Member& member : members_) {
    if (!member.asked || member.process->poll() || !hangs(member)) continue;
    observer_.log(member.process->name() + " hangs and is killed: " + member.end->text());
    member.process->send_signal(SIGKILL);
    member.asked = false;
    killed.push_back(member.process->name());
  }
  return killed;
}

void ProcessGroup::send_signal(int signal_number, const std::string& name) {
  for (Member& member : members_) {
    if (name.empty() || member.process->name() == name) member.process->send_signal(signal_number);
  }
}

bool ProcessGroup::runs(const std::string& name) {
  for (Member& member : members_) {
    if ((name.empty() || member.process->name() == name) && !member.process->poll()) return true;
  }
  return false;
}

std::vector<std::string> ProcessGroup::stop(const Pause& pause,
                                            const std::function<bool()>& at_once,
                                            const std::string& first) {
  std::vector<std::string> killed;
  const auto end = [&](const std::string& name) {
    for (Member& member : members_) {
      if (name.empty() || member.process->name() == name) member.asked = true;
    }
    send_signal(SIGTERM, name);
    while (runs(name) && !at_once()) {
      for (std::string& hung : kill_hung()) killed.push_back(std::move(hung));
      pause(kCheckPeriod);
    }
  };
  if (!first.empty()) end(first);
  end({});
  for (Member& member : members_) {
    if (!member.process->poll()) killed.push_back(member.process->name());
  }
  send_signal(SIGKILL, {});
  return killed;
}

std::vector<support::StageTime> ProcessGroup::wait() {
  std::vector<support::StageTime> times;
  for (Member& member : members_) {
    member.process->wait();
    if (const auto& exit = member.process->poll()) {
      times.push_back({member.process->name(), member.earlier_wall_s + exit->wall_s,
                       member.earlier_cpu_s + exit->cpu_s});
    }
  }
  return times;
}

}  // namespace topogeo::supervision
