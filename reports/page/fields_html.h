// Fields in the page.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/real.h"
#include "reports/read/found_fields.h"

namespace isoline::reports {

using Colour = std::array<std::uint8_t, 3>;  // red, green, blue

// Of a share in [−1, 1]: blue below, orange above, and nearly white at 0. Both arms are straight
// lines of equal steps in Oklab (Ottosson 2020, "A perceptual color space for image processing"),
// to one lightness and chroma, in hues that stay apart in all three dichromacies.
Colour diverging_colour(Real share);

// Bytes 1 to 255, of which 128 is 0 and 255 twice `scale`: colours end at ±scale, and what a
// difference of two may need is not lost before. Beyond twice the scale a value is cut.
std::string bytes_of(std::span<const float> values, Real scale);

// The bitmap's head: sizes and the 256 colours. Of as many bytes as end with a digit in base 64, so
// that the picture's address is the one text behind the other.
enum class FirstRow { top, bottom };
std::string bitmap_head(Index rows, Index columns, FirstRow first = FirstRow::top);  // in base 64
// Its cells, row by row from the first, each row filled up to four bytes.
std::string bitmap_cells(std::string_view bytes, Index columns);  // in base 64

std::string radix64(std::string_view bytes);  // RFC 4648, section 4

// Fields in the page.

std::string fields_html(const Comparison& comparison, const FoundFields& all);
std::string fields_json(const FoundFields& all);

}  // namespace isoline::reports
