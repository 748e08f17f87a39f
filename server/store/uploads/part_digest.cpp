#include "server/store/uploads/part_digest.h"

#include <openssl/evp.h>

#include "core/error.h"

namespace parkade {

void PartDigest::Free::operator()(evp_md_ctx_st* context) const { EVP_MD_CTX_free(context); }

PartDigest::PartDigest(const std::string& algorithm) : context_(EVP_MD_CTX_new()) {
  const EVP_MD* method = algorithm == "sha1"     ? EVP_sha1()
                         : algorithm == "sha256" ? EVP_sha256()
                                                 : nullptr;
  Require(method != nullptr, ErrorCode::kInvalidInput,
          "a part is checked by 'sha1' or 'sha256', not by '" + algorithm + "'");
  Require(context_ && EVP_DigestInit_ex(context_.get(), method, nullptr) == 1, ErrorCode::kInternal,
          "'" + algorithm + "' is not available");
}

void PartDigest::Add(std::string_view bytes) {
  EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size());
}

std::string PartDigest::Finish() {
  std::string digest(EVP_MAX_MD_SIZE, '\0');
  unsigned int size = 0;
  EVP_DigestFinal_ex(context_.get(), reinterpret_cast<unsigned char*>(digest.data()), &size);
  digest.resize(size);
  return digest;
}

}  // namespace parkade
