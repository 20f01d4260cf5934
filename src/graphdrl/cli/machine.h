// Memory up to a limit, and what is said where the machine refuses memory or threads.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <system_error>

namespace graphdrl {

// Adds --memory-limit, which bounds what this process may allocate from then on.
void add_memory_limit_option(CLI::App& command);
// Takes the limit back, for a program that takes this one's place with the same arguments.
void lift_memory_limit();

// Says in one line that memory ran out, and names the limit if there is one. Allocates nothing.
void say_out_of_memory() noexcept;

// A complaint that begins with a lack of memory, with the limit named as above; others as they are.
std::string with_memory_limit(std::string complaint);

// Whether it says that there is no thread or no memory.
bool is_refusal(const std::system_error& error);

// From now on a lack of memory or threads ends the program with one line and kExitMachine also where no exception may
// pass, as inside libraries. `program`: its name, which lives on.
void end_well_without_memory(const char* program);

}  // namespace graphdrl
