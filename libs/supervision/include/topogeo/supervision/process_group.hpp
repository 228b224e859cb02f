// Child processes that are started, watched and stopped together.
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

/// Effect of the end of a process on the others.
enum class Importance : std::uint8_t {
  kNeeded,      ///< they cannot go on without it
  kMayFinish,   ///< the same, but with exit code 0 it has done its work
  kExpendable,  ///< they go on without it
};

/// Whether a process that died can be restarted and continues its work.
enum class Restart : std::uint8_t { kNever, kWhenItDies };

/// A process that ended before its work was done.
struct UnexpectedEnd {
  std::string name;
  std::string
      description;     ///< "localizer was killed by signal 9 (Killed); last line of its log: ..."
  bool fatal = false;  ///< the others cannot go on without it
  /// it may be restarted: it neither ended too often nor rejected its input
  bool can_restart = false;
};

/// Clock, progress and log with which a group follows the ends of its processes. The defaults use
/// this machine.
struct EndObserver {
  std::function<double()> now_s = support::monotonic_s;
  std::function<Progress(pid_t pid)> progress = read_progress;
  std::function<void(const std::string& line)> log = [](const std::string&) {};  ///< for the user
};

class ProcessGroup {
 public:
  /// Takes programs from the folder `programs`; the output of each process goes to
  /// `logs`/<name>.log. Makes the folder `logs`; throws std::filesystem::filesystem_error when that
  /// is not possible.
  ProcessGroup(std::filesystem::path programs, std::filesystem::path logs,
               EndObserver observer = {});

  /// Starts a program under a unique name. A retired process of that name starts anew with these
  /// arguments; a running one goes on unchanged. Throws like ChildProcess.
  void start(const std::string& name, const std::string& program,
             const std::vector<std::string>& arguments, Importance importance = Importance::kNeeded,
             Restart restart = Restart::kNever);
  /// Drops `argument` when the process of that name is restarted.
  void leave_out_at_restart(const std::string& name, const std::string& argument);
  /// Replaces the value of an option when the process of that name is restarted.
  void set_at_restart(const std::string& name, const std::string& option, const std::string& value);
  /// Restarts a process that has ended, with a new log, <name>-2.log and so on. Throws like
  /// ChildProcess.
  void restart(const std::string& name);

  /// The process id for that name; -1 if there is none.
  [[nodiscard]] pid_t pid(const std::string& name) const;

  /// Whether `pid` belongs, or belonged until its end, to one of the processes.
  [[nodiscard]] bool has(pid_t pid) const;

  /// Whether the process of that name, if there is one, has ended. Does not wait.
  [[nodiscard]] bool has_ended(const std::string& name);

  /// Most restarts of each process.
  static constexpr std::uint32_t kMostRestarts = 20;

  /// A process that has ended since the last call; skips regular ends.
  std::optional<UnexpectedEnd> next_unexpected_end();

  /// Asks the process of that name to finish (SIGTERM); a clean exit is then a regular end.
  void finish(const std::string& name);

  /// Kills the process of that name, if it runs; it may be restarted like one that died.
  void kill(const std::string& name) { send_signal(SIGKILL, name); }

  /// Asks all processes except the one of that name to end (SIGTERM); their ends are then regular.
  void retire(const std::string& all_but);
  /// True when all retiring processes have ended. Call it many times a second, because it kills
  /// processes that hang.
  bool retired();

  /// Whether the process of that name, which should end by itself, hangs. Call it many times a
  /// second; it logs the wait.
  bool hangs(const std::string& name);

  /// Waits that long while the caller's other work goes on.
  using Pause = std::function<void(std::chrono::milliseconds duration)>;
  /// Asks all processes to end, `first` before the others (empty: all at once), and waits for them
  /// however slow they are. Kills those that hang (EndWatch), and all that still run as soon as
  /// `at_once` returns true. Returns the names of the killed ones.
  std::vector<std::string> stop(const Pause& pause, const std::function<bool()>& at_once,
                                const std::string& first = {});

  /// Waits until all have ended. Returns their wall and CPU times in the order of their start.
  std::vector<support::StageTime> wait();

 private:
  struct Member {
    std::unique_ptr<ChildProcess> process;
    Importance importance = Importance::kNeeded;
    Restart restart = Restart::kNever;
    std::string program;
    std::vector<std::string> arguments;
    std::string left_out = {};         // argument dropped at a restart
    bool reported = false;             // its end was reported
    bool retires = false;              // asked to end; a start may follow
    bool asked = false;                // asked to end
    std::optional<EndWatch> end = {};  // while its end is awaited
    std::uint32_t lives = 1;
    std::uint32_t restarts = 0;
    double earlier_wall_s = 0.0;  // of its earlier lives
    double earlier_cpu_s = 0.0;
  };

  std::unique_ptr<ChildProcess> make(const Member& member, const std::string& name);
  void begin_life(Member& member);

  void send_signal(int signal_number, const std::string& name);
  [[nodiscard]] bool runs(const std::string& name);
  bool hangs(Member& member);
  /// Kills processes that were asked to end but hang. Returns their names. Checks twice a second,
  /// however often it is called.
  std::vector<std::string> kill_hung();

  std::filesystem::path programs_;
  std::filesystem::path logs_;
  EndObserver observer_;
  double check_s_ = 0.0;  // time of the next check
  std::vector<Member> members_;
};

}  // namespace topogeo::supervision
