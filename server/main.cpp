#include <opencv2/core/utility.hpp>

#include "core/parallel.h"
#include "server/commands/command_line.h"

int main(int argc, char** argv) {
  cv::setNumThreads(1);  // the only threads are ours: core/parallel works on many images at once
  parkade::KeepLinearAlgebraToCaller();
  return parkade::RunCommandLine(argc, argv);
}
