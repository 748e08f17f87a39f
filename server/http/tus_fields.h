#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include "server/store/uploads/resumable_uploads.h"

namespace parkade {

// Header fields of tus 1.0.0, https://tus.io/protocols/resumable-upload.

/// "key dGV4dA==, other" as keys with their texts. Throws Error{kInvalidInput} where it is
/// malformed or a key stands twice.
std::map<std::string, std::string> ParseTusMetadata(const std::string& field);

/// "sha1 Kq5sNclPz7QV2+lfQIuc6R7oRu0=". Throws Error{kInvalidInput} for other algorithms.
PartChecksum ParseTusChecksum(const std::string& field);

/// A number of bytes. Throws Error{kInvalidInput} unless the field is one.
std::int64_t ParseTusLength(const std::string& name, const std::string& field);

/// A time of the database as HTTP writes dates, "Thu, 26 Nov 2026 23:17:26 GMT".
std::string HttpDate(const std::string& utc);

}  // namespace parkade
