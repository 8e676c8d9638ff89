// The command line of Isoline.
#include "benchmarks/cli/program.h"

int main(int count, char** arguments) {
  return isoline::main(count, arguments, isoline::benchmarks::builtin_catalog);
}
