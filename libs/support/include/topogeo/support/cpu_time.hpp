// Wall and CPU time per stage of the work, for the report only: no result may depend on it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace topogeo::support {

/// CPU time (user and system) of this process with all its threads, seconds.
double process_cpu_s();

/// CPU time of terminated child processes that were waited for, seconds.
double children_cpu_s();

/// Monotonic time from an arbitrary start, seconds.
double monotonic_s();

struct StageTime {
  std::string stage;
  double wall_s = 0.0;
  double cpu_s = 0.0;
};

/// Sums up the time of stages that are entered many times. For one thread: it counts the CPU time
/// of the calling thread, without work that a stage delegates to other threads.
class StageTimes {
 public:
  /// Adds the time of its lifetime to the stage.
  class Scope {
   public:
    Scope(StageTimes& times, std::size_t index);
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    ~Scope();

   private:
    StageTimes& times_;
    std::size_t index_;
    double start_wall_s_;
    double start_cpu_s_;
  };

  /// Times the named stage until the returned object is destroyed, which must be before this one.
  [[nodiscard]] Scope measure(std::string_view stage);

  /// In the order of first use.
  [[nodiscard]] const std::vector<StageTime>& stages() const { return stages_; }

 private:
  std::vector<StageTime> stages_;
};

}  // namespace topogeo::support
