#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

namespace parkade {

/// The kernel's list of sockets that one thread waits for, each under a number. Throws
/// Error{kInternal} where the machine has no descriptor left for it.
class Epoll {
 public:
  Epoll();
  ~Epoll();
  Epoll(const Epoll&) = delete;
  Epoll& operator=(const Epoll&) = delete;

  enum class For { kInput, kOutput };

  /// Watches for input and the other side's end, or for room for output. False when the kernel has
  /// no room.
  bool Add(int fd, std::uint64_t number, For what = For::kInput);
  void Remove(int fd);

  /// Numbers of sockets that are ready; waits for some at most `patience`.
  std::vector<std::uint64_t> Wait(std::chrono::milliseconds patience);

  /// Ends a Wait, or else the next one. From any thread.
  void Wake();

 private:
  static constexpr std::uint64_t kWake = ~std::uint64_t{0};  ///< the number of wake_fd_

  int epoll_fd_ = -1, wake_fd_ = -1;
};

}  // namespace parkade
