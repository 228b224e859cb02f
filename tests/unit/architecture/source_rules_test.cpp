#include "source_rules.hpp"

#include <fstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::architecture {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A source tree of a few files, removed at the end of the test.
class SourceRules : public testing::Test {
 protected:
  SourceRules() : root_(std::filesystem::path(testing::TempDir()) / "source_rules") {
    std::filesystem::remove_all(root_);
    write("libs/CMakeLists.txt",
          "# In order.\nforeach(lib geometry scan\n            messaging)\n"
          "  add_subdirectory(${lib})\nendforeach()\n");
    write("libs/scan/README.md", "#include \"topogeo/messaging/reader.hpp\"\n");
  }
  ~SourceRules() override { std::filesystem::remove_all(root_); }

  void write(const std::string& file, const std::string& text) const {
    std::filesystem::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text;
  }
  [[nodiscard]] std::vector<Include> includes() const {
    std::vector<std::string> folders = {"libs"};
    if (exists(root_ / "services")) folders.emplace_back("services");
    return includes_below(root_, folders);
  }
  [[nodiscard]] std::vector<std::string> order() const {
    return against_order(includes(), libraries_in_order(root_ / "libs/CMakeLists.txt"));
  }

  std::filesystem::path root_;
};

TEST_F(SourceRules, ReadsIncludesOfSourcesAlone) {
  write("libs/scan/src/a.cpp",
        "// #include <no>\n#include <vector>\n  # include \"b.hpp\"  // why\nint x;\n");
  const std::vector<Include> found = includes();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].file, "libs/scan/src/a.cpp");
  EXPECT_EQ(found[0].line, 2);
  EXPECT_EQ(found[0].header, "vector");
  EXPECT_EQ(found[1].line, 3);
  EXPECT_EQ(found[1].header, "b.hpp");
}

TEST_F(SourceRules, RefusesATreeThatIsNotThere) {
  EXPECT_THROW(includes_below(root_, {"none"}), std::runtime_error);
  EXPECT_THROW(libraries_in_order(root_ / "none"), std::runtime_error);
  EXPECT_THROW(libraries_in_order(root_ / "libs/scan/README.md"), std::runtime_error);
}

TEST_F(SourceRules, ReadsTheOrderOfLibraries) {
  EXPECT_THAT(libraries_in_order(root_ / "libs/CMakeLists.txt"),
              ElementsAre("geometry", "scan", "messaging"));
}

TEST_F(SourceRules, LibrariesIncludeThoseBefore) {
  write("libs/scan/src/good.cpp",
        "#include \"topogeo/scan/scan.hpp\"\n#include \"topogeo/geometry/pose2.hpp\"\n");
  write("libs/messaging/src/good.cpp", "#include \"topogeo/msg/scan.h\"\n");
  EXPECT_THAT(order(), IsEmpty());
}

TEST_F(SourceRules, FindsALibraryThatIncludesOneAfterItself) {
  write("libs/geometry/include/topogeo/geometry/pose2.hpp",
        "#pragma once\n#include \"topogeo/scan/scan.hpp\"\n");
  write("libs/scan/src/bad.cpp",
        "#include \"topogeo/msg/scan.h\"\n#include \"topogeo/service/service.hpp\"\n");
  write("libs/forgotten/src/a.cpp", "#include \"topogeo/geometry/pose2.hpp\"\n");
  EXPECT_THAT(
      order(),
      ElementsAre("libs/forgotten/src/a.cpp:1: includes topogeo/geometry/pose2.hpp, but "
                  "'forgotten' is not in libs/CMakeLists.txt",
                  "libs/geometry/include/topogeo/geometry/pose2.hpp:2: includes "
                  "topogeo/scan/scan.hpp, but 'scan' does not stand before 'geometry' in "
                  "libs/CMakeLists.txt",
                  HasSubstr("bad.cpp:1: includes topogeo/msg/scan.h, but 'msg'"),
                  HasSubstr("bad.cpp:2: includes topogeo/service/service.hpp, but 'service'")));
}

TEST_F(SourceRules, FindsARestrictedLibraryOutOfItsPlace) {
  write("libs/scan/src/graph.cpp", "#include <boost/graph/dijkstra.hpp>\n");
  write("libs/scan/include/topogeo/scan/a.hpp", "#include <boost/graph/dijkstra.hpp>\n");
  write("libs/geometry/src/a.cpp",
        "#include <boost/graph/dijkstra.hpp>\n#include <boost/any.hpp>\n");
  write("libs/geometry/include/topogeo/geometry/small.hpp", "#include <boost/container/x.hpp>\n");
  const std::vector<RestrictedLibrary> libraries = {
      {"boost/", {}},
      {"boost/graph/", {"libs/scan/"}},
      {"boost/container/", {"libs/geometry/include/topogeo/geometry/small.hpp"}}};
  EXPECT_THAT(
      out_of_place(includes(), libraries),
      ElementsAre("libs/geometry/src/a.cpp:1: includes boost/graph/dijkstra.hpp, expected in "
                  "libs/scan/",
                  "libs/geometry/src/a.cpp:2: includes boost/any.hpp, expected in",
                  HasSubstr("libs/scan/include/topogeo/scan/a.hpp:1: includes boost/graph/")));
}

