#include "server/jobs/pictures/picture_desk.h"

#include <algorithm>

#include "core/error.h"
#include "core/files/foreign_json.h"
#include "core/log.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr size_t kMaxTasks = 16;  // that wait, because each keeps a connection
constexpr size_t kMaxTimes = 16;  // drives whose times are in memory
constexpr std::chrono::seconds kPatience{30};
constexpr std::chrono::milliseconds kLookInterval{100};
constexpr std::chrono::seconds kIdle{60};  // after which a log is closed

const std::string kIndex = "/index.json";

/// What lies in the cache: a line that tells the sizes, and the JPEG.
std::optional<ServedPicture> ParsePicture(const std::string& content) {
  const size_t line = content.find('\n');
  const Json sizes = ParseForeignJson(std::string_view(content).substr(0, line));
  if (line == std::string::npos || !sizes.is_object()) return std::nullopt;
  return ServedPicture{{},
                       sizes.value("width", 0),
                       sizes.value("height", 0),
                       sizes.value("full_width", 0),
                       sizes.value("full_height", 0),
                       content.substr(line + 1)};
}

}  // namespace

PictureDesk::PictureDesk(const DataDirectory& directory, PictureOptions options,
                         const std::function<bool(const std::string& drive)>& is_drive)
    : directory_(directory),
      options_(std::move(options)),
      cache_(directory.PicturesFolder(), options_.cache, is_drive) {
  for (size_t i = 0; i < kNumThreads; ++i) threads_[i] = std::thread([this, i] { Work(i); });
}

PictureDesk::~PictureDesk() {
  Stop();
  for (std::thread& thread : threads_) thread.join();
}

void PictureDesk::Stop() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  changed_.notify_all();
}

std::shared_ptr<const PictureTimes> PictureDesk::TimesOf(const PictureLog& log,
                                                         const IsWanted& is_wanted) {
  {
    const std::lock_guard lock(mutex_);
    for (auto known = times_.begin(); known != times_.end(); ++known)
      if (known->first == log.Folder()) {
        times_.splice(times_.begin(), times_, known);
        return known->second;
      }
  }
  std::optional<std::string> index = cache_.Find(log.Folder() + kIndex);
  if (!index) {
    Do(log, nullptr, log.Folder() + kIndex, is_wanted);
    index = cache_.Find(log.Folder() + kIndex);
  }
  Require(index.has_value(), ErrorCode::kInternal, "the index of pictures is gone");
  auto times = std::make_shared<const PictureTimes>(ParsePictureTimes(*index));
  const std::lock_guard lock(mutex_);
  times_.emplace_front(log.Folder(), times);
  if (times_.size() > kMaxTimes) times_.pop_back();
  return times;
}

ServedPicture PictureDesk::Read(const PictureLog& log, size_t camera, Timestamp time, int width,
                                const IsWanted& is_wanted) {
  const std::shared_ptr<const PictureTimes> times = TimesOf(log, is_wanted);
  // By numbers: the camera's name is the user's.
  const std::string name = log.Folder() + "/" + std::to_string(camera) + "-" +
                           std::to_string(time.ns) + "-" + std::to_string(width);
  std::optional<std::string> content = cache_.Find(name);
  if (!content) {
    Do(log,
       {{"camera", times->cameras.at(camera).name},
        {"time", time.ns},
        {"width", width},
        {"out", cache_.PathOf(name).string()}},
       name, is_wanted);
    content = cache_.Find(name);
  }
  std::optional<ServedPicture> picture = ParsePicture(content.value_or(""));
  Require(picture.has_value(), ErrorCode::kInternal, "the picture is gone");
  picture->time = time;
  return *picture;
}

Json PictureDesk::FindViews(const PictureLog& log, const Json& request, const IsWanted& is_wanted) {
  return Do(log, request, "", is_wanted).at("views");
}

