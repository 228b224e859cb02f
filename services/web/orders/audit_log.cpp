#include "orders/audit_log.hpp"

#include <ctime>
#include <stdexcept>
#include <system_error>

#include "topogeo/support/format.hpp"

#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

/// "2026-02-28T13:04:05.123Z"
std::string utc(std::int64_t wall_ns) {
  const std::time_t seconds = wall_ns / 1'000'000'000;
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", parts.tm_year + 1900,
                     parts.tm_mon + 1, parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec,
                     wall_ns / 1'000'000 % 1000);
}

}  // namespace

AuditLog::AuditLog(const std::filesystem::path& file) : kept_(!file.empty()) {
  if (!kept_) return;
  std::error_code no_folder;  // then the file cannot be opened either
  std::filesystem::create_directories(std::filesystem::absolute(file).parent_path(), no_folder);
  out_.open(file, std::ios::app);
  if (!out_) throw std::runtime_error("audit log " + file.string() + ": cannot be opened");
}

bool AuditLog::add(std::int64_t wall_ns, const std::string& who, const std::string& order,
                   const std::string& body) {
  if (!kept_) return true;
  out_.clear();
  out_ << text_of(Json{{"time", utc(wall_ns)},
                       {"who", who},
                       {"order", order},
                       {"body", body.substr(0, kMostBody_bytes)}})
       << std::endl;  // an order that moves the robot is on disk before its outcome
  return out_.good();
}

}  // namespace topogeo::web
