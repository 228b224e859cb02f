// Counts the runs of a service in a row that ended deaf, in a small file that outlives them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <utility>

#include "topogeo/service/service_options.hpp"

namespace topogeo::service {

class DeafLives {
 public:
  explicit DeafLives(std::filesystem::path file) : file_(std::move(file)) {}

  /// File of a service, see runtime_file().
  [[nodiscard]] static std::filesystem::path place_of(const Setup& setup);

  /// 0 when the file is missing or damaged.
  [[nodiscard]] std::uint32_t load() const;
  /// 0 removes the file. A failure to write is ignored: the next run waits less.
  void store(std::uint32_t lives) const;

 private:
  std::filesystem::path file_;
};

}  // namespace topogeo::service
