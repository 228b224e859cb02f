#include "map_store/disk_room.hpp"

#include <array>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/support/temporary_folder.hpp"

#include "full_disk.hpp"

namespace topogeo::map_store {
namespace {

namespace fs = std::filesystem;

class DiskRoom : public testing::Test {
 protected:
  [[nodiscard]] bool have(const fs::path& directory) const {
    return have_room(std::array{folder_.path(), directory});
  }
  [[nodiscard]] fs::path path(const std::string& name) const { return folder_.path() / name; }

 private:
  support::TemporaryFolder folder_{"disk_room"};
};

TEST_F(DiskRoom, IsThereOrNot) {
  EXPECT_TRUE(have(path("made/of/it")));
  {
    const test::FullDisk full(10'000);
    EXPECT_FALSE(have(path("made")));
  }
  EXPECT_TRUE(have(path("made")));
  EXPECT_TRUE(fs::is_empty(path("made/of/it"))) << "it leaves nothing";
}

// Waiting cannot cure other faults.
TEST_F(DiskRoom, IsNotTheMatterOfOtherFaults) {
  std::ofstream(path("file")) << "x";
  EXPECT_TRUE(have(path("file")));
  EXPECT_TRUE(have(path("file/below")));
}

}  // namespace
}  // namespace topogeo::map_store
