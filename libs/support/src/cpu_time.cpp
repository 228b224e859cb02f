#include "topogeo/support/cpu_time.hpp"

#include <algorithm>
#include <chrono>

#include <sys/resource.h>

namespace topogeo::support {
namespace {

double cpu_s(int who) {
  rusage usage{};
  getrusage(who, &usage);  // fails only for a wrong `who`
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace

double process_cpu_s() {
  return cpu_s(RUSAGE_SELF);
}

double children_cpu_s() {
  return cpu_s(RUSAGE_CHILDREN);
}

double monotonic_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

StageTimes::Scope::Scope(StageTimes& times, std::size_t index)
    : times_(times),
      index_(index),
      start_wall_s_(monotonic_s()),
      start_cpu_s_(cpu_s(RUSAGE_THREAD)) {}

StageTimes::Scope::~Scope() {
  StageTime& stage = times_.stages_[index_];
  stage.wall_s += monotonic_s() - start_wall_s_;
  stage.cpu_s += cpu_s(RUSAGE_THREAD) - start_cpu_s_;
}

StageTimes::Scope StageTimes::measure(std::string_view stage) {
  const auto known =
      std::ranges::find_if(stages_, [&](const StageTime& s) { return s.stage == stage; });
  const auto index = static_cast<std::size_t>(known - stages_.begin());
  if (known == stages_.end()) stages_.push_back({std::string(stage), 0.0, 0.0});
  return {*this, index};
}

}  // namespace topogeo::support
