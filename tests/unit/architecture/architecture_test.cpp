// The permitted dependencies in this source tree (docs/architecture.md, "Rules").
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "source_rules.hpp"

namespace topogeo::architecture {
namespace {

using testing::IsEmpty;

const std::vector<Include>& project_includes() {
  static const std::vector<Include> kIncludes =
      includes_below(TOPOGEO_SOURCE_DIR, {"libs", "services"});
  return kIncludes;
}

/// Libraries that take seconds to compile or belong to one layer. A public header in the list is
/// the only access to the library.
const std::vector<RestrictedLibrary>& restricted_libraries() {
  static const std::vector<RestrictedLibrary> kLibraries = {
      {"fastdds/",
       {"libs/messaging/src/", "libs/messaging/include/topogeo/messaging/detail/fast_dds.hpp",
        "libs/messaging/include/topogeo/messaging/detail/type_support.hpp",
        "libs/map_client/include/topogeo/map_client/map_reader.hpp"}},
      {"topogeo/messaging/detail/fast_dds.hpp",
       {"libs/messaging/src/", "libs/messaging/include/topogeo/messaging/detail/type_support.hpp"}},
      {"topogeo/messaging/detail/type_support.hpp",
       {"libs/messaging/src/", "libs/ros_messaging/src/"}},
      {"fastcdr/", {"libs/messaging/src/"}},
      {"topogeo/msg/type_supports.h", {"libs/messaging/src/"}},
      {"topogeo/ros2/type_supports.h", {"libs/ros_messaging/src/"}},
      {"CLI/",
       {"libs/command_line/src/command_line.cpp", "libs/command_line/src/generated_help.cpp",
        "libs/command_line/src/help_format.cpp"}},
      {"SQLiteCpp/", {"libs/storage/src/"}},
      {"sqlite3.h", {"libs/recording/src/", "libs/sqlite_guard/src/", "libs/storage/src/"}},
      {"google/protobuf/", {"libs/storage/src/"}},
      {"proto/map.pb.h", {"libs/storage/src/"}},
      {"ceres/", {"libs/calibration/src/", "libs/slam/src/"}},
      {"boost/", {}},
      {"bzlib.h", {"libs/recording/src/"}},
      {"lz4frame.h", {"libs/recording/src/"}},
      {"zstd.h", {"libs/recording/src/"}},
      {"boost/asio",
       {"services/common/src/http_server.cpp", "services/common/src/web_access.cpp",
        "services/sensor_gateway/datagram_stream.cpp",
        "services/sensor_gateway/datagram_stream.hpp", "services/sensor_gateway/port_stream.hpp",
        "services/sensor_gateway/serial_port.cpp", "services/sensor_gateway/serial_stream.cpp",
        "services/sensor_gateway/serial_stream.hpp", "services/sensor_gateway/tcp_stream.cpp",
        "services/sensor_gateway/tcp_stream.hpp", "services/web/server/connection.hpp",
        "services/web/server/http_session.cpp", "services/web/server/http_session.hpp",
        "services/web/server/server.cpp", "services/web/server/viewer.hpp"}},
      {"boost/beast/",
       {"services/common/src/http_server.cpp", "services/web/server/connection.hpp",
        "services/web/server/http_session.cpp", "services/web/server/http_session.hpp",
        "services/web/server/watcher.cpp", "services/web/server/watcher.hpp"}},
      {"boost/geometry/", {"libs/planning/src/", "libs/topomap/src/"}},
      {"boost/graph/", {"libs/planning/src/", "libs/slam/src/"}},
      {"boost/iterator/", {"libs/planning/src/"}},
      {"boost/property_map/", {"libs/planning/src/", "libs/slam/src/"}},
      {"cairo", {"libs/render/src/"}},
      {"yaml-cpp/", {"libs/recording/src/", "libs/support/src/"}},
      {"nlohmann/",
       {"libs/exchange/src/", "libs/storage/src/", "libs/support/src/", "services/topogeo/",
        "services/web/server/json_values.hpp"}},
      {"GeographicLib/", {"libs/exchange/src/geojson_frame.cpp"}},
      {"png.h", {"libs/exchange/src/", "services/web/channels/palette_png.cpp"}},
      {"prometheus/", {"services/common/src/metrics_endpoint.cpp"}},
      {"pugixml", {"libs/exchange/src/"}},
      {"zlib.h",
       {"libs/recording/src/", "libs/scan/src/", "libs/storage/src/",
        "services/web/server/page_files.cpp"}},
      {"fmt/", {"libs/support/include/topogeo/support/format.hpp"}},
      {"spdlog/", {"libs/support/include/topogeo/support/log.hpp", "libs/support/src/"}},
  };
  return kLibraries;
}

TEST(Architecture, LibrariesUseThoseBeforeThem) {
  EXPECT_THAT(against_order(project_includes(),
                            libraries_in_order(std::filesystem::path(TOPOGEO_SOURCE_DIR) /
                                               "libs/CMakeLists.txt")),
              IsEmpty());
}

TEST(Architecture, LargeLibrariesAreIncludedInNamedPlaces) {
  EXPECT_THAT(out_of_place(project_includes(), restricted_libraries()), IsEmpty());
}

TEST(Architecture, ServicesDoNotIncludeEachOther) {
  // `topogeo config --devices` prints these settings, `topogeo devices` searches these ports.
  EXPECT_THAT(between_services(TOPOGEO_SOURCE_DIR, project_includes(),
                               {"services/sensor_gateway/device_config.hpp",
                                "services/sensor_gateway/serial_line.hpp"}),
              IsEmpty());
}

TEST(Architecture, TheProductDoesNotIncludeResearch) {
  EXPECT_THAT(uses_of_research(TOPOGEO_SOURCE_DIR, project_includes()), IsEmpty());
}

TEST(Architecture, SettingsIncludeNoAlgorithm) {
  EXPECT_THAT(algorithms_in_settings(project_includes()), IsEmpty());
}

TEST(Architecture, PublicHeadersAreUsedByOthers) {
  EXPECT_THAT(
      unused_public_headers(TOPOGEO_SOURCE_DIR, project_includes(),
                            {"calibration", "matching", "relocalization", "session", "slam"}),
      IsEmpty());
}

TEST(Architecture, TestsSleepForAReason) {
  for (const char* folder : {"tests", "research"}) {
    EXPECT_THAT(sleeps_without_reason(TOPOGEO_SOURCE_DIR, folder), IsEmpty());
  }
}

TEST(Architecture, EachFolderThatIsNamedIsUsed) {
  for (const RestrictedLibrary& library : restricted_libraries()) {
    for (const std::string_view place : library.places) {
      if (!place.ends_with('/')) continue;
      EXPECT_TRUE(std::ranges::any_of(project_includes(),
                                      [&](const Include& include) {
                                        return include.file.starts_with(place) &&
                                               include.header.starts_with(library.headers);
                                      }))
          << place << " does not include " << library.headers;
    }
  }
}

}  // namespace
}  // namespace topogeo::architecture
