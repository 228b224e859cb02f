#include "table_writer.hpp"

#include "topogeo/support/format.hpp"
#include "topogeo/support/hash.hpp"

namespace topogeo::storage {

void bind_blob(SQLite::Statement& statement, int index, const std::string& blob) {
  statement.bind(index, blob.data(), static_cast<int>(blob.size()));
}

TableWriter::TableWriter(SQLite::Database& database, const std::string& table,
                         const std::string& extra_columns, const std::string& extra_parameters)
    : upsert_(database,
              fmt::format("INSERT OR REPLACE INTO {}(id, blob_hash, blob{}) VALUES(?, ?, ?{})",
                          table, extra_columns, extra_parameters)),
      remove_(database, fmt::format("DELETE FROM {} WHERE id = ?", table)) {}

void TableWriter::put(BlobHashes& hashes, std::uint32_t id, const std::string& blob,
                      std::initializer_list<std::int64_t> numbers,
                      std::initializer_list<std::string> texts) {
  const std::uint64_t hash = support::fnv1a(blob);
  const auto [entry, is_new] = hashes.try_emplace(id, hash);
  if (!is_new && entry->second == hash) return;
  entry->second = hash;
  upsert_.reset();
  upsert_.bind(1, id);
  upsert_.bind(2, as_signed(hash));
  bind_blob(upsert_, 3, blob);
  int index = 4;
  for (const std::int64_t value : numbers) upsert_.bind(index++, value);
  for (const std::string& value : texts) upsert_.bind(index++, value);
  upsert_.exec();
}

void TableWriter::remove_others(BlobHashes& hashes,
                                const std::function<bool(std::uint32_t)>& is_kept) {
  std::erase_if(hashes, [&](const auto& entry) {
    if (is_kept(entry.first)) return false;
    remove_.reset();
    remove_.bind(1, entry.first);
    remove_.exec();
    return true;
  });
}

}  // namespace topogeo::storage
