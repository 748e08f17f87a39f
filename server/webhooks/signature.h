#pragma once

#include <string>

namespace parkade {

/// What a delivery is signed with: HMAC-SHA256 over "<timestamp>.<body>", 64 hexadecimal digits.
std::string SignatureOf(const std::string& secret, const std::string& timestamp,
                        const std::string& body);

}  // namespace parkade
