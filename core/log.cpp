#include "core/log.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace parkade {
namespace {

constexpr const char* kTextPattern = "%Y-%m-%dT%H:%M:%S.%eZ %l %v";
constexpr const char* kJsonPattern = R"({"time":"%Y-%m-%dT%H:%M:%S.%eZ","level":"%l",%v})";

std::atomic<LogLineFormat> log_format = LogLineFormat::kText;

LogFields& ContextOfThread() {
  thread_local LogFields fields;
  return fields;
}

spdlog::logger& Logger() {
  static spdlog::logger logger = [] {
    spdlog::logger made("parkade", std::make_shared<spdlog::sinks::stderr_sink_mt>());
    made.set_pattern(kTextPattern, spdlog::pattern_time_type::utc);
    return made;
  }();
  return logger;
}

spdlog::level::level_enum ToSpdlog(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug: return spdlog::level::debug;
    case LogLevel::kInfo: return spdlog::level::info;
    case LogLevel::kWarning: return spdlog::level::warn;
    case LogLevel::kError: return spdlog::level::err;
    case LogLevel::kSilent: return spdlog::level::off;
  }
  return spdlog::level::info;
}

// A user's file name must not be able to forge a second log line.
std::string Escaped(const std::string& message) {
  std::string escaped;
  escaped.reserve(message.size());
  for (const char c : message) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte != 0x7f) {
      escaped += c;
    } else {
      constexpr char kHex[] = "0123456789abcdef";
      escaped += "\\x";
      escaped += kHex[byte >> 4];
      escaped += kHex[byte & 15];
    }
  }
  return escaped;
}

/// In quotes, in ASCII alone; what is no UTF-8 is replaced.
std::string Quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', /*ensure_ascii=*/true,
                                   nlohmann::json::error_handler_t::replace);
}

void AppendText(std::string& line, const LogFields& fields) {
  for (const LogField& field : fields) line += " " + field.name + "=" + field.value;
}

void AppendJson(std::string& line, const LogFields& fields) {
  for (const LogField& field : fields)
    line += ",\"" + field.name + "\":" + (field.is_number ? field.value : Quoted(field.value));
}

}  // namespace

LogField::LogField(std::string field, double number) : name(std::move(field)), is_number(true) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.3f", number);
  value = text.data();
}

void SetLogLevel(LogLevel level) { Logger().set_level(ToSpdlog(level)); }

void SetLogLineFormat(LogLineFormat format) {
  log_format = format;
  Logger().set_pattern(format == LogLineFormat::kJson ? kJsonPattern : kTextPattern,
                       spdlog::pattern_time_type::utc);
}

void Log(LogLevel level, const std::string& message) { Log(level, message, {}); }

void Log(LogLevel level, const std::string& message, const LogFields& fields) {
  if (!Logger().should_log(ToSpdlog(level))) return;
  const bool is_json = log_format == LogLineFormat::kJson;
  std::string line = is_json ? "\"message\":" + Quoted(message) : message;
  const LogFields& context = ContextOfThread();
  for (const LogFields* some : {&fields, &context})
    is_json ? AppendJson(line, *some) : AppendText(line, *some);
  Logger().log(ToSpdlog(level), is_json ? line : Escaped(line));
}

LogContext::LogContext(LogFields fields) : num_fields_(fields.size()) {
  LogFields& context = ContextOfThread();
  context.insert(context.end(), std::make_move_iterator(fields.begin()),
                 std::make_move_iterator(fields.end()));
}

LogContext::~LogContext() {
  LogFields& context = ContextOfThread();
  context.erase(context.end() - static_cast<std::ptrdiff_t>(num_fields_), context.end());
}

}  // namespace parkade
