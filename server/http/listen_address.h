#pragma once

#include <string>

namespace parkade {

struct ListenAddress {
  std::string host;  ///< as given, without brackets
  int port = 0;
};

/// "127.0.0.1:8080", "localhost:0", "[::1]:8080". Throws Error{kUsage}.
ListenAddress ParseListenAddress(const std::string& text);

/// True for 127.0.0.0/8, ::1 and "localhost".
bool IsLoopback(const std::string& host);

}  // namespace parkade
