#pragma once

#include <stdexcept>
#include <string>

namespace parkade {

/// What went wrong, in terms a caller can act on. Each value has one HTTP
/// status (server/http/error_response.cpp) and one exit status (server/main.cpp).
enum class ErrorCode {
  kInvalidInput,  ///< the input is at fault; the sentence says what and where
  kNotFound,
  kConflict,
  kForbidden,  ///< someone else may, not the one who asks
  kUsage,      ///< the command line or an option is at fault
  kDiskFull,   ///< no space left; nothing half-written stays behind
  kInternal,   ///< our fault
};

/// The only exception this program throws on purpose. `what()` is one sentence
/// that names the thing, fit to be shown to the user.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}

  ErrorCode code() const { return code_; }

 private:
  ErrorCode code_;
};

/// Throws unless `condition` holds. For input that we do not control; a broken
/// promise between two of our own functions is an assert().
inline void Require(bool condition, ErrorCode code, const std::string& message) {
  if (!condition) throw Error(code, message);
}

/// The same for inner loops: makes no string of the message unless it is thrown.
inline void Require(bool condition, ErrorCode code, const char* message) {
  if (!condition) throw Error(code, message);
}

}  // namespace parkade
