// What is fuzzed: everything that reads bytes from outside. Each function takes any bytes; it may refuse them with an exception of a type
// that the program turns into one line, and nothing else may happen: no crash, no hang, no memory beyond the input's size times a constant.
#pragma once

#include <cstdint>
#include <span>

namespace fuzz {

using Bytes = std::span<const std::uint8_t>;

void mesh(Bytes bytes);   // the mesh reader's front: format by content, VTK's two formats (ours; assimp runs in a child process of its own)
void scene(Bytes bytes);  // scene files; the first line, if it starts with "#set ", is a --set
void wave(Bytes bytes);   // wave tables
void run(Bytes bytes);    // run files

}  // namespace fuzz
