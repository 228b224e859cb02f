// The tables of a map database, and the upgrade of older versions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include <SQLiteCpp/Database.h>

#include "topogeo/storage/map_document.hpp"

namespace topogeo::storage {

enum class Access : std::uint8_t {
  kCreate,    ///< read and write, created if missing
  kExisting,  ///< read and write
  kReadOnly,  ///< does not change the file or its directory
};

/// An SQLite file that is a topogeo map database of this version or an older one, or (only with
/// kCreate) has no content. Throws std::runtime_error and SQLite::Exception.
std::unique_ptr<SQLite::Database> open_map_database(const std::filesystem::path& path,
                                                    Access access);

/// Whether there are tables already.
bool has_content(SQLite::Database& database);

/// The version of the tables.
std::int64_t stored_version(SQLite::Database& database);

/// A copy in memory.
std::unique_ptr<SQLite::Database> copy_in_memory(SQLite::Database& database);

/// Makes the tables and writes the description of the map. Part of a transaction.
void create_tables(SQLite::Database& database, const std::string& robot_id, std::uint64_t seed);

/// Adds the tables missing in version 2; all data is kept. Part of a transaction.
void make_version_3_of_2(SQLite::Database& database);

/// The same for version 3.
void make_version_4_of_3(SQLite::Database& database);

/// Removes the tables of version 1 and returns their map. Part of a transaction, without foreign
/// keys. Throws std::runtime_error if it is damaged.
MapDocument take_version_1(SQLite::Database& database);

}  // namespace topogeo::storage
