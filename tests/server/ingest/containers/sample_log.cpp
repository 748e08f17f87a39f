#include "tests/server/ingest/containers/sample_log.h"

#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "server/ingest/containers/chunk_codec.h"
#include "server/ingest/containers/open_message_source.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

const fs::path kScripts = fs::path(PARKADE_LOG_TESTS_FOLDER);
constexpr std::int64_t kBegin = 1'700'000'000'000'000'000;

std::vector<std::uint8_t> Payload(std::size_t topic, int tick) {
  std::vector<std::uint8_t> bytes(kSampleTopics[topic].size);
  const auto put = [&](std::size_t offset, std::uint32_t value) {
    std::memcpy(&bytes[offset], &value, 4);
  };
  put(0, static_cast<std::uint32_t>(topic * 65536));
  put(4, static_cast<std::uint32_t>(tick));
  auto random = static_cast<std::uint32_t>(topic * 65536) + static_cast<std::uint32_t>(tick) + 1;
  for (std::size_t i = 8; i < bytes.size() - 4; ++i) {
    random = random * 1664525u + 1013904223u;
    bytes[i] = static_cast<std::uint8_t>((i & 15) != 0 ? i >> 4 : random >> 24);
  }
  put(bytes.size() - 4, UpdateCrc32(0, std::span(bytes).first(bytes.size() - 4)));
  return bytes;
}

std::string Quoted(const std::string& text) { return "'" + text + "'"; }

std::string CommandOf(const std::string& script, const std::vector<std::string>& arguments) {
  // Debian's Python: rosbag is a package of Debian.
  std::string command =
      script.ends_with(".py") ? "PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 " : "node ";
  command += Quoted((kScripts / script).string());
  for (const std::string& argument : arguments) command += " " + Quoted(argument);
  return command;
}

}  // namespace

const std::vector<SampleMessage>& SampleMessages() {
  static const std::vector<SampleMessage> all = [] {
    std::vector<SampleMessage> messages;
    for (int tick = 0; tick < 400; ++tick)
      for (std::size_t topic = 0; topic < kSampleTopics.size(); ++topic) {
        if (tick < kSampleTopics[topic].begin || tick % kSampleTopics[topic].period != 0) continue;
        const Timestamp time{kBegin + tick * 10'000'000LL +
                             static_cast<std::int64_t>(topic) * 1000};
        messages.push_back({topic, time, Payload(topic, tick)});
      }
    return messages;
  }();
  return all;
}

std::optional<std::size_t> FindSample(const std::string& topic, const RawMessage& message) {
  static const std::map<Timestamp, std::size_t> by_time = [] {
    std::map<Timestamp, std::size_t> map;
    for (std::size_t i = 0; i < SampleMessages().size(); ++i) map[SampleMessages()[i].time] = i;
    return map;
  }();
  const auto found = by_time.find(message.log_time);
  if (found == by_time.end()) return std::nullopt;
  const SampleMessage& sample = SampleMessages()[found->second];
  if (kSampleTopics[sample.topic].topic != topic || sample.data != message.data)
    return std::nullopt;
  return found->second;
}

std::optional<std::string> RunScript(const std::string& script,
                                     const std::vector<std::string>& arguments) {
  FILE* pipe = ::popen(CommandOf(script, arguments).c_str(), "r");
  if (pipe == nullptr) return std::nullopt;
  std::string output;
  std::array<char, 256> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    output.append(buffer.data(), count);
  return ::pclose(pipe) == 0 ? std::optional(output) : std::nullopt;
}

std::optional<SampleFile> MakeSample(const std::string& script, const std::string& extension,
                                     const std::vector<std::string>& arguments) {
  const fs::path folder = fs::path(PARKADE_LOG_SAMPLES_FOLDER);
  fs::create_directories(folder);
  std::string name = script;
  for (const std::string& argument : arguments) name += "-" + argument;
  SampleFile sample{folder / (name + extension), {}};
  const auto is_stale = [&](const fs::path& source) {
    return !fs::exists(sample.path) ||
           fs::last_write_time(source) > fs::last_write_time(sample.path);
  };
  const std::string chunks_suffix = ".json";
  const bool is_python = script.ends_with(".py");
  if (is_stale(kScripts / script) ||
      is_stale(kScripts / (is_python ? "sample.py" : "sample.mjs"))) {
    // Other test processes may be at the same: whole files only, by renaming.
    const fs::path mine = sample.path.string() + "." + std::to_string(::getpid());
    std::vector<std::string> all = {mine.string()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    if (!RunScript(script, all)) return std::nullopt;
    if (fs::exists(mine.string() + chunks_suffix))
      fs::rename(mine.string() + chunks_suffix, sample.path.string() + chunks_suffix);
    fs::rename(mine, sample.path);
  }
  std::ifstream stream(sample.path.string() + chunks_suffix);
  if (!stream.good()) return sample;
  const nlohmann::json layout = nlohmann::json::parse(stream);
  for (const auto& chunk : layout.at("chunks"))
    sample.chunks.push_back({chunk[0], chunk[1], chunk[2]});
  return sample;
}

std::size_t ReadLog::NumFoundOf(std::size_t first, std::size_t count) const {
  std::set<std::size_t> different;
  for (const std::size_t i : found)
    if (i >= first && i < first + count) different.insert(i);
  return different.size();
}

ReadLog ReadWhole(const MessageSource& source) {
  ReadLog log;
  log.topics = source.topics();
  const auto stream = source.Read(std::vector<bool>(log.topics.size(), true));
  while (const auto message = stream->Next()) {
    const auto sample =
        FindSample(log.topics.at(static_cast<std::size_t>(message->topic)).topic, *message);
    const auto again = source.ReadAt(message->topic, message->place);
    if (!again || again->data != message->data || again->log_time != message->log_time)
      ++log.num_misplaced;
    if (sample) {
      log.found.push_back(*sample);
    } else {
      ++log.num_wrong;
    }
  }
  log.damage = stream->damage();
  return log;
}

ReadLog ReadWhole(const fs::path& log) { return ReadWhole(*OpenMessageSource(log)); }

std::vector<std::size_t> AllSamples() {
  std::vector<std::size_t> all(SampleMessages().size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  return all;
}

ScratchFile::ScratchFile(const std::string& extension) {
  static int count = 0;
  path_ = fs::temp_directory_path() / ("parkade-test-" + std::to_string(::getpid()) + "-" +
                                       std::to_string(count++) + extension);
}

ScratchFile::~ScratchFile() {
  std::error_code ignored;
  fs::remove(path_, ignored);
}

void ScratchFile::Write(const std::vector<std::uint8_t>& bytes) const {
  std::ofstream stream(path_, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
}

std::vector<std::uint8_t> ReadBytes(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace parkade
