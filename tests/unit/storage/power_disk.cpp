#include "power_disk.hpp"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>

#include <sqlite3.h>

namespace topogeo::storage {
namespace {

constexpr std::size_t kSector = 512;

PowerDisk* running_disk = nullptr;
sqlite3_vfs* real_vfs = nullptr;

/// An open file: SQLite provides the memory; the data is in a file of the real file system.
struct PowerFile {
  sqlite3_file base;
  char path[1024];
  sqlite3_file* real() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};

PowerFile* power_file(sqlite3_file* file) {
  return reinterpret_cast<PowerFile*>(file);
}
sqlite3_file* real(sqlite3_file* file) {
  return power_file(file)->real();
}

std::string content_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

int power_write(sqlite3_file* file, const void* bytes, int size, sqlite3_int64 offset) {
  running_disk->before_write();
  return real(file)->pMethods->xWrite(real(file), bytes, size, offset);
}
int power_truncate(sqlite3_file* file, sqlite3_int64 size) {
  running_disk->before_write();
  return real(file)->pMethods->xTruncate(real(file), size);
}
int power_sync(sqlite3_file* file, int flags) {
  running_disk->before_write();
  const int code = real(file)->pMethods->xSync(real(file), flags);
  if (code == SQLITE_OK) running_disk->synced(power_file(file)->path);
  return code;
}

const sqlite3_io_methods* methods() {
  static sqlite3_io_methods all{};
  all.iVersion = 2;
  all.xClose = [](sqlite3_file* f) { return real(f)->pMethods->xClose(real(f)); };
  all.xRead = [](sqlite3_file* f, void* to, int size, sqlite3_int64 offset) {
    return real(f)->pMethods->xRead(real(f), to, size, offset);
  };
  all.xWrite = power_write;
  all.xTruncate = power_truncate;
  all.xSync = power_sync;
  all.xFileSize = [](sqlite3_file* f, sqlite3_int64* size) {
    return real(f)->pMethods->xFileSize(real(f), size);
  };
  all.xLock = [](sqlite3_file* f, int level) { return real(f)->pMethods->xLock(real(f), level); };
  all.xUnlock = [](sqlite3_file* f, int level) {
    return real(f)->pMethods->xUnlock(real(f), level);
  };
  all.xCheckReservedLock = [](sqlite3_file* f, int* out) {
    return real(f)->pMethods->xCheckReservedLock(real(f), out);
  };
  all.xFileControl = [](sqlite3_file* f, int operation, void* argument) {
    return real(f)->pMethods->xFileControl(real(f), operation, argument);
  };
  all.xSectorSize = [](sqlite3_file* f) { return real(f)->pMethods->xSectorSize(real(f)); };
  // A disk without guarantees beyond forced writes.
  all.xDeviceCharacteristics = [](sqlite3_file*) { return 0; };
  all.xShmMap = [](sqlite3_file* f, int page, int size, int extend, void volatile** out) {
    return real(f)->pMethods->xShmMap(real(f), page, size, extend, out);
  };
  all.xShmLock = [](sqlite3_file* f, int offset, int count, int flags) {
    return real(f)->pMethods->xShmLock(real(f), offset, count, flags);
  };
  all.xShmBarrier = [](sqlite3_file* f) { real(f)->pMethods->xShmBarrier(real(f)); };
  all.xShmUnmap = [](sqlite3_file* f, int remove) {
    return real(f)->pMethods->xShmUnmap(real(f), remove);
  };
  return &all;
}

int power_open(sqlite3_vfs* /*vfs*/, const char* name, sqlite3_file* file, int flags,
               int* out_flags) {
  PowerFile* opened = power_file(file);
  opened->base.pMethods = nullptr;
  std::strncpy(opened->path, name == nullptr ? "" : name, sizeof opened->path - 1);
  const int code = real_vfs->xOpen(real_vfs, name, opened->real(), flags, out_flags);
  if (code == SQLITE_OK) opened->base.pMethods = methods();
  return code;
}

int power_delete(sqlite3_vfs* /*vfs*/, const char* name, int sync_directory) {
  running_disk->before_write();
  const int code = real_vfs->xDelete(real_vfs, name, sync_directory);
  if (code == SQLITE_OK) running_disk->removed(name);
  return code;
}

sqlite3_vfs* power_vfs() {
  static sqlite3_vfs vfs{};
  vfs = *real_vfs;
  vfs.zName = "power";
  vfs.szOsFile = real_vfs->szOsFile + static_cast<int>(sizeof(PowerFile));
  vfs.xOpen = power_open;
  vfs.xDelete = power_delete;
  return &vfs;
}

}  // namespace

PowerDisk::PowerDisk(std::function<void()> before_write) : before_write_(std::move(before_write)) {
  running_disk = this;
  real_vfs = sqlite3_vfs_find(nullptr);
  sqlite3_vfs_register(power_vfs(), 1);
}

PowerDisk::~PowerDisk() {
  sqlite3_vfs_unregister(sqlite3_vfs_find("power"));
  sqlite3_vfs_register(real_vfs, 1);
  running_disk = nullptr;
}

void PowerDisk::synced(const std::string& path) {
  synced_[path] = content_of(path);
}

PowerDisk::Files PowerDisk::after_power_loss(support::Random& random,
                                             bool some_later_writes) const {
  Files left = synced_;
  if (!some_later_writes) return left;
  for (auto& [path, bytes] : left) {
    const std::string now = content_of(path);
    // A part of the appended data may remain, too.
    const std::size_t size = std::max(bytes.size(), now.size());
    const std::size_t kept = bytes.size() + random.below(size - bytes.size() + 1);
    std::string mixed = bytes;
    mixed.resize(kept, '\0');
    for (std::size_t begin = 0; begin < kept; begin += kSector) {
      if (random.below(2) == 0 || begin >= now.size()) continue;
      const std::size_t count = std::min({kSector, now.size() - begin, kept - begin});
      mixed.replace(begin, count, now, begin, count);
    }
    bytes = std::move(mixed);
  }
  return left;
}

}  // namespace topogeo::storage
