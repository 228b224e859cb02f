// How far a robot is on its way, in one line.
//
// On a terminal the line is redrawn in place and what stops the robot stays above it; elsewhere (a
// file, a pipe) there is a line for each change and one every ten seconds.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <optional>
#include <string>

#include "topogeo/msg/planning.h"

namespace topogeo::cli {

/// "driving [####....]  50 %, 3.0 m of 6.0 m, 5 s left", or what it waits for.
std::string progress_line(const msg::NavigatorStatus& status);

class GoalProgress {
 public:
  /// `out` must outlive it. `columns` of the terminal: longer lines are cut.
  GoalProgress(std::ostream& out, bool is_terminal, std::size_t columns = 80)
      : out_(out), is_terminal_(is_terminal), columns_(columns) {}

  /// The caller passes the time, in seconds from any start.
  void show(const msg::NavigatorStatus& status, double now_s);
  /// A line of its own.
  void say(const std::string& text);
  /// Ends the line that is redrawn, if one is.
  void finish();

 private:
  void draw(const std::string& text);

  std::ostream& out_;
  bool is_terminal_;
  std::size_t columns_;
  std::optional<msg::NavigatorStatus> last_;
  double due_s_ = 0.0;
  std::size_t drawn_ = 0;
};

/// Columns of the terminal at standard error; 80 when it does not say.
std::size_t terminal_columns();

}  // namespace topogeo::cli
