// Fast DDS 2.9.1 copies the keys that a peer sends by the lengths that stand before them, without a
// look at the room there is (AESGCMGMAC_KeyExchange::KeyMaterialCDRDeserialize). And when a message
// comes it goes through the readers and writers of a participant, and their keys, without a lock
// (AESGCMGMAC_Transform::lookup_reader), while other threads add some (AESGCMGMAC_KeyFactory).
//
// Here keys are checked first, and who changes the lists waits for who goes through them. The
// functions take the places of the library's, which calls them through its symbols. Should a
// library have no such functions, nothing calls these.
#include "security_keys.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <type_traits>
#include <vector>

#include <fastdds/rtps/common/BinaryProperty.h>
#include <fastdds/rtps/common/CDRMessage_t.h>
#include <fastdds/rtps/common/Property.h>
#include <fastdds/rtps/common/Token.h>
#include <fastdds/rtps/security/accesscontrol/EndpointSecurityAttributes.h>
#include <fastdds/rtps/security/common/Handle.h>
#include <fastdds/rtps/security/cryptography/CryptoTransform.h>
#include <fastdds/rtps/security/exceptions/SecurityException.h>

#include "../packets/packet_reader.hpp"
#include "../stranger_counts.hpp"
#include "library_function.hpp"

namespace {

namespace messaging = topogeo::messaging;
namespace rtps = eprosima::fastrtps::rtps;
namespace security = rtps::security;

using Handle = security::Handle;
using Error = security::SecurityException;
using Attributes = security::EndpointSecurityAttributes;
using Properties = std::vector<rtps::Property>;
using Tokens = std::vector<rtps::DataHolder>;

/// Of all lists of readers and writers, and of their keys.
std::shared_mutex& lists() {
  static std::shared_mutex mutex;
  return mutex;
}

/// Has the lists alone, as whoever changes them must. One function that does may call another.
class Turn {
 public:
  Turn() {
    if (depth_++ == 0) lists().lock();
  }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;
  ~Turn() {
    if (--depth_ == 0) lists().unlock();
  }

 private:
  static inline thread_local int depth_ = 0;
};

/// Calls the function of the library whose place a member has taken, and which changes the lists.
template <class Class, class Result, class... Parameters>
Result change_lists(const char* symbol, Result (Class::* /*member*/)(Parameters...), Class* object,
                    std::type_identity_t<Parameters>... arguments) {
  const auto original = messaging::library_function<Result (*)(Class*, Parameters...)>(symbol);
  const Turn turn;
  return original(object, arguments...);
}

bool readable(const Tokens& tokens) {
  const bool all = std::ranges::all_of(tokens, [](const rtps::DataHolder& token) {
    return std::ranges::all_of(token.binary_properties(), [](const rtps::BinaryProperty& property) {
      return messaging::check_key_material(property.value());
    });
  });
  if (!all) messaging::count_invalid_packet();
  return all;
}

constexpr const char* kLookUp =
    "_ZN8eprosima8fastrtps4rtps8security20AESGCMGMAC_Transform24preprocess_secure_submsgEPPNS"
    "2_6HandleES6_RNS2_26SecureSubmessageCategory_tERKNS1_12CDRMessage_tERS4_SC_RNS2_17Securi"
    "tyExceptionE";
constexpr const char* kAddReader =
    "_ZN8eprosima8fastrtps4rtps8security21AESGCMGMAC_KeyFactory25register_local_datareaderERN"
    "S2_6HandleERKSt6vectorINS1_8PropertyESaIS7_EERKNS2_26EndpointSecurityAttributesERNS2_17S"
    "ecurityExceptionE";
constexpr const char* kAddWriter =
    "_ZN8eprosima8fastrtps4rtps8security21AESGCMGMAC_KeyFactory25register_local_datawriterERN"
    "S2_6HandleERKSt6vectorINS1_8PropertyESaIS7_EERKNS2_26EndpointSecurityAttributesERNS2_17S"
    "ecurityExceptionE";
constexpr const char* kAddPeersReader =
    "_ZN8eprosima8fastrtps4rtps8security21AESGCMGMAC_KeyFactory34register_matched_remote_data"
    "readerERNS2_6HandleES5_RKS4_bRNS2_17SecurityExceptionE";
constexpr const char* kAddPeersWriter =
    "_ZN8eprosima8fastrtps4rtps8security21AESGCMGMAC_KeyFactory34register_matched_remote_data"
    "writerERNS2_6HandleES5_RKS4_RNS2_17SecurityExceptionE";
constexpr const char* kRemoveReader =
    "_ZN8eprosima8fastrtps4rtps8security21AESGCMGMAC_KeyFactory21unregister_datareaderERSt10s"
    "hared_ptrINS2_6HandleEERNS2_17SecurityExceptionE";
constexpr const char* kRemoveWriter =
    "_ZN8eprosima8fastrtps4rtps8security21AESGCMGMAC_KeyFactory21unregister_datawriterERSt10s"
    "hared_ptrINS2_6HandleEERNS2_17SecurityExceptionE";
constexpr const char* kSetKeys =
    "_ZN8eprosima8fastrtps4rtps8security22AESGCMGMAC_KeyExchange36set_remote_participant_cryp"
    "to_tokensERKNS2_6HandleERS4_RKSt6vectorINS1_10DataHolderESaIS9_EERNS2_17SecurityExceptio"
    "nE";
constexpr const char* kSetReadersKeys =
    "_ZN8eprosima8fastrtps4rtps8security22AESGCMGMAC_KeyExchange35set_remote_datareader_crypt"
    "o_tokensERNS2_6HandleES5_RKSt6vectorINS1_10DataHolderESaIS7_EERNS2_17SecurityExceptionE";
constexpr const char* kSetWritersKeys =
    "_ZN8eprosima8fastrtps4rtps8security22AESGCMGMAC_KeyExchange35set_remote_datawriter_crypt"
    "o_tokensERNS2_6HandleES5_RKSt6vectorINS1_10DataHolderESaIS7_EERNS2_17SecurityExceptionE";
constexpr const char* kForget =
    "_ZN8eprosima8fastrtps4rtps8security21AESGCMGMAC_KeyFactory19release_participantERNS2_"
    "10HandleImplINS2_20ParticipantKeyHandleES3_EE";

}  // namespace

