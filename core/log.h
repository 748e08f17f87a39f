#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

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

/// What a line says besides its sentence: "status=404" as text, "status": 404 as JSON.
struct LogField {
  LogField(std::string field, std::string text) : name(std::move(field)), value(std::move(text)) {}
  LogField(std::string field, const char* text) : name(std::move(field)), value(text) {}
  LogField(std::string field, std::int64_t number)
      : name(std::move(field)), value(std::to_string(number)), is_number(true) {}
  LogField(std::string field, int number) : LogField(std::move(field), std::int64_t{number}) {}
  /// With three digits behind the point.
  LogField(std::string field, double number);

  std::string name;
  std::string value;
  bool is_number = false;
};
using LogFields = std::vector<LogField>;

enum class LogLineFormat {
  kText,  ///< "2026-11-21T04:22:27.123Z info job started job=6f attempt=1"
  kJson,  ///< {"time":"2026-11-21T04:22:27.123Z","level":"info","message":"job started",...}
};

/// Text from the start. Thread-safe.
void SetLogLineFormat(LogLineFormat format);

/// Writes one line as Log(level, message) does, with the fields and those of the thread's contexts.
void Log(LogLevel level, const std::string& message, const LogFields& fields);

/// Fields that every line of this thread has while the object lives: the request or the job that it
/// works for. Contexts end in the order opposite to their beginning.
class LogContext {
 public:
  explicit LogContext(LogFields fields);
  ~LogContext();
  LogContext(const LogContext&) = delete;
  LogContext& operator=(const LogContext&) = delete;

 private:
  const size_t num_fields_;
};

}  // namespace parkade
