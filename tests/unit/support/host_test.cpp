#include "topogeo/support/host.hpp"

#include <array>
#include <cstdlib>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

namespace topogeo::support {
namespace {

/// A PID namespace with one process, as in a container with the name of its host.
class Container {
 public:
  Container() {
    std::array<int, 2> answer{};
    std::array<int, 2> life{};
    if (::pipe(answer.data()) != 0 || ::pipe(life.data()) != 0) return;
    maker_ = ::fork();
    if (maker_ == 0) {
      ::close(life[1]);
      make(answer[1], life[0]);
    }
    ::close(answer[1]);
    ::close(life[0]);
    life_ = life[1];
    std::array<char, 64> name{};
    const ssize_t size = ::read(answer[0], name.data(), name.size());
    ::close(answer[0]);
    if (size > 0) name_.assign(name.data(), static_cast<std::size_t>(size));
  }
  Container(const Container&) = delete;
  Container& operator=(const Container&) = delete;
  ~Container() {
    ::close(life_);
    ::waitpid(maker_, nullptr, 0);
  }

  /// That of its first process; empty: no namespace may be made here.
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  /// The first process answers with its name, and lives until `life` is closed.
  [[noreturn]] static void make(int answer, int life) {
    const int user = ::geteuid() == 0 ? 0 : CLONE_NEWUSER;
    if (::unshare(CLONE_NEWPID | user) != 0) std::_Exit(1);
    const pid_t first = ::fork();
    if (first == 0) {
      const std::string name = process_name();
      char end = 0;
      const bool answered = ::write(answer, name.data(), name.size()) > 0;
      std::_Exit(answered && ::read(life, &end, 1) == 0 ? 0 : 1);
    }
    ::close(answer);
    ::waitpid(first, nullptr, 0);
    std::_Exit(0);
  }

  pid_t maker_ = -1;
  int life_ = -1;
  std::string name_;
};

TEST(ProcessName, HasHostAndProcess) {
  EXPECT_THAT(process_name(), testing::HasSubstr("-" + std::to_string(::getpid())));
  EXPECT_THAT(process_name(), testing::StartsWith(host_name().substr(0, 8)));
  EXPECT_LE(process_name().size(), 50U);
}

// Each is process 1 of its container.
TEST(ProcessName, DiffersBetweenContainersWithTheNameOfTheHost) {
  const Container one;
  const Container other;
  if (one.name().empty()) GTEST_SKIP() << "no PID namespace can be made; root makes it run";
  EXPECT_THAT(one.name(), testing::HasSubstr("-1."));
  EXPECT_THAT(other.name(), testing::HasSubstr("-1."));
  EXPECT_NE(one.name(), other.name());
}

}  // namespace
}  // namespace topogeo::support
