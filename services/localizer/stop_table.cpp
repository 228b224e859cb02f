#include "stop_table.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "topogeo/pipeline/localization_run.hpp"

namespace topogeo::localizer {

StopTable::StopTable(std::filesystem::path file)
    : file_(std::move(file)), part_(file_.string() + ".part"), out_(part_) {
  out_ << pipeline::localization_csv_header();
  check();
}

void StopTable::add(Stops stops) {
  if (stops.added > 0) write(stops, stops.added - 1);
}

void StopTable::finish(Stops stops) {
  write(stops, stops.added);
  out_.close();
  check();
  std::filesystem::rename(part_, file_);
}

void StopTable::write(Stops stops, std::size_t end) {
  const std::size_t forgotten = stops.added - stops.known.size();
  const std::size_t begin = std::max(written_, forgotten);
  if (begin >= end) return;
  out_ << pipeline::localization_csv_rows(stops.known.subspan(begin - forgotten, end - begin));
  written_ = end;
}

void StopTable::check() const {
  if (!out_) throw std::runtime_error(part_.string() + ": cannot be written");
}

}  // namespace topogeo::localizer
