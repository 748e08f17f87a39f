#pragma once

#include <filesystem>
#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace parkade {

/// SHA-256 of what was added, as 64 hexadecimal digits.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void Add(std::string_view bytes);
  std::string Finish();

 private:
  evp_md_ctx_st* context_;
};

/// The SHA-256 of these bytes.
std::string Sha256Of(std::string_view bytes);

/// The SHA-256 of the file's content. Throws Error{kInternal} where it cannot be read.
std::string Sha256OfFile(const std::filesystem::path& file);

}  // namespace parkade
