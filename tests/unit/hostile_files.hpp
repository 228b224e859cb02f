// Files that no reader may accept, and files with a little damage.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "topogeo/support/random.hpp"

namespace topogeo::test {

/// Message of the exception that a reader throws; "" without one.
inline std::string refusal_of(const std::function<void()>& read) {
  try {
    read();
    return "";
  } catch (const std::exception& error) {
    return error.what();
  }
}

/// A FIFO without a writer: opening it the usual way blocks forever.
inline std::filesystem::path make_fifo(const std::filesystem::path& path) {
  std::filesystem::remove(path);
  if (::mkfifo(path.c_str(), 0600) != 0) throw std::runtime_error("no FIFO " + path.string());
  return path;
}

/// An object in place of a regular file.
struct IrregularFile {
  std::filesystem::path path;
  std::string kind;  ///< named in the refusal
};

/// One of each kind, in an empty folder.
inline std::vector<IrregularFile> irregular_files(const std::filesystem::path& folder,
                                                  const std::string& ending) {
  const std::filesystem::path link = folder / ("zero" + ending);
  std::filesystem::remove(link);
  std::filesystem::create_symlink("/dev/zero", link);
  return {{make_fifo(folder / ("fifo" + ending)), "a FIFO"}, {link, "a device"}};
}

/// Number of damaged files to read: 100 and more by an environment variable.
inline int damaged_files() {
  return std::getenv("TOPOGEO_ALL_FAULTS") != nullptr ? 400 : 25;
}

/// A copy with some bytes changed, removed or repeated.
inline std::string with_damage(std::string bytes, support::Random& random) {
  for (std::uint64_t i = 1 + random.below(4); i > 0 && !bytes.empty(); --i) {
    const auto at = static_cast<std::size_t>(random.below(bytes.size()));
    const auto length = static_cast<std::size_t>(1 + random.below(40));
    switch (random.below(4)) {
      case 0:
        bytes[at] = static_cast<char>(random.below(256));
        break;
      case 1:
        bytes.erase(at, length);
        break;
      case 2:
        bytes.insert(at, bytes.substr(bytes.size() - at - 1, length));
        break;
      default:
        bytes.insert(at, length, bytes[at]);
    }
  }
  return bytes;
}

}  // namespace topogeo::test
