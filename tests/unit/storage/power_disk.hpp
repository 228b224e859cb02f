// A disk that loses its power: an SQLite file system that remembers what was forced to the disk, so
// that a test can look at what would be left.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "topogeo/support/random.hpp"

namespace topogeo::storage {

/// While it lives all SQLite files that are opened go through it. One at a time.
class PowerDisk {
 public:
  /// `before_write` is called before each change of a file.
  explicit PowerDisk(std::function<void()> before_write);
  PowerDisk(const PowerDisk&) = delete;
  PowerDisk& operator=(const PowerDisk&) = delete;
  ~PowerDisk();

  /// Content of each file by path.
  using Files = std::map<std::string, std::string>;
  /// What is left when the power goes now: what was forced to the disk, and of later writes, sector
  /// by sector, what chance brings.
  [[nodiscard]] Files after_power_loss(support::Random& random, bool some_later_writes) const;

  void synced(const std::string& path);
  void removed(const std::string& path) { synced_.erase(path); }
  void before_write() const { before_write_(); }

 private:
  std::function<void()> before_write_;
  Files synced_;
};

}  // namespace topogeo::storage
