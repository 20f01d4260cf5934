// graphdrl-mpi: the commands of `graphdrl` that share their work over the processes of one mpirun.
#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "graphdrl/cli/commands.h"
#include "graphdrl/cli/program.h"
#include "graphdrl/io/checksum.h"
#include "graphdrl/io/file.h"
#include "graphdrl/mpi/mpi_ranks.h"

namespace graphdrl {
namespace {

// The first rank speaks for all.
void be_silent() {
  const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nothing < 0) return;
  dup2(nothing, STDOUT_FILENO);
  dup2(nothing, STDERR_FILENO);
}

// Says the first complaint that the first rank has not made itself; gives the gravest status.
int status_of_all(const std::vector<MpiRanks::Outcome>& outcomes) {
  int gravest = kExitDone;
  for (const MpiRanks::Outcome& outcome : outcomes) gravest = std::max(gravest, outcome.status);
  if (!outcomes.front().complaint.empty()) return gravest;
  for (std::size_t rank = 1; rank < outcomes.size(); ++rank) {
    if (outcomes[rank].complaint.empty()) continue;
    print_diagnostic(fmt::format("rank {}: {}", rank, outcomes[rank].complaint));
    break;
  }
  return gravest;
}

int run_on_ranks(int argc, char** argv) {
  MpiRanks ranks(argc, argv);
  if (!ranks.is_first()) be_silent();
  CLI::App app{"The commands of GraphDRL that share their work over the processes of one mpirun.", "graphdrl-mpi"};
  app.set_version_flag("--version", GRAPHDRL_VERSION);
  app.require_subcommand(1);
  add_train_command(app, kCpuLearners, ranks);
  add_tune_command(app, kCpuLearners, ranks);
  add_evaluate_command(app, ranks);
  add_plan_command(app, ranks);
  name_program(app.get_name());
  int status = attempt([&] {
    ranks.require_same("program", checksum({read_file("/proc/self/exe")}));
    ranks.require_same("options", fmt::format("{}", fmt::join(argv + 1, argv + argc, "\n")));
  });
  if (status == kExitDone) status = run_program(app, argc, argv);
  const auto outcomes = ranks.settle({.status = status, .complaint = last_complaint()});
  return ranks.is_first() ? status_of_all(outcomes) : kExitDone;
}

}  // namespace
}  // namespace graphdrl

// NOLINTNEXTLINE(bugprone-exception-escape): before the arguments are read only MPI and memory can fail
int main(int argc, char** argv) {
  return graphdrl::run_on_ranks(argc, argv);
}
