// Whether a file can be written, asked before long work.
#pragma once

#include <filesystem>

namespace graphdrl {

// Throws what write_file() would throw, as far as that is known beforehand: Error where the folder is missing or closed
// to the user, where something else than a file stands there or the name is none; MachineError where the disk takes no
// more. Writes nothing, and leaves what is there as it is.
void check_writable(const std::filesystem::path& path);

}  // namespace graphdrl
