#include "tests/simulator/drives/run_suite.h"

#include <chrono>
#include <iomanip>

#include "core/error.h"
#include "core/files/file.h"
#include "tests/simulator/drives/drive_summary.h"

namespace parkade::simulator {
namespace {

namespace fs = std::filesystem;

/// The summary of a drive that is there already with these options, or null.
nlohmann::json FindFinished(const fs::path& folder, const SimulateOptions& options) {
  const fs::path summary_file = folder / "truth" / "summary.json";
  if (!fs::exists(summary_file) || !fs::exists(folder / "drive.mcap")) return nullptr;
  const nlohmann::json summary =
      nlohmann::json::parse(ReadFile(summary_file), nullptr, /*allow_exceptions=*/false);
  const bool is_same = summary.is_object() && summary.value("options_hash", "") == HashOf(options);
  return is_same ? summary : nlohmann::json(nullptr);
}

/// Made under another name, so that what has its right name is whole.
nlohmann::json MakeDrive(const fs::path& folder, const SimulateOptions& options) {
  fs::path unfinished = folder;
  unfinished += ".part";
  fs::remove_all(unfinished);
  fs::create_directories(unfinished);
  const nlohmann::json summary = SimulateDrive(
      options, {.log = unfinished / "drive.mcap", .rig = {}, .truth = unfinished / "truth"},
      [](const std::string&, double) {});
  fs::remove_all(folder);
  fs::rename(unfinished, folder);
  return summary;
}

}  // namespace

std::vector<Preset> ChoosePresets(const std::vector<std::string>& names, bool is_quick) {
  std::vector<Preset> chosen = names.empty() ? Presets() : std::vector<Preset>{};
  for (const std::string& name : names) {
    const Preset* preset = FindPreset(name);
    Require(preset != nullptr, ErrorCode::kUsage, "there is no preset '" + name + "' (see --list)");
    chosen.push_back(*preset);
  }
  for (Preset& preset : chosen)
    if (is_quick) preset.options = QuickForm(preset.options);
  return chosen;
}

void RunSuite(const std::vector<Preset>& presets, const fs::path& suite_folder, std::ostream& out) {
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  out << std::fixed << std::setprecision(0);
  for (const Preset& preset : presets) {
    const fs::path folder = suite_folder / preset.name;
    const double begin = elapsed();
    nlohmann::json summary = FindFinished(folder, preset.options);
    const bool is_cached = !summary.is_null();
    if (!is_cached) summary = MakeDrive(folder, preset.options);
    out << std::left << std::setw(12) << preset.name << std::right << std::setw(5)
        << summary["drive"]["length_m"].get<double>() << " m" << std::setw(6)
        << summary["drive"]["duration_s"].get<double>() << " s" << std::setw(8)
        << summary["counts"]["images"].get<int>() << " images  ";
    if (is_cached)
      out << "there already" << std::endl;
    else
      out << "made in " << elapsed() - begin << " s" << std::endl;
  }
  out << presets.size() << " drives in " << suite_folder.string() << ", " << elapsed() << " s"
      << std::endl;
}

}  // namespace parkade::simulator
