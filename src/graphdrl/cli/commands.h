// The subcommands of `graphdrl`, one per source file beside this one.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>

namespace graphdrl {

void add_bench_command(CLI::App& app);
void add_evaluate_command(CLI::App& app);
void add_inspect_command(CLI::App& app);
void add_maps_command(CLI::App& app);
void add_plan_command(CLI::App& app);
void add_train_command(CLI::App& app);

// Where graphdrl-train stands, installed or not: beside this program.
std::filesystem::path trainer_program();

}  // namespace graphdrl
