// Fast DDS 2.9.1 reads the certificate of each message that begins a handshake, or answers one, and
// keeps it with the identity of the peer, in the place of the one before, which is not given back
// (PKIDH::begin_handshake_reply, process_handshake_request). A peer that is refused tries once a
// second, so that a stranger could take all memory.
//
// Here the one before is given back, and the subject of the certificate is noted once a peer has
// shown that the key is its own: the one that a peer announces (dds.cert.sn of its identity token)
// is compared with nothing. The functions take the places of the library's, which calls
// them through its symbols. Should a library have no such functions, nothing calls these.
#include "handshake_certificates.hpp"

#include <array>
#include <cstddef>
#include <cstring>
#include <utility>

#include <fastdds/rtps/common/CDRMessage_t.h>
#include <fastdds/rtps/common/Guid.h>
#include <fastdds/rtps/common/Token.h>
#include <fastdds/rtps/security/authentication/Authentication.h>
#include <fastdds/rtps/security/common/Handle.h>
#include <fastdds/rtps/security/exceptions/SecurityException.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/x509.h>

#include "../security.hpp"
#include "library_function.hpp"

namespace {

namespace rtps = eprosima::fastrtps::rtps;
namespace security = rtps::security;

/// What the handle of an identity has (PKIIdentity), as far as it matters.
struct Identity {
  static constexpr const char* kHandle = "PKIIdentityHandle";
  X509_STORE* store;
  X509* certificate;
  EVP_PKEY* key;
  rtps::GUID_t participant;
};

/// The same of a handshake (PKIHandshake).
struct Handshake {
  static constexpr const char* kHandle = "PKIHandshakeHandle";
  std::array<std::byte, 0x38> others;
  security::Handle* peer;
};

/// What a handle has (HandleImpl, a pointer behind its base); null for one of another plug-in.
template <class Content>
Content* content_of(const security::Handle& handle) {
  void* content = nullptr;
  if (handle.get_class_id() == Content::kHandle) {
    std::memcpy(&content, reinterpret_cast<const std::byte*>(&handle) + sizeof handle,  // NOLINT
                sizeof content);
  }
  return static_cast<Content*>(content);
}

/// Gives the certificate back that was there at first, once another one has taken its place.
class LastCertificate {
 public:
  explicit LastCertificate(security::Handle* peer)
      : identity_(peer == nullptr ? nullptr : content_of<Identity>(*peer)),
        first_(identity_ == nullptr ? nullptr : identity_->certificate) {}
  LastCertificate(const LastCertificate&) = delete;
  LastCertificate& operator=(const LastCertificate&) = delete;
  ~LastCertificate() {
    if (first_ != nullptr && identity_->certificate != first_) X509_free(first_);
  }

 private:
  Identity* identity_;
  X509* first_;
};

void note_subject(const security::Handle* peer) {
  const Identity* identity = peer == nullptr ? nullptr : content_of<Identity>(*peer);
  if (identity == nullptr || identity->certificate == nullptr) return;
  char* const subject = X509_NAME_oneline(X509_get_subject_name(identity->certificate), nullptr, 0);
  if (subject != nullptr) {
    topogeo::messaging::note_subject(identity->participant.guidPrefix, subject);
  }
  OPENSSL_free(subject);
}

constexpr const char* kBeginReply =
    "_ZN8eprosima8fastrtps4rtps8security5PKIDH21begin_handshake_replyEPPNS2_6HandleEPPNS1_"
    "10DataHolderEOS7_RS4_RKS4_RKNS1_12CDRMessage_tERNS2_17SecurityExceptionE";
constexpr const char* kProcess =
    "_ZN8eprosima8fastrtps4rtps8security5PKIDH17process_handshakeEPPNS1_10DataHolderEOS4_RNS2_"
    "6HandleERNS2_17SecurityExceptionE";

}  // namespace

// NOLINTBEGIN: the names of member functions of the library
extern "C" security::ValidationResult_t
topogeo_begin_reply(void* plugin, security::HandshakeHandle** handshake, rtps::DataHolder** answer, rtps::DataHolder&& message, security::IdentityHandle& peer, const security::IdentityHandle& own, const rtps::CDRMessage_t& participant, security::SecurityException& error) __asm__(
    "_ZN8eprosima8fastrtps4rtps8security5PKIDH21begin_handshake_replyEPPNS2_6HandleEPPNS1_"
    "10DataHolderEOS7_RS4_RKS4_RKNS1_12CDRMessage_tERNS2_17SecurityExceptionE");
extern "C" security::ValidationResult_t
topogeo_process_handshake(void* plugin, rtps::DataHolder** answer, rtps::DataHolder&& message, security::HandshakeHandle& handshake, security::SecurityException& error) __asm__(
    "_ZN8eprosima8fastrtps4rtps8security5PKIDH17process_handshakeEPPNS1_10DataHolderEOS4_RNS2_"
    "6HandleERNS2_17SecurityExceptionE");
// NOLINTEND

extern "C" security::ValidationResult_t topogeo_begin_reply(
    void* plugin, security::HandshakeHandle** handshake, rtps::DataHolder** answer,
    rtps::DataHolder&& message, security::IdentityHandle& peer, const security::IdentityHandle& own,
    const rtps::CDRMessage_t& participant, security::SecurityException& error) {
  static const auto original =
      topogeo::messaging::library_function<decltype(&topogeo_begin_reply)>(kBeginReply);
  const LastCertificate last(&peer);
  return original(plugin, handshake, answer, std::move(message), peer, own, participant, error);
}

extern "C" security::ValidationResult_t topogeo_process_handshake(
    void* plugin, rtps::DataHolder** answer, rtps::DataHolder&& message,
    security::HandshakeHandle& handshake, security::SecurityException& error) {
  static const auto original =
      topogeo::messaging::library_function<decltype(&topogeo_process_handshake)>(kProcess);
  const Handshake* content = content_of<Handshake>(handshake);
  const LastCertificate last(content == nullptr ? nullptr : content->peer);
  const auto result = original(plugin, answer, std::move(message), handshake, error);
  if (content != nullptr &&
      (result == security::VALIDATION_OK || result == security::VALIDATION_OK_WITH_FINAL_MESSAGE)) {
    note_subject(content->peer);
  }
  return result;
}

namespace topogeo::messaging {

void keep_one_certificate_of_a_peer() {}

}  // namespace topogeo::messaging
