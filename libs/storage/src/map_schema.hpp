// The tables of a map database, and how files of older versions come to have them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include <SQLiteCpp/Database.h>

#include "topogeo/storage/map_document.hpp"

namespace topogeo::storage {

enum class Access : std::uint8_t {
  kCreate,    ///< read and write, made when missing
  kExisting,  ///< read and write
  kReadOnly,  ///< leaves the file and its directory as they are
};

/// An SQLite file that is a topogeo map database of this version or an older one, or that has no
/// content (with kCreate alone). Throws std::runtime_error and SQLite::Exception.
std::unique_ptr<SQLite::Database> open_map_database(const std::filesystem::path& path,
                                                    Access access);

/// Whether there are tables already.
bool has_content(SQLite::Database& database);

/// The version of the tables.
std::int64_t stored_version(SQLite::Database& database);

/// A copy in memory.
std::unique_ptr<SQLite::Database> copy_in_memory(SQLite::Database& database);

/// Makes the tables and writes what describes the map. Part of a transaction.
void create_tables(SQLite::Database& database, const std::string& robot_id, std::uint64_t seed);

/// Adds what version 2 has not; all that it has stays. Part of a transaction.
void make_version_3_of_2(SQLite::Database& database);

/// The same with version 3.
void make_version_4_of_3(SQLite::Database& database);

/// The map of a database of version 1; the tables of version 1 are gone then. Part of a
/// transaction, without foreign keys. Throws std::runtime_error when it is damaged.
MapDocument take_version_1(SQLite::Database& database);

}  // namespace topogeo::storage
