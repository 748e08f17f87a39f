#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "core/error.h"
#include "core/trajectory.h"
#include "mapping/evaluate_surface.h"
#include "mapping/read_ply.h"
#include "server/commands/commands.h"
#include "slam/evaluate_trajectory.h"

namespace parkade {
namespace {

struct EvaluateArguments {
  std::string truth, estimate;  ///< TUM files
  std::string ground, surface;  ///< PLY meshes
  bool is_json = false;
};

int Evaluate(const EvaluateArguments& arguments) {
  const bool has_trajectories = !arguments.truth.empty() && !arguments.estimate.empty();
  const bool has_surfaces = !arguments.ground.empty() && !arguments.surface.empty();
  Require(has_trajectories || has_surfaces, ErrorCode::kUsage,
          "evaluate needs --truth with --estimate, or --ground with --surface");

  nlohmann::json json = nlohmann::json::object();
  std::string text;
  Rigid3 truth_from_estimate;
  if (has_trajectories) {
    const TrajectoryEvaluation evaluation = EvaluateTrajectory(ReadTum(arguments.truth), ReadTum(arguments.estimate));
    json["trajectory"] = ToJson(evaluation);
    text += ToText(evaluation);
    truth_from_estimate = evaluation.rigid.truth_from_estimate;
  }
  if (has_surfaces) {
    const TriangleMesh surface = Transformed(ReadPly(arguments.surface), truth_from_estimate);
    const SurfaceEvaluation evaluation = EvaluateSurface(ReadPly(arguments.ground), surface);
    json["surface"] = ToJson(evaluation);
    text += ToText(evaluation);
  }
  std::printf("%s\n", arguments.is_json ? json.dump(2).c_str() : text.c_str());
  return 0;
}

}  // namespace

void AddEvaluateCommand(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command =
      app.add_subcommand("evaluate",
                         "Compare a trajectory or a surface with the truth; given both, the surface is moved "
                         "by the alignment of the trajectories first");
  command->add_option("--truth", arguments->truth, "true trajectory (TUM)");
  command->add_option("--estimate", arguments->estimate, "estimated trajectory (TUM), poses of the same frame");
  command->add_option("--ground", arguments->ground, "true ground surface (PLY mesh, z up)");
  command->add_option("--surface", arguments->surface, "estimated surface (PLY mesh, z up)");
  command->add_flag("--json", arguments->is_json, "print JSON");
  command->callback([arguments, &action] { action = [arguments] { return Evaluate(*arguments); }; });
}

}  // namespace parkade
