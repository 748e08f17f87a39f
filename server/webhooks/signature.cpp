#include "server/webhooks/signature.h"

#include <openssl/evp.h>
#include <openssl/hmac.h>

#include <vector>

#include "core/error.h"
#include "server/store/tables/names.h"

namespace parkade {

std::string SignatureOf(const std::string& secret, const std::string& timestamp,
                        const std::string& body) {
  const std::string message = timestamp + "." + body;
  std::vector<unsigned char> digest(32);
  unsigned int size = 0;
  const unsigned char* made = HMAC(EVP_sha256(), secret.data(), static_cast<int>(secret.size()),
                                   reinterpret_cast<const unsigned char*>(message.data()),
                                   message.size(), digest.data(), &size);
  Require(made != nullptr && size == digest.size(), ErrorCode::kInternal,
          "a delivery cannot be signed");
  return HexOf(digest);
}

}  // namespace parkade
