#pragma once

#include <string>

namespace parkade {

enum class SecretKind { kToken, kShare, kSession };

/// "parkade_token_", ...: tells what a secret is for, and lets those who scan for leaked secrets
/// find it.
const char* PrefixOf(SecretKind kind);

/// A prefix and 256 random bits in base64url. Throws Error{kInternal} where the kernel has no
/// random numbers.
std::string NewSecret(SecretKind kind);

/// What is stored of a secret. It has too many bits to be guessed, so that one round of SHA-256
/// without salt is enough.
std::string HashOfSecret(const std::string& secret);

}  // namespace parkade
