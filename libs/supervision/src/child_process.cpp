#include "topogeo/supervision/child_process.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/file_descriptor.hpp"

namespace topogeo::supervision {
namespace {

constexpr int kCannotExec = 127;           // the exit code of shells for this case
constexpr std::size_t kLongestLine = 400;  // bytes; fits into a log line

std::runtime_error system_error(const std::string& what) {
  return std::runtime_error(what + ": " + std::strerror(errno));
}

support::FileDescriptor open(const char* path, int flags) {
  support::FileDescriptor file(::open(path, flags | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (!file.is_open()) throw system_error(std::string("cannot open ") + path);
  return file;
}

/// Readable by its owner only, because a program may log confidential data.
support::FileDescriptor open_log(const std::filesystem::path& path) {
  support::FileDescriptor file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND);
  // An existing file may have another mode; a device is not a log file.
  struct stat status {};
  if (::fstat(file.get(), &status) == 0 && S_ISREG(status.st_mode)) {
    static_cast<void>(::fchmod(file.get(), S_IRUSR | S_IWUSR));
  }
  return file;
}

/// Becomes the program. Only async-signal-safe calls: the parent has other threads.
[[noreturn]] void become(const char* program, char* const* arguments, int input, int output,
                         pid_t parent) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(kCannotExec);  // the parent died before prctl
  ::dup2(input, STDIN_FILENO);
  ::dup2(output, STDOUT_FILENO);
  ::dup2(output, STDERR_FILENO);
  ::close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
  ::execv(program, arguments);
  ::_exit(kCannotExec);
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

std::string describe(const ChildExit& exit) {
  if (exit.signal_number != 0) {
    return "was killed by signal " + std::to_string(exit.signal_number) + " (" +
           ::strsignal(exit.signal_number) + ")";
  }
  return "ended with exit code " + std::to_string(exit.exit_code);
}

ChildProcess::ChildProcess(std::string name, const std::filesystem::path& program,
                           const std::vector<std::string>& arguments,
                           std::filesystem::path log_file)
    : name_(std::move(name)), log_file_(std::move(log_file)), start_s_(support::monotonic_s()) {
  if (::access(program.c_str(), X_OK) != 0) throw system_error("cannot run " + program.string());
  const support::FileDescriptor input = open("/dev/null", O_RDONLY);
  const support::FileDescriptor output = open_log(log_file_);
  std::vector<std::string> words = {program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);

  const pid_t parent = ::getpid();
  pid_ = ::fork();
  if (pid_ < 0) throw system_error("cannot start " + name_);
  if (pid_ == 0) {
    become(program.c_str(), pointers.data(), input.get(), output.get(), parent);
  }
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : name_(std::move(other.name_)),
      log_file_(std::move(other.log_file_)),
      pid_(std::exchange(other.pid_, -1)),
      start_s_(other.start_s_),
      exit_(other.exit_) {}

ChildProcess::~ChildProcess() {
  if (pid_ <= 0 || exit_) return;
  send_signal(SIGKILL);
  wait();
}

void ChildProcess::collect(int wait_options) {
  if (exit_ || pid_ <= 0) return;
  int status = 0;
  rusage usage{};
  pid_t found = 0;
  do {
    found = ::wait4(pid_, &status, wait_options, &usage);
  } while (found < 0 && errno == EINTR);
  if (found != pid_) return;
  ChildExit exit;
  if (WIFSIGNALED(status)) {
    exit.signal_number = WTERMSIG(status);
  } else {
    exit.exit_code = WEXITSTATUS(status);
  }
  exit.wall_s = support::monotonic_s() - start_s_;
  exit.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  exit_ = exit;
}

const std::optional<ChildExit>& ChildProcess::poll() {
  collect(WNOHANG);
  return exit_;
}

void ChildProcess::send_signal(int signal_number) {
  if (pid_ > 0 && !poll()) ::kill(pid_, signal_number);
}

void ChildProcess::wait() {
  collect(0);
}

std::string ChildProcess::last_line() const {
  std::ifstream file(log_file_);
  std::string last;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty()) last = line;
  }
  return last.substr(0, std::min(last.size(), kLongestLine));
}

}  // namespace topogeo::supervision
