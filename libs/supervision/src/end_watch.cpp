#include "topogeo/supervision/end_watch.hpp"

#include <cmath>
#include <filesystem>
#include <sstream>
#include <system_error>

#include <unistd.h>

#include "topogeo/support/format.hpp"
#include "topogeo/support/process_stat.hpp"
#include "topogeo/support/thread_times.hpp"

namespace topogeo::supervision {
namespace {

namespace fs = std::filesystem;

bool a_thread_waits_for_disk(const fs::path& process) {
  std::error_code error;
  for (fs::directory_iterator task(process / "task", error), end; !error && task != end;
       task.increment(error)) {
    std::string state;
    if (support::process_stat(task->path()) >> state && state == "D") return true;
  }
  return false;
}

/// User and system time in kernel ticks: coarse, but always available.
double ran_in_ticks_s(const fs::path& process) {
  std::istringstream fields = support::process_stat(process);
  constexpr int kBeforeTimes = 11;  // fields from the state to the one before utime
  std::string skipped;
  for (int i = 0; i < kBeforeTimes; ++i) fields >> skipped;
  double user = 0.0;
  double system = 0.0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

}  // namespace

Progress read_progress(pid_t pid) {
  const fs::path process = "/proc/" + std::to_string(pid);
  const support::ThreadTime time = support::sum_of(support::thread_times(process));
  Progress progress{time.ran_s, time.waited_s, 0, a_thread_waits_for_disk(process)};
  if (progress.ran_s == 0.0) progress.ran_s = ran_in_ticks_s(process);
  return progress;
}

EndWatch::Verdict EndWatch::check(const Progress& progress, double now_s) {
  // A thread that ends takes its times with it, which is progress, too.
  const double work_s =
      std::fabs(progress.ran_s - mark_.ran_s) + std::fabs(progress.waited_s - mark_.waited_s);
  if (work_s >= kLeastWork_s || progress.reports != mark_.reports || progress.waits_for_disk) {
    mark_ = progress;
    mark_s_ = now_s;
  }
  if (now_s - mark_s_ >= kHangs_s) {
    text_ = fmt::format("no work, no waiting for a CPU and no status for {:.0f} s", kHangs_s);
    return Verdict::kHangs;
  }
  if (now_s < report_s_) return Verdict::kWaits;
  text_ = fmt::format("it worked for {:.1f} s and waited {:.1f} s for a CPU in the last {:.0f} s{}",
                      std::fabs(progress.ran_s - reported_.ran_s),
                      std::fabs(progress.waited_s - reported_.waited_s),
                      now_s - report_s_ + kReportEvery_s,
                      progress.waits_for_disk ? ", and waits for a disk now" : "");
  reported_ = progress;
  report_s_ = now_s + kReportEvery_s;
  return Verdict::kReport;
}

}  // namespace topogeo::supervision
