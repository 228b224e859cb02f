// Shows on one line how far a robot is from its goal.
//
// On a terminal the line is redrawn in place and messages about stops remain above it; elsewhere (a
// file, a pipe) each change has its own line, and so has every tenth second.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <optional>
#include <string>

#include "topogeo/navigation/navigator_inputs.hpp"

namespace topogeo::supervision {

/// "driving [####....]  50 %, 3.0 m to go, about 5 s", or the reason why the robot waits.
std::string progress_line(const navigation::NavigatorStatus& status);

class GoalProgress {
 public:
  /// `out` must outlive this object. `columns` of the terminal: longer lines are cut.
  GoalProgress(std::ostream& out, bool is_terminal, std::size_t columns = 80)
      : out_(out), is_terminal_(is_terminal), columns_(columns) {}

  /// The caller passes the time, in seconds from any start.
  void show(const navigation::NavigatorStatus& status, double now_s);
  /// Prints a line of its own.
  void print(const std::string& text);
  /// Ends the redrawn line, if there is one.
  void finish();

 private:
  void draw(const std::string& text);

  std::ostream& out_;
  bool is_terminal_;
  std::size_t columns_;
  std::optional<navigation::NavigatorStatus> last_;
  double due_s_ = 0.0;
  std::size_t drawn_ = 0;
};

/// Columns of the terminal at standard error; 80 if unknown.
std::size_t terminal_columns();

}  // namespace topogeo::supervision
