// Writes the SQLite storage of rosbag2, its tables as of Humble (schema version 3).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "message_sink.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace topogeo::recording {

class SqliteSink final : public MessageSink {
 public:
  explicit SqliteSink(const std::filesystem::path& path);
  ~SqliteSink() override;
  [[nodiscard]] Encoding encoding() const override { return Encoding::kCdr; }
  void write(const OutputMessage& message) override;
  void close() override;

 private:
  void execute(const char* sql);
  void check(bool good);
  std::int64_t topic_of(const OutputMessage& message);

  std::string name_;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_;
  std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> insert_topic_;
  std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> insert_message_;
  std::map<std::string, std::int64_t> topics_;
};

}  // namespace topogeo::recording
