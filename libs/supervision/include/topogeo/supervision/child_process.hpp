// A program as a child process that does not outlive this program.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace topogeo::supervision {

/// How a child ended and what it used.
struct ChildExit {
  int exit_code = 0;      ///< when signal_number is 0
  int signal_number = 0;  ///< of the signal that killed it, else 0
  double wall_s = 0.0;    ///< from start to the detected end
  double cpu_s = 0.0;     ///< user and system, over all threads

  [[nodiscard]] bool clean() const { return exit_code == 0 && signal_number == 0; }
};

/// "was killed by signal 9 (Killed)" or "ended with exit code 3".
std::string describe(const ChildExit& exit);

class ChildProcess {
 public:
  /// Starts the program with its output going to `log_file` (replaced), no input, in its own
  /// process group (Ctrl-C in a terminal reaches only this program). The kernel kills it when the
  /// thread that started it ends. Throws std::runtime_error when the program or the log file cannot
  /// be opened or no process can be made.
  ChildProcess(std::string name, const std::filesystem::path& program,
               const std::vector<std::string>& arguments, std::filesystem::path log_file);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  /// Kills it if it still runs.
  ~ChildProcess();

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] pid_t pid() const { return pid_; }

  /// The exit, or nothing while the process runs. Does not wait.
  const std::optional<ChildExit>& poll();
  /// Does nothing if the process has ended.
  void send_signal(int signal_number);
  /// Waits for its end.
  void wait();

  /// The last line of its output, cut to a length for messages; empty if none.
  [[nodiscard]] std::string last_line() const;

 private:
  void collect(int wait_options);

  std::string name_;
  std::filesystem::path log_file_;
  pid_t pid_ = -1;
  double start_s_ = 0.0;
  std::optional<ChildExit> exit_;
};

}  // namespace topogeo::supervision
