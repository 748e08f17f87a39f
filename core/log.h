#pragma once

#include <string>

namespace parkade {

enum class LogLevel { kDebug, kInfo, kWarning, kError, kSilent };

/// Writes one line to stderr: "2026-11-21T04:22:27.123Z info stage=track frames=812". Control bytes
/// in `message` are escaped. Thread-safe.
void SetLogLevel(LogLevel level);
void Log(LogLevel level, const std::string& message);

inline void LogDebug(const std::string& message) { Log(LogLevel::kDebug, message); }
inline void LogInfo(const std::string& message) { Log(LogLevel::kInfo, message); }
inline void LogWarning(const std::string& message) { Log(LogLevel::kWarning, message); }
inline void LogError(const std::string& message) { Log(LogLevel::kError, message); }

}  // namespace parkade
