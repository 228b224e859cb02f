// The certificates of a peer that is refused and retries. The plug-in is the library's, called as
// the library calls it.
#include "fast_dds/handshake_certificates.hpp"

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fastdds/rtps/attributes/RTPSParticipantAttributes.h>
#include <fastdds/rtps/common/CDRMessage_t.h>
#include <fastdds/rtps/common/Guid.h>
#include <fastdds/rtps/common/Token.h>
#include <fastdds/rtps/security/authentication/Authentication.h>
#include <fastdds/rtps/security/exceptions/SecurityException.h>
#include <gtest/gtest.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <unistd.h>

// NOLINTNEXTLINE: the name of a member function of the library
extern "C" eprosima::fastrtps::rtps::security::Authentication*
create_authentication_plugin(void* factory, const eprosima::fastrtps::rtps::PropertyPolicy& properties) __asm__(
    "_ZN8eprosima8fastrtps4rtps8security21SecurityPluginFactory28create_authentication_"
    "pluginERKNS1_14PropertyPolicyE");

namespace topogeo::messaging {
namespace {

namespace fs = std::filesystem;
namespace rtps = eprosima::fastrtps::rtps;
namespace security = rtps::security;

int g_certificates = 0;  // live in this process

void count_new(void* /*certificate*/, void* /*data*/, CRYPTO_EX_DATA* /*all*/, int /*index*/,
               long /*number*/, void* /*pointer*/) {
  ++g_certificates;
}
void count_free(void* /*certificate*/, void* /*data*/, CRYPTO_EX_DATA* /*all*/, int /*index*/,
                long /*number*/, void* /*pointer*/) {
  --g_certificates;
}

/// A stranger with a key and a self-signed certificate.
class Somebody {
 public:
  explicit Somebody(const char* name)
      : key_(EVP_EC_gen("P-256"), EVP_PKEY_free), certificate_(X509_new(), X509_free) {
    X509_set_version(certificate_.get(), 2);
    ASN1_INTEGER_set(X509_get_serialNumber(certificate_.get()), 1);
    X509_gmtime_adj(X509_getm_notBefore(certificate_.get()), -60);
    X509_gmtime_adj(X509_getm_notAfter(certificate_.get()), 3600);
    X509_set_pubkey(certificate_.get(), key_.get());
    X509_NAME* subject = X509_get_subject_name(certificate_.get());
    const std::string_view text = name;
    X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_ASC,
                               reinterpret_cast<const unsigned char*>(name),  // NOLINT
                               static_cast<int>(text.size()), -1, 0);
    X509_set_issuer_name(certificate_.get(), subject);
    X509_sign(certificate_.get(), key_.get(), EVP_sha256());
  }

  /// PEM.
  [[nodiscard]] std::vector<std::uint8_t> certificate() const {
    const std::unique_ptr<BIO, decltype(&BIO_free)> memory(BIO_new(BIO_s_mem()), BIO_free);
    PEM_write_bio_X509(memory.get(), certificate_.get());
    char* bytes = nullptr;
    const long size = BIO_get_mem_data(memory.get(), &bytes);
    return {bytes, bytes + size};
  }

  void write(const fs::path& certificate, const fs::path& key) const {
    const auto open = [](const fs::path& file) {
      return std::unique_ptr<std::FILE, decltype(&std::fclose)>(std::fopen(file.c_str(), "w"),
                                                                std::fclose);
    };
    PEM_write_X509(open(certificate).get(), certificate_.get());
    PEM_write_PrivateKey(open(key).get(), key_.get(), nullptr, nullptr, 0, nullptr, nullptr);
  }

