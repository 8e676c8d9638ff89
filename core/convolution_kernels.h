// The kernels of oneDNN that this build's convolutions get; core/convolution.cpp has them.
#pragma once

#include <string>

namespace isoline {

// The instructions that oneDNN uses, as ONEDNN_MAX_CPU_ISA names them: "AVX512_CORE".
std::string convolution_instructions();

// Whether oneDNN has fast kernels for this build's blocks of channels within this limit, which may
// be empty.
bool has_fast_convolutions(const std::string& limit);

}  // namespace isoline
