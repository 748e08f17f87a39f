#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <regex>
#include <string>
#include <vector>

#include "core/files/file.h"
#include "tests/server/http/running_service.h"

namespace parkade {

/// parkade_serve_program, with what it says in a file.
class ServiceProcess {
 public:
  explicit ServiceProcess(const std::filesystem::path& data, std::vector<std::string> wrapper = {})
      : log_(data.string() + "." + NewId() + ".log") {
    std::vector<std::string> arguments = std::move(wrapper);
    for (const std::string& argument :
         {std::string(SERVE_PROGRAM), std::string("serve"), data.string()})
      arguments.push_back(argument);
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ == 0) {
      const int fd = ::open(log_.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
      ::dup2(fd, 1);
      ::dup2(fd, 2);
      ::execvp(pointers[0], pointers.data());
      ::_exit(127);
    }
  }
  ~ServiceProcess() {
    if (pid_ > 0) End(SIGKILL);
  }
  ServiceProcess(const ServiceProcess&) = delete;
  ServiceProcess& operator=(const ServiceProcess&) = delete;

  /// Waits until it answers.
  int Port() {
    static const std::regex address("listening on http://127.0.0.1:([0-9]+)");
    std::smatch found;
    std::string text;
    const bool listens =
        Eventually([&] { return std::regex_search(text = Said(), found, address); });
    if (!listens) throw std::runtime_error("the service does not listen: " + Said());
    return std::stoi(found[1]);
  }
  std::string Said() const { return std::filesystem::exists(log_) ? ReadFile(log_) : ""; }

  /// Sends a signal and returns the status of its end.
  int End(int signal) {
    ::kill(pid_, signal);
    return Wait();
  }
  int Wait() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return status;
  }
  pid_t pid() const { return pid_; }
  bool HasEnded() const {
    siginfo_t end{};
    return ::waitid(P_PID, static_cast<id_t>(pid_), &end, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           end.si_pid == pid_;
  }

 private:
  std::filesystem::path log_;
  pid_t pid_ = -1;
};

}  // namespace parkade
