#include "core/parallel.h"

#include <dlfcn.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <stop_token>
#include <thread>

namespace parkade {
namespace {

thread_local bool is_inside_body = false;

/// One ParallelFor in progress.
struct Task {
  std::size_t count = 0;
  const std::function<void(std::size_t)>* body = nullptr;
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::size_t failed_index = SIZE_MAX;
  std::exception_ptr failure;

  void Work() {
    is_inside_body = true;
    for (std::size_t i; (i = next.fetch_add(1)) < count;) {
      try {
        (*body)(i);
      } catch (...) {
        // The lowest index wins, so that the same input reports the same error.
        const std::lock_guard lock(mutex);
        if (i < failed_index) {
          failed_index = i;
          failure = std::current_exception();
        }
      }
    }
    is_inside_body = false;
  }
};

/// Threads that wait for a task; the calling thread works too.
class WorkerPool {
 public:
  explicit WorkerPool(int num_workers) {
    for (int i = 0; i < num_workers; ++i) threads_.emplace_back([this](const std::stop_token& stop) { Run(stop); });
  }

  void Do(Task& task) {
    {
      const std::lock_guard lock(mutex_);
      task_ = &task;
      ++generation_;
    }
    wake_.notify_all();
    task.Work();
    std::unique_lock lock(mutex_);
    task_ = nullptr;
    done_.wait(lock, [this] { return num_busy_ == 0; });
  }

 private:
  void Run(const std::stop_token& stop) {
    std::size_t seen = 0;
    std::unique_lock lock(mutex_);
    while (wake_.wait(lock, stop, [&] { return task_ != nullptr && generation_ != seen; })) {
      seen = generation_;
      Task& task = *task_;
      ++num_busy_;
      lock.unlock();
      task.Work();
      lock.lock();
      if (--num_busy_ == 0) done_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable_any wake_, done_;
  Task* task_ = nullptr;
  std::size_t generation_ = 0;
  int num_busy_ = 0;
  std::vector<std::jthread> threads_;
};

int& ThreadCount() {
  static int count = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  return count;
}

}  // namespace

void KeepLinearAlgebraToCaller() {
  using SetThreads = void (*)(int);
  if (void* set_threads = dlsym(RTLD_DEFAULT, "openblas_set_num_threads")) reinterpret_cast<SetThreads>(set_threads)(1);
}

void SetNumThreads(int num_threads) { ThreadCount() = std::max(1, num_threads); }

int NumThreads() { return ThreadCount(); }

void ParallelFor(std::size_t count, const std::function<void(std::size_t)>& body) {
  if (is_inside_body || count < 2 || NumThreads() == 1) {
    for (std::size_t i = 0; i < count; ++i) body(i);
    return;
  }
  static WorkerPool pool(NumThreads() - 1);
  // One ParallelFor at a time; a second thread of ours waits for the first.
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  Task task;
  task.count = count;
  task.body = &body;
  pool.Do(task);
  if (task.failure) std::rethrow_exception(task.failure);
}

}  // namespace parkade
