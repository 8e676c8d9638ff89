// Where what outsiders use from their own language lies beside this program.
#pragma once

#include <filesystem>
#include <string>

namespace isoline {

// The folder of a language's client, as "python": of the prefix that the program is installed in,
// else of the tree that it was built in, else of the prefix that it was configured for.
std::filesystem::path client_folder(const std::string& language);

}  // namespace isoline
