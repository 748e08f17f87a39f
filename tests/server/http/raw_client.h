#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>

namespace parkade {

/// A socket that says what no decent client would.
class RawClient {
 public:
  explicit RawClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  }
  ~RawClient() { Close(); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  void Close() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }

  /// False when the other side no longer listens.
  bool Send(const std::string& text) {
    for (size_t sent = 0; sent < text.size();) {
      const ssize_t result = ::send(socket_, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
      if (result <= 0) return false;
      sent += static_cast<size_t>(result);
    }
    return true;
  }

  /// What comes until `end` is in it, the other side closes, or a minute has passed.
  std::string ReceiveUntil(const std::string& end) {
    while (received_.find(end) == std::string::npos) {
      pollfd wanted{socket_, POLLIN, 0};
      if (::poll(&wanted, 1, 60'000) <= 0) break;
      std::string piece(65536, '\0');
      const ssize_t size = ::recv(socket_, piece.data(), piece.size(), 0);
      if (size <= 0) break;
      received_ += piece.substr(0, static_cast<size_t>(size));
    }
    return received_;
  }
  int socket() const { return socket_; }
  std::string ReceiveAll() { return ReceiveUntil("\x01 never"); }

 private:
  int socket_;
  std::string received_;
};

/// "HTTP/1.1 404 Not Found ..." -> 404; 0 for no answer.
inline int StatusOf(const std::string& answer) {
  return answer.starts_with("HTTP/1.1 ") && answer.size() > 12 ? std::stoi(answer.substr(9, 3)) : 0;
}

}  // namespace parkade
