#pragma once

#include <exception>
#include <string>

#include "core/error.h"

namespace httplib {
struct Response;
}

namespace parkade {

/// An error as an answer, RFC 9457: {"type", "title", "status", "detail", "code"}.
struct Problem {
  int status = 500;
  std::string code;    ///< a word programs can rely on, "invalid_input"
  std::string detail;  ///< one sentence for people
};

/// The problem as JSON text.
std::string ToJsonText(const Problem& problem);

/// The status's name, "Not Found".
const char* TitleOf(int status);

Problem ProblemOf(const Error& error);

/// Problems of the HTTP layer itself, with a status no ErrorCode stands for.
class HttpError : public std::exception {
 public:
  explicit HttpError(Problem problem) : problem_(std::move(problem)) {}
  const Problem& problem() const { return problem_; }
  const char* what() const noexcept override { return problem_.detail.c_str(); }

 private:
  Problem problem_;
};

void SendProblem(httplib::Response& response, const Problem& problem);

/// The one place where a handler's exception becomes an answer. Messages of other libraries go to
/// the log, never to a stranger.
void SendException(httplib::Response& response, std::exception_ptr thrown);

}  // namespace parkade
