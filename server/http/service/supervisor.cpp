#include "server/http/service/supervisor.h"

#include <httplib.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <cstring>

#include "core/log.h"

namespace parkade {
namespace {

void Tell(const std::string& state) {
  const char* name = std::getenv("NOTIFY_SOCKET");
  sockaddr_un address{};
  if (name == nullptr || std::strlen(name) >= sizeof(address.sun_path)) return;
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, name, std::strlen(name));
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + std::strlen(name));
  if (name[0] == '@') address.sun_path[0] = '\0';  // an abstract name
  const int fd = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ::sendto(fd, state.data(), state.size(), MSG_NOSIGNAL, reinterpret_cast<sockaddr*>(&address),
           size);
  ::close(fd);
}

/// How often to say that all is well, in a third of the time that systemd waits; 0: never.
std::chrono::microseconds WatchInterval() {
  const char* text = std::getenv("WATCHDOG_USEC");
  return std::chrono::microseconds(text == nullptr ? 0 : std::strtoll(text, nullptr, 10) / 3);
}

}  // namespace

Supervisor::Supervisor(std::string host, int port) : host_(std::move(host)), port_(port) {
  Tell("READY=1\nSTATUS=listening on port " + std::to_string(port_));
  if (WatchInterval().count() > 0) thread_ = std::thread([this] { Watch(); });
}

Supervisor::~Supervisor() {
  Tell("STOPPING=1");
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  stopping_.notify_all();
  if (thread_.joinable()) thread_.join();
}

bool Supervisor::IsAnswering() const {
  const bool is_anywhere = host_ == "0.0.0.0" || host_ == "::";
  httplib::Client client(is_anywhere ? "127.0.0.1" : host_, port_);
  client.set_connection_timeout(5);
  client.set_read_timeout(5);
  const auto answer = client.Get("/healthz");
  return answer && answer->status == 200;
}

void Supervisor::Watch() {
  std::unique_lock lock(mutex_);
  while (!stopping_.wait_for(lock, WatchInterval(), [this] { return is_stopping_; })) {
    lock.unlock();
    if (IsAnswering()) {
      Tell("WATCHDOG=1");
    } else {
      LogError("the service does not answer itself");
    }
    lock.lock();
  }
}

}  // namespace parkade
