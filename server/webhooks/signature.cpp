#include "server/webhooks/signature.h"

#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <openssl/rand.h>

#include <array>

#include "core/error.h"

namespace parkade {
namespace {

using Bytes = std::array<unsigned char, 32>;

std::string HexOf(const Bytes& bytes) {
  constexpr char kHex[] = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : bytes) {
    text += kHex[byte >> 4];
    text += kHex[byte & 15];
  }
  return text;
}

}  // namespace

std::string NewSecret() {
  Bytes bytes{};
  Require(RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) == 1, ErrorCode::kInternal,
          "no random numbers are to be had");
  return HexOf(bytes);
}

std::string SignatureOf(const std::string& secret, const std::string& timestamp,
                        const std::string& body) {
  const std::string message = timestamp + "." + body;
  Bytes digest{};
  unsigned int size = 0;
  const unsigned char* made = HMAC(EVP_sha256(), secret.data(), static_cast<int>(secret.size()),
                                   reinterpret_cast<const unsigned char*>(message.data()),
                                   message.size(), digest.data(), &size);
  Require(made != nullptr && size == digest.size(), ErrorCode::kInternal,
          "a delivery cannot be signed");
  return HexOf(digest);
}

}  // namespace parkade
