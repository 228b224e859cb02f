// Runs the project's executables from tests and watches them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

#include "topogeo/simulation/simulate_log.hpp"

#include "waiting.hpp"

namespace topogeo::test {

/// A directory of its own for each test, removed at the end.
class Scratch {
 public:
  Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch();
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// A started program whose output goes to files. Its destructor kills it if it still runs.
class Program {
 public:
  /// `name` is an executable of build/bin, `scratch` takes its output. A service that is started so
  /// has nobody who starts it again: it may stand still for ever, unless set_longest_freeze() says
  /// otherwise.
  Program(const Scratch& scratch, const std::string& name, const std::vector<std::string>& words);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program();

  /// Exit code, or 128 + signal. Throws std::runtime_error when it neither ends nor prints anything
  /// within hang_limit(), like all waits here.
  int wait();

  bool ended();

  /// Waits until its standard error contains `text`. Throws std::runtime_error when it ends before.
  void wait_for_error_text(const std::string& text);

  /// The same for its progress bar: waits until that many per cent are done. All is done when the
  /// program has ended without an error, which a bar that is seldom drawn may not show.
  void wait_for_progress(int percent);

  void send_signal(int signal_number) const;
  [[nodiscard]] pid_t pid() const { return pid_; }
  [[nodiscard]] std::string out() const;
  [[nodiscard]] std::string err() const;

  /// Processes of this `topogeo run`, found by the partition in their command lines; all services,
  /// or those of one name.
  [[nodiscard]] std::vector<pid_t> services(const std::string& name = {}) const;

 private:
  /// Whether `condition` held before a hang.
  template <class Condition>
  bool wait_while_it_works(const std::string& what, const Condition& condition);

  std::string name_;
  pid_t pid_ = -1;
  int status_ = 0;
  bool ended_ = false;
  std::filesystem::path out_;
  std::filesystem::path err_;
};

std::string read_file(const std::filesystem::path& path);

/// Prints the lines of a text that contain `part`: measured values of a test.
void print_lines_with(const std::string& part, const std::string& text);

/// A DDS domain for the running test, so that concurrent tests do not see each other.
std::string own_domain();

/// Programs started from here on use no shared memory. For tests that kill programs: their segments
/// in /dev/shm would fill that of a container.
void use_udp_only();

/// Programs started from here on may be frozen for so long; 0: without limit. Without this call a
/// service that a test freezes for half a lease ends when it continues.
void set_longest_freeze(unsigned seconds);

/// Makes keys with deploy/security/make_keys; `what` follows `make_keys DIR issue`. False without
/// openssl. Throws std::runtime_error when it fails.
bool issue_keys(const std::filesystem::path& directory, const std::string& what);

/// Writes the log of a drive through a world of share/worlds, and its true poses if `truth` is
/// named. The log states `stated` as the mounting of its laser, whatever the options say.
void write_log(const std::string& world, const std::filesystem::path& log,
               const std::filesystem::path& truth = {},
               const simulation::SimulationOptions& options = {},
               const geometry::Pose2& stated = {});

}  // namespace topogeo::test
