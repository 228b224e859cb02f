#include "orders/audit_log.hpp"

#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "topogeo/support/temporary_folder.hpp"

#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

std::vector<Json> lines_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<Json> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(Json::parse(line));
  return lines;
}

TEST(AuditLog, AppendsALineForEachOrder) {
  const support::TemporaryFolder folder("audit");
  const std::filesystem::path file = folder.path() / "new folder" / "orders.jsonl";
  EXPECT_TRUE(
      AuditLog(file).add(1'767'225'600'123'000'000, "Anna", "/api/goal", R"({"place":"room 3"})"));
  EXPECT_TRUE(AuditLog(file).add(0, "a program", "/api/stop", std::string(5000, 'x')));
  const std::vector<Json> lines = lines_of(file);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0]["time"], "2026-01-01T00:00:00.123Z");
  EXPECT_EQ(lines[0]["who"], "Anna");
  EXPECT_EQ(lines[0]["order"], "/api/goal");
  EXPECT_EQ(lines[0]["body"], R"({"place":"room 3"})");
  EXPECT_EQ(lines[1]["body"].get<std::string>().size(), AuditLog::kMostBody_bytes);
}

TEST(AuditLog, WithoutAFileNothingIsKeptAndAFileThatCannotBeOpenedIsNamed) {
  EXPECT_TRUE(AuditLog({}).add(0, "Anna", "/api/stop", ""));
  try {
    const AuditLog log("/proc/no/such/file");
    FAIL() << "expected an error";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("/proc/no/such/file"));
  }
}

}  // namespace
}  // namespace topogeo::web
