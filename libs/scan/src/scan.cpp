#include "topogeo/scan/scan.hpp"

#include <bit>

#include "topogeo/support/hash.hpp"

namespace topogeo::scan {

std::uint64_t fingerprint(const Scan& scan) {
  support::Fnv1a hash;
  hash.add(static_cast<std::uint64_t>(scan.stamp_ns));
  for (const float range_m : scan.ranges_m) hash.add(std::bit_cast<std::uint32_t>(range_m));
  return hash.value();
}

}  // namespace topogeo::scan
