#include "server/store/access/secrets.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>

#include "core/files/sha256.h"
#include "server/store/tables/names.h"

namespace parkade {

const char* PrefixOf(SecretKind kind) {
  switch (kind) {
    case SecretKind::kToken: return "parkade_token_";
    case SecretKind::kShare: return "parkade_share_";
    case SecretKind::kSession: break;
  }
  return "parkade_session_";
}

std::string NewSecret(SecretKind kind) {
  const std::vector<unsigned char> bytes = RandomBytes(32);
  std::array<unsigned char, 48> text{};
  const int size = EVP_EncodeBlock(text.data(), bytes.data(), static_cast<int>(bytes.size()));
  std::string secret(text.begin(), text.begin() + size);
  std::replace(secret.begin(), secret.end(), '+', '-');
  std::replace(secret.begin(), secret.end(), '/', '_');
  secret.erase(secret.find('='));
  return PrefixOf(kind) + secret;
}

std::string HashOfSecret(const std::string& secret) { return Sha256Of(secret); }

}  // namespace parkade
