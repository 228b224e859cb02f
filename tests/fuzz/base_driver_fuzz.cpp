#include <cstddef>
#include <cstdint>

#include "checks.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): the name that libFuzzer calls
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  topogeo::fuzz::check_base_driver({reinterpret_cast<const char*>(data), size});
  return 0;
}
