#include "sqlite_source.hpp"

#include <filesystem>
#include <stdexcept>
#include <system_error>

#include <sqlite3.h>

#include "compression.hpp"
#include "input_file.hpp"

namespace topogeo::recording {
namespace {

constexpr const char* kImmutable = "?mode=ro&immutable=1";

std::string column_text(sqlite3_stmt* row, int column) {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(row, column));
  return text == nullptr ? "" : text;
}

/// Escapes a name for a URI.
std::string escaped(const std::string& name) {
  std::string out;
  for (const char c : name) {
    if (c == '%' || c == '?' || c == '#') {
      constexpr std::string_view kDigits = "0123456789ABCDEF";
      const auto byte = static_cast<unsigned char>(c);
      out += '%';
      out += kDigits[byte / 16U];
      out += kDigits[byte % 16U];
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace

SqliteSource::SqliteSource(const std::filesystem::path& path, const TopicFilter& wanted)
    : name_(path.string()),
      file_bytes_(sqlite_guard::bytes_of(path)),
      database_(nullptr, &sqlite3_close),
      messages_(nullptr, &sqlite3_finalize),
      budget_(file_bytes_) {
  sqlite_guard::refuse_irregular(path);
  open();
  read_topics();
  select_messages(wanted);
}

SqliteSource::~SqliteSource() = default;

void SqliteSource::open() {
  // If no file can be made beside the recording, as on a read-only disk, opens it as immutable.
  for (const char* how : {"?mode=ro", kImmutable}) {
    if (how == kImmutable) refuse_write_ahead_log();
    sqlite3* raw = nullptr;
    const std::string uri = "file:" + escaped(name_) + how;
    const int result =
        sqlite3_open_v2(uri.c_str(), &raw, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    limit_.reset();  // of the previous connection
    database_.reset(raw);
    if (raw == nullptr) continue;
    sqlite_guard::protect(raw);
    limit_.emplace(raw, file_bytes_);
    if (result != SQLITE_OK || sqlite3_exec(raw, "SELECT 1 FROM sqlite_master LIMIT 1", nullptr,
                                            nullptr, nullptr) != SQLITE_OK) {
      continue;
    }
    const std::string refused = sqlite_guard::refused_schema(raw);
    if (refused.empty()) return;
    throw std::runtime_error(name_ + ": has " + refused + ", expected only the tables of rosbag2");
  }
  fail("cannot be opened");
}

/// An immutable database is read without its write-ahead log, which would lose its last messages.
void SqliteSource::refuse_write_ahead_log() const {
  const std::string log = name_ + "-wal";
  std::error_code none;
  const std::uintmax_t bytes = std::filesystem::file_size(log, none);
  if (none || bytes == 0) return;
  throw std::runtime_error(name_ + ": has messages in " + log +
                           ", expected a folder where SQLite can write, to read them: copy both "
                           "files to one");
}

SqliteSource::Statement SqliteSource::prepare(const std::string& sql) {
  sqlite3_stmt* raw = nullptr;
  if (sqlite3_prepare_v2(database_.get(), sql.c_str(), -1, &raw, nullptr) != SQLITE_OK) {
    fail("expected the tables of rosbag2");
  }
  return {raw, &sqlite3_finalize};
}

void SqliteSource::fail(const std::string& what) {
  throw std::runtime_error(name_ + ": " + what + ": " + cause());
}

std::string SqliteSource::cause() const {
  if (!database_) return "no memory";
  return limit_ && limit_->reached() ? sqlite_guard::kTooMuchWork : sqlite3_errmsg(database_.get());
}

std::span<const std::byte> SqliteSource::data_of_row() {
  sqlite3_stmt* row = messages_.get();
  const auto* data = static_cast<const std::byte*>(sqlite3_column_blob(row, 3));
  if (data == nullptr) return {};
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(row, 3));
  // Rows of a damaged file can share pages.
  data_bytes_ += size;
  if (data_bytes_ > file_bytes_) throw FormatError("expected messages that the file can hold");
  return {data, size};
}

void SqliteSource::read_topics() {
  const Statement rows =
      prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY id");
  int result = SQLITE_ROW;
  while ((result = sqlite3_step(rows.get())) == SQLITE_ROW) {
    const bool cdr = column_text(rows.get(), 3) == "cdr";
    topic_of_id_[sqlite3_column_int64(rows.get(), 0)] = topics_.size();
    topics_.push_back({column_text(rows.get(), 1), ros2_type_name(column_text(rows.get(), 2)),
                       cdr ? Encoding::kCdr : Encoding::kOther});
  }
  if (result != SQLITE_DONE) fail("table topics");
  const Statement last = prepare("SELECT max(id) FROM messages");
  if (sqlite3_step(last.get()) == SQLITE_ROW) last_id_ = sqlite3_column_int64(last.get(), 0);
}

void SqliteSource::select_messages(const TopicFilter& wanted) {
  std::string ids;
  for (const auto& [id, topic] : topic_of_id_) {
    if (!wanted(topics_[topic])) continue;
    ids += (ids.empty() ? "" : ", ") + std::to_string(id);
  }
  // Ordered by id, the order of recording: for an order by time SQLite would have to sort the whole
  // file without an index, or jump about in it with one.
  messages_ = prepare("SELECT id, topic_id, timestamp, data FROM messages WHERE topic_id IN (" +
                      ids + ") ORDER BY id");
}

bool SqliteSource::next(RawMessage& message) {
  if (ended_) return false;
  const int result = sqlite3_step(messages_.get());
  if (result != SQLITE_ROW) {
    ended_ = true;
    if (result != SQLITE_DONE) {
      damage_ = name_ + ": after " + position() + ": " + cause();
    }
    return false;
  }
  sqlite3_stmt* row = messages_.get();
  message_id_ = sqlite3_column_int64(row, 0);
  const auto topic = topic_of_id_.find(sqlite3_column_int64(row, 1));
  if (topic == topic_of_id_.end()) {
    damage_ = name_ + ": " + position() + ": expected the number of a topic";
    ended_ = true;
    return false;
  }
  message.topic = topic->second;
  message.log_time_ns = sqlite3_column_int64(row, 2);
  try {
    message.data = data_of_row();
    if (is_zstd_frame(message.data)) {
      decompress_zstd(message.data, budget_, unpacked_);
      message.data = unpacked_;
    }
    return true;
  } catch (const FormatError& error) {
    damage_ = name_ + ": " + position() + ": " + error.what();
    ended_ = true;
    return false;
  }
}

std::string SqliteSource::position() const {
  return "message " + std::to_string(message_id_);
}

double SqliteSource::fraction_read() const {
  if (ended_ || last_id_ <= 0) return 1.0;
  return std::clamp(static_cast<double>(message_id_) / static_cast<double>(last_id_), 0.0, 1.0);
}

}  // namespace topogeo::recording
