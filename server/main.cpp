#include <opencv2/core/utility.hpp>
#include <string_view>

#include "core/parallel.h"
#include "core/tune_malloc.h"
#include "server/commands/command_line.h"

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "map") parkade::UseHugePages(argv);
  cv::setNumThreads(1);  // the only threads are ours: core/parallel works on many images at once
  parkade::KeepLinearAlgebraToCaller();
  return parkade::RunCommandLine(argc, argv);
}
