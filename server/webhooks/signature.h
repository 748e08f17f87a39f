#pragma once

#include <string>

namespace parkade {

/// 64 hexadecimal digits of the kernel's random numbers. Throws Error{kInternal} without any.
std::string NewSecret();

/// What a delivery is signed with: HMAC-SHA256 over "<timestamp>.<body>", 64 hexadecimal digits.
std::string SignatureOf(const std::string& secret, const std::string& timestamp,
                        const std::string& body);

}  // namespace parkade
