#pragma once

#include <memory>
#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace parkade {

/// A hash of one part of an upload, as the tus checksum extension names them.
class PartDigest {
 public:
  /// Throws Error{kInvalidInput} for other algorithms than "sha1" and "sha256".
  explicit PartDigest(const std::string& algorithm);

  void Add(std::string_view bytes);
  /// The digest's bytes.
  std::string Finish();

 private:
  struct Free {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Free> context_;
};

}  // namespace parkade
