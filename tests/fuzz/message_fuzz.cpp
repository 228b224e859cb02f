#include <cstddef>
#include <cstdint>

#include <google/protobuf/stubs/logging.h>

#include "checks.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): the name that libFuzzer calls
extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  // Protobuf prints a line for each string that is not UTF-8, which most inputs contain.
  google::protobuf::SetLogHandler(nullptr);
  return 0;
}

// NOLINTNEXTLINE(readability-identifier-naming): the name that libFuzzer calls
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  topogeo::fuzz::check_message({reinterpret_cast<const char*>(data), size});
  return 0;
}
