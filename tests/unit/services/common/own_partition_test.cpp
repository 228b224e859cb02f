#include "topogeo/service/own_partition.hpp"

#include <string>

#include <gmock/gmock.h>
#include <unistd.h>

namespace topogeo::service {
namespace {

TEST(OwnPartition, NamesItsPurposeAndOwner) {
  EXPECT_THAT(own_partition("show-mounting"),
              testing::StartsWith("show-mounting-" + std::to_string(::getpid()) + "-"));
}

// Two processes may have the same id, each in a container of its own.
TEST(OwnPartition, DiffersFromThoseOfTheSameProcessId) {
  EXPECT_NE(own_partition("run"), own_partition("run"));
}

}  // namespace
}  // namespace topogeo::service
