// Protection against untrusted SQLite files, after https://www.sqlite.org/security.html: the
// contents of a file must not run as a program, nor take more time and memory than its size
// explains.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

struct sqlite3;

namespace topogeo::sqlite_guard {

/// Rows and blobs beyond this size, in bytes, cannot be read.
inline constexpr int kLargestBlob = 256'000'000;

/// Throws std::runtime_error if the file, or a log that SQLite would read beside it, is a
/// directory, FIFO or device. A missing file is no fault.
void refuse_irregular(const std::filesystem::path& path);

/// Size of the file and of its write-ahead log; 0 if unknown.
[[nodiscard]] std::uint64_t bytes_of(const std::filesystem::path& path);

/// Sets a new connection up: the schema is not trusted, no trigger and no view runs, the file
/// format cannot be changed, blobs have a limit. Call it before the first statement.
void protect(sqlite3* database);

/// The first part of the schema that no map and no recording has, such as "the view 'topics'".
/// Empty if there is none, or if the schema cannot be read, which the next statement reports.
[[nodiscard]] std::string refused_schema(sqlite3* database);

/// Interrupts the statements of a connection (SQLITE_INTERRUPT) once they have taken more steps
/// than reading all of a sound file takes: a damaged file can lead from page to page without end.
/// Only one at a time for each connection, which must outlive it.
class WorkLimit {
 public:
  /// `file_bytes`: size of the file.
  WorkLimit(sqlite3* database, std::uint64_t file_bytes);
  WorkLimit(const WorkLimit&) = delete;
  WorkLimit& operator=(const WorkLimit&) = delete;
  ~WorkLimit();

  [[nodiscard]] bool reached() const { return steps_left_ == 0; }

 private:
  static int step(void* self);

  sqlite3* database_;
  std::uint64_t steps_left_;  // of kInstructions each
};

/// "takes more work than an intact file of its size".
extern const char* const kTooMuchWork;

}  // namespace topogeo::sqlite_guard