// What takes the places has their names, and the classes no more than that.
// NOLINTBEGIN: the names are of the library
namespace eprosima::fastrtps::rtps::security {

class AESGCMGMAC_Transform {
 public:
  bool preprocess_secure_submsg(Handle** writer, Handle** reader,
                                SecureSubmessageCategory_t& category, const CDRMessage_t& message,
                                Handle& receiver, Handle& sender, SecurityException& error);
};

class ParticipantKeyHandle;

class AESGCMGMAC_KeyFactory {
 public:
  // It has the participant's lock while it takes the endpoints away.
  void release_participant(HandleImpl<ParticipantKeyHandle, AESGCMGMAC_KeyFactory>& participant);
  Handle* register_local_datareader(Handle& participant, const Properties& properties,
                                    const Attributes& attributes, Error& error);
  Handle* register_local_datawriter(Handle& participant, const Properties& properties,
                                    const Attributes& attributes, Error& error);
  Handle* register_matched_remote_datareader(Handle& writer, Handle& peer, const Handle& secret,
                                             bool relay_only, Error& error);
  Handle* register_matched_remote_datawriter(Handle& reader, Handle& peer, const Handle& secret,
                                             Error& error);
  bool unregister_datareader(std::shared_ptr<Handle>& reader, Error& error);
  bool unregister_datawriter(std::shared_ptr<Handle>& writer, Error& error);
};

class AESGCMGMAC_KeyExchange {
 public:
  bool set_remote_participant_crypto_tokens(const Handle& own, Handle& peer, const Tokens& tokens,
                                            Error& error);
  bool set_remote_datareader_crypto_tokens(Handle& own, Handle& peer, const Tokens& tokens,
                                           Error& error);
  bool set_remote_datawriter_crypto_tokens(Handle& own, Handle& peer, const Tokens& tokens,
                                           Error& error);
};

bool AESGCMGMAC_Transform::preprocess_secure_submsg(Handle** writer, Handle** reader,
                                                    SecureSubmessageCategory_t& category,
                                                    const CDRMessage_t& message, Handle& receiver,
                                                    Handle& sender, SecurityException& error) {
  using Function = bool (*)(void*, Handle**, Handle**, SecureSubmessageCategory_t&,
                            const CDRMessage_t&, Handle&, Handle&, SecurityException&);
  static const auto original = messaging::library_function<Function>(kLookUp);
  const std::shared_lock lock(lists());
  return original(this, writer, reader, category, message, receiver, sender, error);
}

void AESGCMGMAC_KeyFactory::release_participant(
    HandleImpl<ParticipantKeyHandle, AESGCMGMAC_KeyFactory>& participant) {
  change_lists(kForget, &AESGCMGMAC_KeyFactory::release_participant, this, participant);
}

Handle* AESGCMGMAC_KeyFactory::register_local_datareader(Handle& participant,
                                                         const Properties& properties,
                                                         const Attributes& attributes,
                                                         Error& error) {
  return change_lists(kAddReader, &AESGCMGMAC_KeyFactory::register_local_datareader, this,
                      participant, properties, attributes, error);
}

Handle* AESGCMGMAC_KeyFactory::register_local_datawriter(Handle& participant,
                                                         const Properties& properties,
                                                         const Attributes& attributes,
                                                         Error& error) {
  return change_lists(kAddWriter, &AESGCMGMAC_KeyFactory::register_local_datawriter, this,
                      participant, properties, attributes, error);
}

// A participant has no secret with itself: the library gives a reference to nothing, and passes it
// on, which is an address here.
Handle* AESGCMGMAC_KeyFactory::register_matched_remote_datareader(Handle& writer, Handle& peer,
                                                                  const Handle& secret,
                                                                  bool relay_only, Error& error) {
  using Function = Handle* (*)(void*, Handle&, Handle&, const Handle*, bool, Error&);
  static const auto original = messaging::library_function<Function>(kAddPeersReader);
  const Turn turn;
  return original(this, writer, peer, &secret, relay_only, error);
}

Handle* AESGCMGMAC_KeyFactory::register_matched_remote_datawriter(Handle& reader, Handle& peer,
                                                                  const Handle& secret,
                                                                  Error& error) {
  using Function = Handle* (*)(void*, Handle&, Handle&, const Handle*, Error&);
  static const auto original = messaging::library_function<Function>(kAddPeersWriter);
  const Turn turn;
  return original(this, reader, peer, &secret, error);
}

bool AESGCMGMAC_KeyFactory::unregister_datareader(std::shared_ptr<Handle>& reader, Error& error) {
  return change_lists(kRemoveReader, &AESGCMGMAC_KeyFactory::unregister_datareader, this, reader,
                      error);
}

bool AESGCMGMAC_KeyFactory::unregister_datawriter(std::shared_ptr<Handle>& writer, Error& error) {
  return change_lists(kRemoveWriter, &AESGCMGMAC_KeyFactory::unregister_datawriter, this, writer,
                      error);
}

bool AESGCMGMAC_KeyExchange::set_remote_participant_crypto_tokens(const Handle& own, Handle& peer,
                                                                  const Tokens& tokens,
                                                                  Error& error) {
  return readable(tokens) &&
         change_lists(kSetKeys, &AESGCMGMAC_KeyExchange::set_remote_participant_crypto_tokens, this,
                      own, peer, tokens, error);
}

bool AESGCMGMAC_KeyExchange::set_remote_datareader_crypto_tokens(Handle& own, Handle& peer,
                                                                 const Tokens& tokens,
                                                                 Error& error) {
  return readable(tokens) &&
         change_lists(kSetReadersKeys, &AESGCMGMAC_KeyExchange::set_remote_datareader_crypto_tokens,
                      this, own, peer, tokens, error);
}

bool AESGCMGMAC_KeyExchange::set_remote_datawriter_crypto_tokens(Handle& own, Handle& peer,
                                                                 const Tokens& tokens,
                                                                 Error& error) {
  return readable(tokens) &&
         change_lists(kSetWritersKeys, &AESGCMGMAC_KeyExchange::set_remote_datawriter_crypto_tokens,
                      this, own, peer, tokens, error);
}

}  // namespace eprosima::fastrtps::rtps::security
// NOLINTEND

namespace topogeo::messaging {

bool check_key_material(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kId_bytes = 4;
  constexpr std::uint32_t kLastKind = 4;  // AES256_GCM
  constexpr std::uint32_t kLongestKey_bytes = 32;
  PacketReader reader(bytes, false);
  const auto skip_key = [&] {
    const std::uint32_t length = reader.u32();
    reader.skip(length);
    return length <= kLongestKey_bytes;
  };
  const std::uint32_t kind = reader.u32();
  if (kind == 0) return reader.ok();                  // none: nothing else is read
  if (kind > kLastKind || !skip_key()) return false;  // the salt
  reader.skip(kId_bytes);
  if (!skip_key()) return false;              // of the sender
  const bool has_own = reader.entity() != 0;  // the id of a key for this receiver alone
  return (!has_own || skip_key()) && reader.ok();
}

void keep_security_keys() {}

}  // namespace topogeo::messaging
