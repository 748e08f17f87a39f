// What a fake Slurm runs: the node's side of an attempt.

#include <cstdio>
#include <exception>

#include "server/jobs/slurm/run_on_node.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    return parkade::RunOnNode(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
