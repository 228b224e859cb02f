#include "program.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <functional>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include "topogeo/scan/carmen_log_writer.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/storage/tum.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::test {
namespace {

constexpr int kSignalBase = 128;

std::string test_name() {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  std::string name = std::string(test->test_suite_name()) + "." + test->name();
  for (char& c : name) {
    if (c == '/') c = '_';
  }
  return name;
}

// Tests run in parallel, and a worker that serves every partition would also serve another test.
// The lock is released with the process, however it ends.
int claim_domain() {
  // The ports of higher domains overlap with the system's range for clients.
  constexpr std::size_t kDomains = 100;
  const std::size_t first = std::hash<std::string>{}(test_name()) % kDomains;
  for (std::size_t i = 0; i < kDomains; ++i) {
    const auto domain = static_cast<int>(1 + (first + i) % kDomains);
    const auto file = std::filesystem::temp_directory_path() /
                      ("topogeo_test_domain_" + std::to_string(domain) + ".lock");
    const int lock = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (lock < 0) continue;
    if (::flock(lock, LOCK_EX | LOCK_NB) == 0) return domain;
    ::close(lock);
  }
  throw std::runtime_error("no free DDS domain from 1 to 100 for a test");
}

/// Copies regular files and folders. Others, such as sockets and links to serial lines, are useless
/// later.
void copy_tree(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code ignored;
  std::filesystem::create_directories(to, ignored);
  for (const auto& entry : std::filesystem::directory_iterator(from, ignored)) {
    const auto target = to / entry.path().filename();
    if (entry.is_symlink(ignored)) continue;
    if (entry.is_directory(ignored)) {
      copy_tree(entry.path(), target);
    } else if (entry.is_regular_file(ignored)) {
      std::filesystem::copy_file(entry.path(), target, ignored);
    }
  }
}

/// Keeps the files of a failed test, including logs of services, for `./run test`.
void keep_files(const std::filesystem::path& folder) {
  const auto failed = std::filesystem::path(TOPOGEO_BIN).parent_path() / "tests" / "failed";
  const std::string name = std::string(::program_invocation_short_name) + "." + test_name();
  auto kept = failed / name;
  for (int i = 2; std::filesystem::exists(kept); ++i) {
    kept = failed / (name + "_" + std::to_string(i));
  }
  copy_tree(folder, kept);
  std::fprintf(stderr, "kept: %s\n", kept.c_str());
}

}  // namespace

Scratch::Scratch()
    : path_(std::filesystem::temp_directory_path() /
            ("topogeo_" + test_name() + "_" + std::to_string(::getpid()))) {
  std::filesystem::remove_all(path_);
  std::filesystem::create_directories(path_);
}

Scratch::~Scratch() {
  // A thrown exception becomes a test failure only after this.
  if (testing::Test::HasFailure() || std::uncaught_exceptions() > 0) {
    try {
      keep_files(path_);
    } catch (const std::filesystem::filesystem_error& error) {
      std::fprintf(stderr, "cannot keep the files of the test: %s\n", error.what());
    }
  }
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

Program::Program(const Scratch& scratch, const std::string& name,
                 const std::vector<std::string>& words)
    : name_(name) {
  static int count = 0;
  const std::string number = std::to_string(++count);
  out_ = scratch / ("stdout" + number);
  err_ = scratch / ("stderr" + number);
  std::vector<std::string> all = {std::string(TOPOGEO_BIN) + "/" + name};
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> pointers;
  pointers.reserve(all.size() + 1);
  for (std::string& word : all) pointers.push_back(word.data());
  pointers.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out_.c_str(), kFlags, 0644);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err_.c_str(), kFlags, 0644);
  std::string freeze = "TOPOGEO_LONGEST_FREEZE_S=0";
  std::vector<char*> variables;
  bool decided = name == "topogeo";  // which starts services again
  for (char** one = environ; *one != nullptr; ++one) {
    variables.push_back(*one);
    decided = decided || std::string_view(*one).starts_with("TOPOGEO_LONGEST_FREEZE_S=");
  }
  if (!decided) variables.push_back(freeze.data());
  variables.push_back(nullptr);
  const int error =
      posix_spawn(&pid_, pointers[0], &actions, nullptr, pointers.data(), variables.data());
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::runtime_error("cannot start " + all[0]);
}

Program::~Program() {
  if (ended()) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, &status_, 0);
}

bool Program::ended() {
  if (!ended_) ended_ = ::waitpid(pid_, &status_, WNOHANG) == pid_;
  return ended_;
}