TEST_F(SourceRules, FindsAServiceThatIncludesAnother) {
  write("services/common/include/topogeo/service/service.hpp", "");
  write("services/planner/answer.hpp", "");
  write("services/planner/job.hpp", "");
  write("services/planner/main.cpp",
        "#include \"answer.hpp\"\n#include \"topogeo/service/service.hpp\"\n");
  write("services/worker/job.hpp", "");
  write("services/planner/map/sheet.hpp", "");  // a folder with the name of a standard header
  write("services/worker/main.cpp",
        "#include \"job.hpp\"\n#include \"answer.hpp\"\n#include <map>\n");
  EXPECT_THAT(between_services(root_, includes(), {}),
              ElementsAre("services/worker/main.cpp:2: includes answer.hpp, a header of "
                          "services/planner"));
  EXPECT_THAT(between_services(root_, includes(), {"services/planner/answer.hpp"}), IsEmpty());
}

TEST_F(SourceRules, FindsTheProductThatIncludesResearch) {
  write("research/thesis/include/topogeo/thesis/slam.hpp", "");
  write("research/reproduce/report.hpp", "#include \"topogeo/thesis/slam.hpp\"\n");
  write("libs/scan/src/a.cpp", "#include \"topogeo/thesis/slam.hpp\"\n#include \"scan.hpp\"\n");
  write("services/web/main.cpp", "#include \"reproduce/report.hpp\"\n");
  EXPECT_THAT(uses_of_research(root_, includes_below(root_, {"libs", "research", "services"})),
              ElementsAre("libs/scan/src/a.cpp:1: includes topogeo/thesis/slam.hpp, a header of "
                          "research/",
                          HasSubstr("services/web/main.cpp:1: includes reproduce/report.hpp")));
}

TEST_F(SourceRules, FindsSettingsThatIncludeAnAlgorithm) {
  write("libs/scan/include/topogeo/scan/reader_config.hpp",
        "#include <cstdint>\n#include <Eigen/Core>\n#include \"topogeo/geometry/pose2.hpp\"\n"
        "#include \"topogeo/scan/filter_config.hpp\"\n#include \"topogeo/scan/reader.hpp\"\n"
        "#include <yaml-cpp/yaml.h>\n");
  write("libs/scan/include/topogeo/scan/reader.hpp", "#include \"topogeo/scan/filter.hpp\"\n");
  EXPECT_THAT(algorithms_in_settings(includes()),
              ElementsAre(HasSubstr("reader_config.hpp:5: includes topogeo/scan/reader.hpp"),
                          HasSubstr("reader_config.hpp:6: includes yaml-cpp/yaml.h")));
}

TEST_F(SourceRules, FindsASleepWithoutItsReason) {
  write("tests/good.cpp",
        "// Pacing: one packet each.\nsleep_for(period);\n"
        "usleep(5);  // the event is that nothing comes\n// sleep_for(1) is no code\n");
  EXPECT_THAT(sleeps_without_reason(root_, "tests"), IsEmpty());
  write("tests/unit/bad.hpp",
        "int x;  // a comment\nint y;\nstd::this_thread::sleep_until(end);\n");
  EXPECT_THAT(sleeps_without_reason(root_, "tests"),
              ElementsAre(HasSubstr("tests/unit/bad.hpp:3: sleeps")));
}

TEST_F(SourceRules, FindsASleepOfEveryLanguageOfTheTests) {
  write("tests/good.py", "time.sleep(0.1)  # between two checks\nrun('exec sleep 1000')\n");
  write("tests/good.mjs", "// Pacing of the page.\nsetTimeout(again, 100);\n");
  write("tests/good.sh",
        "until ready; do sleep 0.2; done  # between two checks\nunshare sleep infinity\n");
  write("tests/good", "no program: sleep 1\n");
  EXPECT_THAT(sleeps_without_reason(root_, "tests"), IsEmpty());
  write("tests/bad.py", "import time\ntime.sleep(5)\n");
  write("tests/bad.mjs", "await page.waitForTimeout(500);\n");
  write("tests/bad.sh", "start\nsleep \"$seconds\"\n");
  write("tests/bad", "#!/usr/bin/env bash\nstart\nuntil ready; do sleep 1; done\n");
  EXPECT_THAT(sleeps_without_reason(root_, "tests"),
              ElementsAre(HasSubstr("tests/bad:3:"), HasSubstr("tests/bad.mjs:1:"),
                          HasSubstr("tests/bad.py:2:"), HasSubstr("tests/bad.sh:2:")));
}

TEST_F(SourceRules, FindsPublicHeadersThatOnlyTheirLibraryUses) {
  write("libs/scan/include/topogeo/scan/scan.hpp", "#include \"topogeo/scan/beam.hpp\"\n");
  write("libs/scan/include/topogeo/scan/beam.hpp", "#include <vector>\n");
  write("libs/scan/include/topogeo/scan/inner.hpp", "#include \"topogeo/scan/deep.hpp\"\n");
  write("libs/scan/include/topogeo/scan/deep.hpp", "#include <vector>\n");
  write("libs/scan/src/scan.cpp", "#include \"topogeo/scan/inner.hpp\"\n");
  write("services/web/main.cpp", "#include \"topogeo/scan/scan.hpp\"\n");
  EXPECT_THAT(unused_public_headers(root_, includes(), {"scan"}),
              ElementsAre(HasSubstr("include/topogeo/scan/deep.hpp"),
                          HasSubstr("include/topogeo/scan/inner.hpp")));
}

}  // namespace
}  // namespace topogeo::architecture
