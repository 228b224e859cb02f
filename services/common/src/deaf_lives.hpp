// How many lives of a service in a row have ended deaf, in a small file that outlives them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <utility>

#include "topogeo/service/service_options.hpp"

namespace topogeo::service {

class DeafLives {
 public:
  explicit DeafLives(std::filesystem::path file) : file_(std::move(file)) {}

  /// Where a service keeps it: in the runtime directory that systemd gives it, else in memory
  /// (/dev/shm), where `topogeo run` removes what is kept of its partition.
  [[nodiscard]] static std::filesystem::path place_of(const Setup& setup);

  /// 0 where there is no file, or one that is damaged.
  [[nodiscard]] std::uint32_t load() const;
  /// 0 removes the file. What cannot be kept is lost: the next life waits less.
  void store(std::uint32_t lives) const;

 private:
  std::filesystem::path file_;
};

}  // namespace topogeo::service
