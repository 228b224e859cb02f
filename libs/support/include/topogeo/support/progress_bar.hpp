// One line with the progress, the speed and the remaining time of a long job.
//
// The caller passes the time, so the bar has no clock. On a terminal the line is redrawn in place;
// elsewhere (a file, a pipe, a CI log) one line is printed about every tenth of the job.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

namespace topogeo::support {

/// Whether standard error is a terminal.
bool stderr_is_terminal();

class ProgressBar {
 public:
  /// `label` starts the line, `unit` names the counted items ("scans"). `out` must outlive the bar.
  ProgressBar(std::ostream& out, bool is_terminal, std::string label, std::string unit);

  /// `done` of `total` after `elapsed_s` seconds; total is 0 while unknown. Redraws a terminal at
  /// most ten times per second of elapsed time.
  void update(std::uint64_t done, std::uint64_t total, double elapsed_s);

  /// Draws the last state and ends the line.
  void finish(std::uint64_t done, std::uint64_t total, double elapsed_s);

 private:
  [[nodiscard]] std::string line(std::uint64_t done, std::uint64_t total, double elapsed_s) const;
  void draw(const std::string& text);

  std::ostream& out_;
  bool is_terminal_;
  std::string label_;
  std::string unit_;
  double next_draw_s_ = 0.0;
  std::uint64_t tenths_printed_ = 0;
  std::size_t drawn_length_ = 0;
};

}  // namespace topogeo::support
