// Bitmaps of Windows, version 3: a head, a table of colours, a byte a cell.
#include "reports/page/bitmap.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace isoline::reports {
namespace {

constexpr int kZero = 128, kMost = 127;  // the byte of 0, and steps to either side

struct Oklab {
  Real lightness, a, b;
};

std::uint8_t encoded(Real linear) {  // the transfer function of IEC 61966-2-1 (sRGB)
  const Real share = std::clamp(linear, 0.0, 1.0);
  const Real value = share <= 0.0031308 ? 12.92 * share : 1.055 * std::pow(share, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * value));
}

Colour srgb(const Oklab& colour) {
  const auto& [L, a, b] = colour;
  const Real l = std::pow(L + 0.3963377774 * a + 0.2158037573 * b, 3);
  const Real m = std::pow(L - 0.1055613458 * a - 0.0638541728 * b, 3);
  const Real s = std::pow(L - 0.0894841775 * a - 1.2914855480 * b, 3);
  return {encoded(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          encoded(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          encoded(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

// Little-endian, of so many bytes.
void add_number(std::string& out, std::uint32_t number, int bytes) {
  for (int i = 0; i < bytes; ++i) out += static_cast<char>(number >> (8 * i) & 0xffU);
}

Index filled(Index columns) { return (columns + 3) / 4 * 4; }

}  // namespace

Colour diverging_colour(Real share) {
  constexpr Real kLight = 0.97, kDark = 0.47, kChroma = 0.105;  // as far as sRGB has both hues
  constexpr Real kDegree = std::numbers::pi / 180, kBlue = 255 * kDegree, kOrange = 55 * kDegree;
  const Real t = std::min(std::abs(share), 1.0), hue = share < 0 ? kBlue : kOrange;
  return srgb(
      {kLight + (kDark - kLight) * t, kChroma * t * std::cos(hue), kChroma * t * std::sin(hue)});
}

std::string bytes_of(std::span<const float> values, Real scale) {
  std::string bytes;
  for (const float value : values) {
    const Real share = scale > 0 ? std::clamp(Real{value} / (2 * scale), -1.0, 1.0) : 0;
    bytes += static_cast<char>(kZero + std::lround(kMost * share));
  }
  return bytes;
}

std::string bitmap_head(Index rows, Index columns, FirstRow first) {
  constexpr std::uint32_t kHead = 14 + 40 + 4 * 256, kBegin = kHead + 2;  // a multiple of three
  static_assert(kBegin % 3 == 0);
  const auto cells = static_cast<std::uint32_t>(rows * filled(columns));
  std::string out = "BM";
  add_number(out, kBegin + cells, 4);
  add_number(out, 0, 4);
  add_number(out, kBegin, 4);
  add_number(out, 40, 4);  // of the part that begins here
  add_number(out, static_cast<std::uint32_t>(columns), 4);
  add_number(out, static_cast<std::uint32_t>(first == FirstRow::top ? -rows : rows), 4);
  add_number(out, 1, 2);
  add_number(out, 8, 2);  // bits a cell
  add_number(out, 0, 4);  // not compressed
  add_number(out, cells, 4);
  for (const std::uint32_t number : {2835U, 2835U, 256U, 0U}) add_number(out, number, 4);
  for (int byte = 0; byte < 256; ++byte) {
    const auto [red, green, blue] = diverging_colour(2.0 * (byte - kZero) / kMost);
    for (const std::uint8_t part : {blue, green, red, std::uint8_t{0}}) add_number(out, part, 1);
  }
  out.resize(kBegin, '\0');
  return radix64(out);
}

std::string bitmap_cells(std::string_view bytes, Index columns) {
  std::string out;
  const auto row = static_cast<std::size_t>(columns),
             whole = static_cast<std::size_t>(filled(columns));
  for (std::size_t begin = 0; begin < bytes.size(); begin += row) {
    out += bytes.substr(begin, row);
    out.append(whole - row, static_cast<char>(kZero));
  }
  return radix64(out);
}

std::string radix64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t j = i; j < i + 3; ++j)
      group = group << 8 | (j < bytes.size() ? static_cast<unsigned char>(bytes[j]) : 0U);
    for (std::size_t j = 0; j < 4; ++j)
      text += i + j > bytes.size() ? '=' : kDigits[group >> (18 - 6 * j) & 63U];
  }
  return text;
}

}  // namespace isoline::reports
