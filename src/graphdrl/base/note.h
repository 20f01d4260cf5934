// What a user should know though nothing failed: what was guessed, mended, left out.
#pragma once

#include <functional>
#include <string>

namespace graphdrl {

// Hears every note from now on, on the thread that has it to say; an empty one hears none, as at the start. Call it
// before threads begin.
void listen_to_notes(std::function<void(const std::string& note)> listener);

// Says one line.
void note(const std::string& text);

}  // namespace graphdrl
