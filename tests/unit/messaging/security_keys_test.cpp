// Keys from a peer, in the format of Fast DDS, with a length chosen by the test.
#include "fast_dds/security_keys.hpp"

#include <cstdint>
#include <string>
#include <vector>

#include <fastdds/rtps/common/BinaryProperty.h>
#include <fastdds/rtps/common/Token.h>
#include <fastdds/rtps/security/common/Handle.h>
#include <fastdds/rtps/security/exceptions/SecurityException.h>
#include <gtest/gtest.h>

#include "topogeo/messaging/strangers.hpp"

namespace rtps = eprosima::fastrtps::rtps;

// NOLINTNEXTLINE: the name of a member function of the library
extern "C" bool
set_keys(void* exchange, const rtps::security::Handle& own, rtps::security::Handle& peer, const std::vector<rtps::DataHolder>& tokens, rtps::security::SecurityException& error) __asm__(
    "_ZN8eprosima8fastrtps4rtps8security22AESGCMGMAC_KeyExchange36set_remote_participant_crypto_"
    "tokensERKNS2_6HandleERS4_RKSt6vectorINS1_10DataHolderESaIS9_EERNS2_17SecurityExceptionE");

namespace topogeo::messaging {
namespace {

using Bytes = std::vector<std::uint8_t>;

void add_key(Bytes& bytes, std::uint8_t stated, std::size_t size) {
  bytes.insert(bytes.end(), {0, 0, 0, stated});
  bytes.insert(bytes.end(), size, 7);
}

/// AES256_GCM keys; the sender's key has the given length.
Bytes keys(std::uint8_t stated = 32, std::size_t size = 32, bool own_of_receiver = false) {
  Bytes bytes{0, 0, 0, 4};
  add_key(bytes, 32, 32);
  bytes.insert(bytes.end(), {1, 2, 3, 4});
  add_key(bytes, stated, size);
  bytes.insert(bytes.end(), 4, own_of_receiver ? 1 : 0);
  add_key(bytes, own_of_receiver ? 32 : 0, own_of_receiver ? 32 : 0);
  return bytes;
}

TEST(SecurityKeys, AsTheyAreSentCanBeRead) {
  EXPECT_TRUE(check_key_material(keys()));
  EXPECT_TRUE(check_key_material(keys(16, 16)));
  EXPECT_TRUE(check_key_material(keys(32, 32, true)));
  EXPECT_TRUE(check_key_material(Bytes(44, 0))) << "none";
}

TEST(SecurityKeys, LongerThanAKeyOrTheMessageCannotBeRead) {
  EXPECT_FALSE(check_key_material(keys(33, 33)));
  EXPECT_FALSE(check_key_material(keys(255, 255)));
  for (const bool own : {false, true}) {
    const Bytes whole = keys(32, 32, own);
    // Without a receiver's key, the length of its missing key is not read.
    const std::size_t needed = whole.size() - (own ? 0 : 4);
    for (std::size_t size = 0; size < needed; ++size) {
      EXPECT_FALSE(check_key_material({whole.data(), size})) << size << " bytes";
    }
    EXPECT_TRUE(check_key_material({whole.data(), needed}));
  }
}

TEST(SecurityKeys, OfAnUnknownKindCannotBeRead) {
  Bytes bytes = keys();
  bytes[3] = 5;
  EXPECT_FALSE(check_key_material(bytes));
  bytes = keys();
  bytes[0] = 1;
  EXPECT_FALSE(check_key_material(bytes));
}

TEST(SecurityKeys, ThatCannotBeReadAreRefusedAndCounted) {
  keep_security_keys();
  const auto refused = [](const Bytes& bytes) {
    rtps::BinaryProperty property;
    property.name("dds.cryp.keymat");
    property.value(bytes);
    rtps::DataHolder token;
    token.class_id("DDS:Crypto:AES_GCM_GMAC");
    token.binary_properties().push_back(property);
    rtps::security::NilHandle handle;  // refused by the library, too
    rtps::security::SecurityException error;
    const std::uint64_t before = stranger_counts().invalid_packets;
    EXPECT_FALSE(set_keys(nullptr, handle, handle, {token}, error));
    return stranger_counts().invalid_packets - before;
  };
  EXPECT_EQ(refused(keys()), 0U);
  EXPECT_EQ(refused(keys(255, 255)), 1U);
}

}  // namespace
}  // namespace topogeo::messaging
