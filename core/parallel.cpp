#include "core/parallel.h"

#include <dlfcn.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

namespace parkade {
namespace {

/// One ParallelFor in progress.
struct Task {
  std::size_t count = 0;
  const std::function<void(std::size_t)>* body = nullptr;
  const Task* outer = nullptr;  // whose body asked for this one
  std::atomic<std::size_t> next{0};
  int num_helpers = 0;  // guarded by the pool
  std::mutex mutex;
  std::size_t failed_index = SIZE_MAX;
  std::exception_ptr failure;

  bool HasMore() const { return next < count; }
  bool IsInside(const Task& other) const {
    return this == &other || (outer != nullptr && outer->IsInside(other));
  }
  void Work();
};

thread_local const Task* task_of_thread = nullptr;

void Task::Work() {
  const Task* before = std::exchange(task_of_thread, this);
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
  task_of_thread = before;
}

/// Threads that help where more is to be done than whoever asked can do alone. Whoever waits for
/// helpers helps with what they ask for meanwhile, and with nothing else: that could take longer
/// than its own task, or wait for it.
class WorkerPool {
 public:
  explicit WorkerPool(int num_workers) {
    for (int i = 0; i < num_workers; ++i)
      threads_.emplace_back([this](const std::stop_token& stop) { Run(stop); });
  }

  void Do(Task& task) {
    task.outer = task_of_thread;
    {
      const std::lock_guard lock(mutex_);
      tasks_.push_back(&task);
    }
    change_.notify_all();
    task.Work();
    std::unique_lock lock(mutex_);
    while (task.num_helpers > 0) {
      if (Task* inner = FindTask(&task))
        Help(*inner, lock);
      else
        change_.wait(lock);
    }
    std::erase(tasks_, &task);
  }

 private:
  void Run(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    Task* task = nullptr;
    while (change_.wait(lock, stop, [&] { return (task = FindTask(nullptr)) != nullptr; }))
      Help(*task, lock);
  }

  void Help(Task& task, std::unique_lock<std::mutex>& lock) {
    ++task.num_helpers;
    lock.unlock();
    task.Work();
    lock.lock();
    if (--task.num_helpers == 0) change_.notify_all();
  }

  /// The latest that has more to do, since others wait for it; of those inside `outer`, if any.
  Task* FindTask(const Task* outer) const {
    const auto found = std::find_if(tasks_.rbegin(), tasks_.rend(), [&](const Task* task) {
      return task->HasMore() && (outer == nullptr || task->IsInside(*outer));
    });
    return found == tasks_.rend() ? nullptr : *found;
  }

  std::mutex mutex_;
  std::condition_variable_any change_;  // of tasks_ or of the helpers of one
  std::vector<Task*> tasks_;            // the earliest first
  std::vector<std::jthread> threads_;
};

int& ThreadCount() {
  static int count = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  return count;
}

}  // namespace

void KeepLinearAlgebraToCaller() {
  using SetThreads = void (*)(int);
  if (void* set_threads = dlsym(RTLD_DEFAULT, "openblas_set_num_threads"))
    reinterpret_cast<SetThreads>(set_threads)(1);
}

void SetNumThreads(int num_threads) { ThreadCount() = std::max(1, num_threads); }

int NumThreads() { return ThreadCount(); }

void ParallelFor(std::size_t count, const std::function<void(std::size_t)>& body) {
  if (count < 2 || NumThreads() == 1) {
    for (std::size_t i = 0; i < count; ++i) body(i);
    return;
  }
  static WorkerPool pool(NumThreads() - 1);
  Task task;
  task.count = count;
  task.body = &body;
  pool.Do(task);
  if (task.failure) std::rethrow_exception(task.failure);
}

}  // namespace parkade
