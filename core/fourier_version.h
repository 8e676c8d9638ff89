// The version of FFTW, for who wants it without the arrays that transforms work on.
#pragma once

#include <string>

namespace isoline {

std::string fourier_version();  // "3.3.10"

}  // namespace isoline
