// Fields as bitmaps: colours that are even, bytes that say what cells hold.
#include <gtest/gtest.h>

#include <cmath>

#include "reports/page/fields_html.h"

namespace isoline::reports {
namespace {

TEST(Radix64, IsThatOfTheStandard) {  // the test vectors of RFC 4648, section 10
  EXPECT_EQ(radix64(""), "");
  EXPECT_EQ(radix64("f"), "Zg==");
  EXPECT_EQ(radix64("fo"), "Zm8=");
  EXPECT_EQ(radix64("foo"), "Zm9v");
  EXPECT_EQ(radix64("foob"), "Zm9vYg==");
  EXPECT_EQ(radix64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(radix64("foobar"), "Zm9vYmFy");
}

Real lightness(const Colour& colour) {  // L* of CIE Lab, from the luminance of sRGB
  Real luminance = 0;
  const Real weights[] = {0.2126, 0.7152, 0.0722};
  for (std::size_t i = 0; i < 3; ++i) {
    const Real share = colour[i] / 255.0;
    luminance +=
        weights[i] * (share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4));
  }
  return 116 * std::cbrt(luminance) - 16;
}

TEST(DivergingColours, DarkenEvenlyAndAlikeToBothSides) {
  constexpr int kSteps = 16;
  const Real light = lightness(diverging_colour(0)), dark = lightness(diverging_colour(1));
  EXPECT_GT(light, 95);
  EXPECT_LT(dark, 45);
  for (int i = 1; i <= kSteps; ++i) {
    const Real t = static_cast<Real>(i) / kSteps;
    const Real even = light + (dark - light) * t;
    for (const Real share : {-t, t})  // Oklab's lightness and CIE's bend a little otherwise
      EXPECT_NEAR(lightness(diverging_colour(share)), even, 3.5) << share;
  }
}

TEST(DivergingColours, EndAtTheScale) {
  EXPECT_EQ(diverging_colour(1.7), diverging_colour(1));
  EXPECT_EQ(diverging_colour(-9), diverging_colour(-1));
  EXPECT_LT(diverging_colour(1)[2], diverging_colour(-1)[2]) << "orange above, blue below";
}

TEST(Cells, AreBytesAroundZeroUpToTwiceTheScale) {
  const std::vector<float> values = {0, 1, -1, 2, -2, 9, -9, 0.5F};
  const std::string bytes = bytes_of(values, 1);
  std::vector<int> found;
  for (const char byte : bytes) found.push_back(static_cast<unsigned char>(byte));
  EXPECT_EQ(found, (std::vector<int>{128, 192, 64, 255, 1, 255, 1, 160}));
  EXPECT_EQ(bytes_of({}, 1), "");
  EXPECT_EQ(static_cast<unsigned char>(bytes_of(values, 0)[1]), 128) << "all is zero";
}

TEST(Bitmap, HasAHeadOfWholeDigitsAndRowsOfFourBytes) {
  const std::string head = bitmap_head(3, 5);
  EXPECT_EQ(head.size() % 4, 0U);
  EXPECT_EQ(head.find('='), std::string::npos);
  EXPECT_TRUE(head.starts_with("Qk")) << "BM";
  EXPECT_EQ(bitmap_cells(std::string(15, '\x80'), 5).size(), 32U) << "3 rows of 8 bytes";
}

}  // namespace
}  // namespace isoline::reports