template <class Condition>
bool Program::wait_while_it_works(const std::string& what, const Condition& condition) {
  Wait wait(what);
  std::uintmax_t printed_bytes = 0;
  return wait_for(wait, condition, [&] {
    const std::uintmax_t now_bytes =
        std::filesystem::file_size(out_) + std::filesystem::file_size(err_);
    if (std::exchange(printed_bytes, now_bytes) != now_bytes) wait.renew();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));  // between two checks
  });
}

int Program::wait() {
  if (!wait_while_it_works("the end of " + name_, [this] { return ended(); })) {
    throw std::runtime_error(name_ + " does not end; its stderr: " + err());
  }
  return WIFSIGNALED(status_) ? kSignalBase + WTERMSIG(status_) : WEXITSTATUS(status_);
}

void Program::wait_for_error_text(const std::string& text) {
  const auto printed = [&] { return err().find(text) != std::string::npos; };
  const bool there =
      wait_while_it_works(name_ + " to print '" + text + "'", [&] { return printed() || ended(); });
  if (!there || !printed()) {
    throw std::runtime_error(name_ + " never printed '" + text + "', its stderr: " + err());
  }
}

void Program::wait_for_progress(int percent) {
  // "mapping [###...]  22 % 240/1049 scans, ...", among other lines
  static const std::regex bar(R"(\] +(\d+) %)");
  const auto reached = [&] {
    const std::string text = err();
    const std::sregex_iterator bars(text.begin(), text.end(), bar);
    return std::any_of(bars, std::sregex_iterator(),
                       [&](const std::smatch& found) { return std::stoi(found[1]) >= percent; });
  };
  const std::string goal = std::to_string(percent) + " %";
  const bool there =
      wait_while_it_works(name_ + " to do " + goal, [&] { return reached() || ended(); });
  const auto ended_well = [&] {
    return ended() && WIFEXITED(status_) && WEXITSTATUS(status_) == 0;
  };
  if (!there || (!reached() && !ended_well())) {
    throw std::runtime_error(name_ + " never did " + goal + ", its stderr: " + err());
  }
}

void Program::send_signal(int signal_number) const {
  ::kill(pid_, signal_number);
}

std::string Program::out() const {
  return read_file(out_);
}

std::string Program::err() const {
  return read_file(err_);
}

std::vector<pid_t> Program::services(const std::string& name) const {
  const std::string partition = "run-" + std::to_string(pid_) + "-";
  std::vector<pid_t> found;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", ignored)) {
    const std::string number = entry.path().filename().string();
    if (number.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string words = read_file(entry.path() / "cmdline");
    if (words.find(partition) == std::string::npos) continue;
    const std::string program = std::filesystem::path(words.c_str()).filename().string();
    if (name.empty() || program == name) found.push_back(std::stoi(number));
  }
  return found;
}

std::string read_file(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

void print_lines_with(const std::string& part, const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.find(part) != std::string::npos) std::printf("%s\n", line.c_str());
  }
}

std::string own_domain() {
  static const int domain = claim_domain();
  return std::to_string(domain);
}

void use_udp_only() {
  ::setenv("TOPOGEO_DDS_PARTICIPANT", "udp_only", 1);
}

void set_longest_freeze(unsigned seconds) {
  ::setenv("TOPOGEO_LONGEST_FREEZE_S", std::to_string(seconds).c_str(), 1);
}

bool issue_keys(const std::filesystem::path& directory, const std::string& what) {
  constexpr int kNoOpenssl = 77;
  const std::string make = "command -v openssl >/dev/null || exit " + std::to_string(kNoOpenssl) +
                           "; '" TOPOGEO_SOURCE_DIR "/deploy/security/make_keys' '" +
                           directory.string() + "' issue " + what + " >/dev/null 2>&1";
  const int status = std::system(make.c_str());  // NOLINT(*-env33-c,concurrency-mt-unsafe)
  if (status == 0) return true;
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNoOpenssl) return false;
  throw std::runtime_error("failed: " + make);
}

void write_log(const std::string& world, const std::filesystem::path& log,
               const std::filesystem::path& truth, const simulation::SimulationOptions& options,
               const geometry::Pose2& stated) {
  const auto file = std::filesystem::path(TOPOGEO_SHARE) / "worlds" / (world + ".world.yaml");
  const auto simulated = simulation::simulate_log(world::load_world(file), options);
  scan::CarmenLogWriter writer(log, stated);
  std::vector<topomap::StampedPose> poses;
  for (std::size_t i = 0; i < simulated.scans.size(); ++i) {
    writer.write(simulated.scans[i]);
    poses.push_back(
        {simulated.scans[i].sequence, simulated.scans[i].stamp_ns, simulated.T_world_robot[i]});
  }
  writer.close();
  if (!truth.empty()) storage::write_trajectory_tum(truth, poses);
}

}  // namespace topogeo::test
