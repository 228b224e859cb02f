// Reads the SQLite storage of rosbag2 (.db3): tables `topics` and `messages`, of any version of its
// schema.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/recording/message_source.hpp"
#include "topogeo/sqlite_guard/sqlite_guard.hpp"

#include "compression.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace topogeo::recording {

class SqliteSource final : public MessageSource {
 public:
  /// Throws std::runtime_error.
  SqliteSource(const std::filesystem::path& path, const TopicFilter& wanted);
  ~SqliteSource() override;

  bool next(RawMessage& message) override;
  [[nodiscard]] const std::vector<Topic>& topics() const override { return topics_; }
  [[nodiscard]] std::string position() const override;
  [[nodiscard]] const std::string& damage() const override { return damage_; }
  [[nodiscard]] double fraction_read() const override;

 private:
  using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

  void open();
  void refuse_write_ahead_log() const;
  Statement prepare(const std::string& sql);
  [[noreturn]] void fail(const std::string& what);
  /// Cause of the last failure.
  [[nodiscard]] std::string cause() const;
  /// The blob of the message. Throws FormatError if all so far exceed the size of the file.
  std::span<const std::byte> data_of_row();
  void read_topics();
  void select_messages(const TopicFilter& wanted);

  std::string name_;
  std::uint64_t file_bytes_;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_;
  std::optional<sqlite_guard::WorkLimit> limit_;
  Statement messages_;
  std::vector<Topic> topics_;
  std::map<std::int64_t, std::size_t> topic_of_id_;
  std::int64_t message_id_ = 0;
  std::int64_t last_id_ = 0;
  bool ended_ = false;
  std::uint64_t data_bytes_ = 0;  // of the messages so far
  UnpackBudget budget_;
  std::vector<std::byte> unpacked_;
  std::string damage_;
};

}  // namespace topogeo::recording