Json PictureDesk::Do(const PictureLog& log, Json request, const std::string& makes,
                     const IsWanted& is_wanted) {
  const auto task = std::make_shared<Task>();
  task->log = log;
  task->request = std::move(request);
  task->makes = makes;
  std::future<Json> answer = task->answer.get_future();
  {
    const std::lock_guard lock(mutex_);
    std::erase_if(tasks_, [](const auto& waiting) { return !waiting->is_wanted; });
    Require(!is_stopping_ && tasks_.size() < kMaxTasks, ErrorCode::kConflict,
            "too many pictures are being read: try again in a moment");
    tasks_.push_back(task);
  }
  changed_.notify_all();
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (answer.wait_for(kLookInterval) != std::future_status::ready) {
    const bool is_over = std::chrono::steady_clock::now() > end;
    if (!is_over && is_wanted() && !is_stopping_) continue;
    task->is_wanted = false;
    throw Error(ErrorCode::kConflict, "the log is still being read: try again in a moment");
  }
  return answer.get();
}

void PictureDesk::Work(size_t thread) {
  Bench bench;
  while (!is_stopping_) {
    const std::shared_ptr<Task> task = Next(thread);
    if (task)
      Perform(*task, bench);
    else
      bench = {};
  }
}

/// The next task for a thread; nothing where none came for a while.
std::shared_ptr<PictureDesk::Task> PictureDesk::Next(size_t thread) {
  std::unique_lock lock(mutex_);
  std::shared_ptr<Task> task;
  changed_.wait_for(lock, kIdle, [&] { return is_stopping_ || (task = TakeTask(thread)); });
  open_[thread] = task ? task->log.Folder() : "";
  return task;
}

/// First of the log that the thread has open, then of any that no other thread has.
std::shared_ptr<PictureDesk::Task> PictureDesk::TakeTask(size_t thread) {
  const auto find = [&](const auto& fits) {
    return std::find_if(tasks_.begin(), tasks_.end(),
                        [&](const auto& task) { return fits(task->log.Folder()); });
  };
  auto chosen = find([&](const std::string& folder) { return folder == open_[thread]; });
  if (chosen == tasks_.end())
    chosen = find([&](const std::string& folder) {
      return std::find(open_.begin(), open_.end(), folder) == open_.end();
    });
  if (chosen == tasks_.end()) return nullptr;
  std::shared_ptr<Task> task = std::move(*chosen);
  tasks_.erase(chosen);
  return task;
}

void PictureDesk::Perform(Task& task, Bench& bench) {
  try {
    if (!task.is_wanted) return;
    if (!task.makes.empty() && cache_.Find(task.makes)) {  // meanwhile made for another
      task.answer.set_value(Json::object());
      return;
    }
    const bool wants_index = task.request.is_null();
    if (!bench.worker || bench.folder != task.log.Folder() || wants_index) Open(task.log, bench);
    Json answer = wants_index ? Json::object() : bench.worker->Ask(task.request);
    if (!task.makes.empty()) cache_.Add(task.makes);
    task.answer.set_value(std::move(answer));
  } catch (const std::exception& error) {
    LogWarning("picture drive=" + task.log.drive + " error=" + error.what());
    if (bench.worker && !bench.worker->is_alive()) bench = {};
    task.answer.set_exception(std::current_exception());
  }
}

void PictureDesk::Open(const PictureLog& log, Bench& bench) {
  bench = {};
  fs::create_directories(cache_.PathOf(log.Folder()));
  std::optional<fs::path> rig;
  if (log.rig) rig = directory_.RigFolder(*log.rig);
  const std::vector<std::string> command =
      options_.command(log.file, rig, cache_.PathOf(log.Folder() + kIndex));
  const WorkerPlace place{.folder = directory_.NewTemporaryPath(),
                          .log = {},
                          .writable = {cache_.PathOf(log.Folder())},
                          .hidden = directory_.root(),
                          .visible = {log.file, rig.value_or(fs::path()), directory_.MapsFolder()}};
  bench.worker =
      std::make_unique<PictureWorker>(command, place, options_.answer_limit, is_stopping_);
  bench.folder = log.Folder();
  cache_.Add(log.Folder() + kIndex);
}

}  // namespace parkade
