#include "server/http/epoll.h"

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>

#include "core/error.h"

namespace parkade {

Epoll::Epoll()
    : epoll_fd_(::epoll_create1(EPOLL_CLOEXEC)),
      wake_fd_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  Require(epoll_fd_ >= 0 && wake_fd_ >= 0 && Add(wake_fd_, kWake), ErrorCode::kInternal,
          "no file descriptor is left to wait for connections with");
}

Epoll::~Epoll() {
  ::close(epoll_fd_);
  ::close(wake_fd_);
}

bool Epoll::Add(int fd, std::uint64_t number, For what) {
  epoll_event event{};
  event.events = what == For::kInput ? EPOLLIN : EPOLLOUT;
  event.data.u64 = number;
  return ::epoll_ctl(epoll_fd_, EPOLL_CTL_ADD, fd, &event) == 0;
}

void Epoll::Remove(int fd) { ::epoll_ctl(epoll_fd_, EPOLL_CTL_DEL, fd, nullptr); }

std::vector<std::uint64_t> Epoll::Wait(std::chrono::milliseconds patience) {
  std::array<epoll_event, 256> events{};
  const int count = ::epoll_wait(epoll_fd_, events.data(), static_cast<int>(events.size()),
                                 static_cast<int>(patience.count()));
  std::vector<std::uint64_t> numbers;
  for (int i = 0; i < count; ++i) {
    const std::uint64_t number = events[static_cast<size_t>(i)].data.u64;
    std::uint64_t wakes = 0;
    if (number != kWake)
      numbers.push_back(number);
    else
      while (::read(wake_fd_, &wakes, sizeof(wakes)) > 0) {
      }
  }
  return numbers;
}

void Epoll::Wake() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t ignored = ::write(wake_fd_, &one, sizeof(one));
}

}  // namespace parkade
