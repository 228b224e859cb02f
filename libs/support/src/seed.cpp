#include "topogeo/support/seed.hpp"

#include "topogeo/support/hash.hpp"

namespace topogeo::support {

std::uint64_t splitmix64(std::uint64_t value) {
  value += 0x9e3779b97f4a7c15ULL;
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ULL;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebULL;
  return value ^ (value >> 31);
}

std::uint64_t derive_seed(std::uint64_t run_seed, std::string_view robot_id,
                          std::initializer_list<std::uint64_t> ids) {
  Fnv1a hash;
  hash.add(run_seed);
  // The length distinguishes ("r", {...}) from a longer name whose bytes equal those of the ids.
  hash.add(std::uint64_t{robot_id.size()});
  hash.add(robot_id);
  for (const std::uint64_t id : ids) hash.add(id);
  return splitmix64(hash.value());
}

}  // namespace topogeo::support