 private:
  std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> key_;
  std::unique_ptr<X509, decltype(&X509_free)> certificate_;
};

class HandshakeCertificates : public testing::Test {
 protected:
  HandshakeCertificates() {
    keep_one_certificate_of_a_peer();
    participant_.length = participant_.max_size;
    static const int index =
        CRYPTO_get_ex_new_index(CRYPTO_EX_INDEX_X509, 0, nullptr, count_new, nullptr, count_free);
    static_cast<void>(index);
    fs::create_directories(folder_);
    we_.write(folder_ / "cert.pem", folder_ / "key.pem");
    rtps::RTPSParticipantAttributes attributes;
    const std::string prefix = "dds.sec.auth.builtin.PKI-DH.";
    const std::string url = "file://" + folder_.string();
    for (const auto& [name, file] :
         {std::pair{"identity_ca", "/cert.pem"}, std::pair{"identity_certificate", "/cert.pem"},
          std::pair{"private_key", "/key.pem"}}) {
      attributes.properties.properties().emplace_back(prefix + name, url + file);
    }
    rtps::PropertyPolicy plugin;
    plugin.properties().emplace_back("dds.sec.auth.plugin", "builtin.PKI-DH");
    plugin_.reset(create_authentication_plugin(nullptr, plugin));
    rtps::GUID_t adjusted;
    EXPECT_EQ(plugin_->validate_local_identity(&own_, adjusted, 0, attributes, guid(1), error_),
              security::VALIDATION_OK)
        << error_.what();
    rtps::IdentityToken* token = nullptr;
    EXPECT_TRUE(plugin_->get_identity_token(&token, *own_, error_));
    // The identity that a peer announces may differ from the certificate that it presents.
    plugin_->validate_remote_identity(&peer_, *own_, *token, guid(2), error_);
    plugin_->return_identity_token(token, error_);
  }
  ~HandshakeCertificates() override {
    plugin_->return_identity_handle(peer_, error_);
    plugin_->return_identity_handle(own_, error_);
    fs::remove_all(folder_);
  }

  static rtps::GUID_t guid(std::uint8_t number) {
    rtps::GUID_t result;
    result.guidPrefix.value[0] = number;
    result.entityId = rtps::c_EntityId_RTPSParticipant;
    return result;
  }

  /// A handshake message with the stranger's certificate.
  [[nodiscard]] security::HandshakeMessageToken message(const char* kind) const {
    security::HandshakeMessageToken token;
    token.class_id(std::string("DDS:Auth:PKI-DH:1.0+") + kind);
    rtps::BinaryProperty certificate;
    certificate.name("c.id");
    certificate.value(stranger_.certificate());
    certificate.propagate(true);
    token.binary_properties().push_back(certificate);
    return token;
  }

  fs::path folder_ =
      fs::temp_directory_path() / ("topogeo_handshake_" + std::to_string(::getpid()));
  Somebody we_{"we"};
  Somebody stranger_{"stranger"};
  std::unique_ptr<security::Authentication> plugin_;
  rtps::CDRMessage_t participant_{4};  // anything
  security::SecurityException error_;
  security::IdentityHandle* own_ = nullptr;
  security::IdentityHandle* peer_ = nullptr;
};

constexpr int kTries = 5;

TEST_F(HandshakeCertificates, OfAStrangerWhoBeginsAgainAndAgainOneIsKept) {
  const int before = g_certificates;
  for (int i = 0; i < kTries; ++i) {
    security::HandshakeHandle* handshake = nullptr;
    security::HandshakeMessageToken* answer = nullptr;
    EXPECT_NE(plugin_->begin_handshake_reply(&handshake, &answer, message("Req"), *peer_, *own_,
                                             participant_, error_),
              security::VALIDATION_PENDING_HANDSHAKE_MESSAGE);
  }
  EXPECT_EQ(g_certificates - before, 1);
}

TEST_F(HandshakeCertificates, OfAStrangerWhoAnswersAgainAndAgainOneIsKept) {
  security::HandshakeHandle* handshake = nullptr;
  security::HandshakeMessageToken* request = nullptr;
  ASSERT_EQ(
      plugin_->begin_handshake_request(&handshake, &request, *own_, *peer_, participant_, error_),
      security::VALIDATION_PENDING_HANDSHAKE_MESSAGE)
      << error_.what();
  const int before = g_certificates;
  for (int i = 0; i < kTries; ++i) {
    security::HandshakeMessageToken* answer = nullptr;
    EXPECT_NE(plugin_->process_handshake(&answer, message("Reply"), *handshake, error_),
              security::VALIDATION_OK_WITH_FINAL_MESSAGE);
  }
  EXPECT_EQ(g_certificates - before, 1);
  plugin_->return_handshake_handle(handshake, error_);
}

}  // namespace
}  // namespace topogeo::messaging
