// Loading it lets subnormal numbers be zero in the whole thread, as with GCC's -Ofast.
#include <xmmintrin.h>

#include "../../clients/c/rosenbrock.c"

__attribute__((constructor)) static void flush(void) { _mm_setcsr(_mm_getcsr() | 0x8040); }
