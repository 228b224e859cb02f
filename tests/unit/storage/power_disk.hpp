// A disk that loses its power: an SQLite file system that records forced writes, so that a test can
// inspect the remaining files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "topogeo/support/random.hpp"

namespace topogeo::storage {

/// During its life all SQLite files that are opened go through it. Only one at a time.
class PowerDisk {
 public:
  /// `before_write` is called before each change of a file.
  explicit PowerDisk(std::function<void()> before_write);
  PowerDisk(const PowerDisk&) = delete;
  PowerDisk& operator=(const PowerDisk&) = delete;
  ~PowerDisk();

  /// Content of each file by path.
  using Files = std::map<std::string, std::string>;
  /// Files after a power failure now: everything forced to the disk, and a random selection, sector
  /// by sector, of later writes.
  [[nodiscard]] Files after_power_loss(support::Random& random, bool some_later_writes) const;

  void synced(const std::string& path);
  void removed(const std::string& path) { synced_.erase(path); }
  void before_write() const { before_write_(); }

 private:
  std::function<void()> before_write_;
  Files synced_;
};

}  // namespace topogeo::storage
