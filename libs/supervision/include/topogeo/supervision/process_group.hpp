// Programs that run together as child processes: started, watched and stopped as one.
#pragma once

#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "topogeo/supervision/child_process.hpp"
#include "topogeo/supervision/end_watch.hpp"
#include "topogeo/support/cpu_time.hpp"

namespace topogeo::supervision {

/// What the end of a process means for the others.
enum class Importance : std::uint8_t {
  kNeeded,      ///< they cannot go on without it
  kMayFinish,   ///< the same, but with exit code 0 it has done its work
  kExpendable,  ///< they go on without it
};

/// Whether a process that dies can be started again, and goes on where it was.
enum class Restart : std::uint8_t { kNever, kWhenItDies };

/// A process that ended although its work was not done.
struct UnexpectedEnd {
  std::string name;
  std::string
      description;     ///< "localizer was killed by signal 9 (Killed); last line of its log: ..."
  bool fatal = false;  ///< the others cannot go on without it
  /// It may be started again: it is not too often that it ended, and not by what it was given.
  bool can_restart = false;
};

/// How a group follows the ends of its processes. The defaults are those of this machine.
struct EndObserver {
  std::function<double()> now_s = support::monotonic_s;
  std::function<Progress(pid_t pid)> progress = read_progress;
  std::function<void(const std::string& line)> log = [](const std::string&) {};  ///< for the user
};

class ProcessGroup {
 public:
  /// Programs are taken from the folder `programs`; the output of each process goes to
  /// `logs`/<name>.log. Makes the folder `logs`; throws std::filesystem::filesystem_error when that
  /// is not possible.
  ProcessGroup(std::filesystem::path programs, std::filesystem::path logs,
               EndObserver observer = {});

  /// Starts a program under a name of its own; one of that name that was retired is started anew
  /// with these arguments, one that runs goes on as it is. Throws like ChildProcess.
  void start(const std::string& name, const std::string& program,
             const std::vector<std::string>& arguments, Importance importance = Importance::kNeeded,
             Restart restart = Restart::kNever);
  /// What is left out of the arguments when the process of that name is started again.
  void leave_out_at_restart(const std::string& name, const std::string& argument);
  /// The value of an option among its arguments when the process of that name is started again.
  void set_at_restart(const std::string& name, const std::string& option, const std::string& value);
  /// Starts one again that has ended, with a log of its own, <name>-2.log and so on. Throws like
  /// ChildProcess.
  void restart(const std::string& name);

  /// The process of that name; -1 if there is none.
  [[nodiscard]] pid_t pid(const std::string& name) const;

  /// Whether one of them is, or was until it ended, the process `pid`.
  [[nodiscard]] bool has(pid_t pid) const;

  /// Whether the process of that name, if there is one, has ended. Does not wait.
  [[nodiscard]] bool has_ended(const std::string& name);

  /// How often one is started again at most.
  static constexpr std::uint32_t kMostRestarts = 20;

  /// One that has ended since the last call; an end that was in order is passed over.
  std::optional<UnexpectedEnd> next_unexpected_end();

  /// Asks the process of that name to finish (SIGTERM), which is in order from then on.
  void finish(const std::string& name);

  /// Kills the process of that name, if it runs: it may be started again like one that has died.
  void kill(const std::string& name) { send_signal(SIGKILL, name); }

  /// Asks all processes to end (SIGTERM), which is in order, but the one of that name, which goes
  /// on.
  void retire(const std::string& all_but);
  /// True when those that were asked to retire have ended. Call it many times a second: those
  /// that hang are killed.
  bool retired();

  /// Whether the process of that name hangs, which is to end by itself: call it many times a
  /// second. It reports what is waited for.
  bool hangs(const std::string& name);

  /// Passes so much time, in which the caller's other work goes on.
  using Pause = std::function<void(std::chrono::milliseconds duration)>;
  /// Asks all processes to end, `first` alone before the others (empty: all at once), and waits
  /// for them however slow they are. Those that hang (EndWatch) are killed, and all that still run
  /// as soon as `at_once` returns true. Returns the names of those that were killed.
  std::vector<std::string> stop(const Pause& pause, const std::function<bool()>& at_once,
                                const std::string& first = {});

  /// Waits until all have ended. Wall and CPU time of each, in the order of their start.
  std::vector<support::StageTime> wait();

 private:
  struct Member {
    std::unique_ptr<ChildProcess> process;
    Importance importance = Importance::kNeeded;
    Restart restart = Restart::kNever;
    std::string program;
    std::vector<std::string> arguments;
    std::string left_out = {};         // of them at a restart
    bool reported = false;             // its end
    bool retires = false;              // it was asked to end, and another may follow
    bool asked = false;                // to end
    std::optional<EndWatch> end = {};  // of one that is waited for
    std::uint32_t lives = 1;
    std::uint32_t restarts = 0;
    double earlier_wall_s = 0.0;  // of its lives before
    double earlier_cpu_s = 0.0;
  };

  std::unique_ptr<ChildProcess> make(const Member& member, const std::string& name);
  void begin_life(Member& member);

  void send_signal(int signal_number, const std::string& name);
  [[nodiscard]] bool runs(const std::string& name);
  bool hangs(Member& member);
  /// Kills those that were asked to end and hang. Returns their names. Checks twice a second,
  /// however often it is called.
  std::vector<std::string> kill_hung();

  std::filesystem::path programs_;
  std::filesystem::path logs_;
  EndObserver observer_;
  double check_s_ = 0.0;  // when ends are looked after next
  std::vector<Member> members_;
};

}  // namespace topogeo::supervision
