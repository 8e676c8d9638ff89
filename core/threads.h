// How many threads the libraries use. OpenBLAS starts its own before main() when merely linked, so
// the program sets the environment and starts itself again, once, before anything else.
#pragma once

namespace isoline {

// Returns at once where the environment already asks for one thread; else replaces this process.
void start_single_threaded(char** arguments);

// Raises the libraries' threads in a worker, from the request.
void set_library_threads(int threads);

}  // namespace isoline
