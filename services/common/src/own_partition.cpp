#include "topogeo/service/own_partition.hpp"

#include <random>

#include <unistd.h>

#include "topogeo/support/format.hpp"

namespace topogeo::service {

std::string own_partition(std::string_view purpose) {
  return fmt::format("{}-{}-{:08x}", purpose, ::getpid(), std::random_device{}());
}

}  // namespace topogeo::service
