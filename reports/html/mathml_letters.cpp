// Tables of letters.
#include "reports/html/mathml_letters.h"

#include <algorithm>
#include <array>
#include <utility>

namespace isoline::reports {
namespace {

using Pair = std::pair<char32_t, char32_t>;

constexpr std::array<Pair, 21> kRaised = {
    {{U'⁰', U'0'}, {U'¹', U'1'}, {U'²', U'2'}, {U'³', U'3'}, {U'⁴', U'4'}, {U'⁵', U'5'},
     {U'⁶', U'6'}, {U'⁷', U'7'}, {U'⁸', U'8'}, {U'⁹', U'9'}, {U'⁺', U'+'}, {U'⁻', U'−'},
     {U'ᵀ', U'T'}, {U'ᵖ', U'p'}, {U'ⁱ', U'i'}, {U'ⁿ', U'n'}, {U'ᵏ', U'k'}, {U'ʲ', U'j'},
     {U'ᵗ', U't'}, {U'ᵈ', U'd'}, {U'ᴴ', U'H'}}};
constexpr std::array<Pair, 27> kLowered = {
    {{U'₀', U'0'}, {U'₁', U'1'}, {U'₂', U'2'}, {U'₃', U'3'}, {U'₄', U'4'}, {U'₅', U'5'},
     {U'₆', U'6'}, {U'₇', U'7'}, {U'₈', U'8'}, {U'₉', U'9'}, {U'₊', U'+'}, {U'₋', U'−'},
     {U'ᵢ', U'i'}, {U'ⱼ', U'j'}, {U'ₖ', U'k'}, {U'ₘ', U'm'}, {U'ₙ', U'n'}, {U'ₚ', U'p'},
     {U'ₐ', U'a'}, {U'ₑ', U'e'}, {U'ₗ', U'l'}, {U'ₒ', U'o'}, {U'ᵣ', U'r'}, {U'ₛ', U's'},
     {U'ₜ', U't'}, {U'ᵤ', U'u'}, {U'ₓ', U'x'}}};
constexpr std::array<Pair, 5> kAccents = {
    {{0x302, U'^'}, {0x303, U'~'}, {0x304, U'¯'}, {0x305, U'¯'}, {0x307, U'˙'}}};
struct Composed {
  char32_t letter, plain, mark;
};
constexpr Composed kComposed[] = {{U'ŷ', U'y', 0x302}, {U'ŵ', U'w', 0x302}, {U'û', U'u', 0x302},
                                  {U'ā', U'a', 0x304}, {U'ē', U'e', 0x304}, {U'ū', U'u', 0x304},
                                  {U'ũ', U'u', 0x303}, {U'ñ', U'n', 0x303}, {U'ã', U'a', 0x303}};
constexpr std::array<Pair, 6> kFences = {
    {{U'(', U')'}, {U'[', U']'}, {U'{', U'}'}, {U'⟨', U'⟩'}, {U'‖', U'‖'}, {U'|', U'|'}}};
constexpr std::array<std::u32string_view, 12> kFunctions = {U"sin",    U"cos",  U"tan",  U"exp",
                                                            U"log",    U"ln",   U"min",  U"max",
                                                            U"argmin", U"diag", U"sign", U"tr"};

template <std::size_t N>
char32_t partner(const std::array<Pair, N>& pairs, char32_t letter) {
  const auto at = std::ranges::find(pairs, letter, &Pair::first);
  return at == pairs.end() ? 0 : at->second;
}

}  // namespace

std::u32string letters_of(std::string_view utf8) {
  std::u32string letters;
  for (std::size_t i = 0; i < utf8.size();) {
    const auto lead = static_cast<unsigned char>(utf8[i]);
    const std::size_t length = lead < 0xC0 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
    char32_t letter = length == 1 ? lead : lead & (0xFFU >> (length + 1));
    for (std::size_t k = 1; k < length && i + k < utf8.size(); ++k)
      letter = (letter << 6U) | (static_cast<unsigned char>(utf8[i + k]) & 0x3FU);
    const auto split = std::ranges::find(kComposed, letter, &Composed::letter);
    letters += split == std::end(kComposed) ? letter : split->plain;
    if (split != std::end(kComposed)) letters += split->mark;
    i += length;
  }
  return letters;
}

std::string utf8_of(std::u32string_view letters) {
  std::string text;
  const auto put = [&text](char32_t byte) { text += static_cast<char>(byte); };
  const auto tail = [](char32_t letter, unsigned shift) {
    return 0x80U | ((letter >> shift) & 0x3FU);
  };
  for (const char32_t letter : letters) {
    if (letter < 0x80) {
      put(letter);
      continue;
    }
    if (letter < 0x800) put(0xC0U | (letter >> 6U));
    if (letter >= 0x800 && letter < 0x10000) put(0xE0U | (letter >> 12U));
    if (letter >= 0x10000) {
      put(0xF0U | (letter >> 18U));
      put(tail(letter, 12));
    }
    if (letter >= 0x800) put(tail(letter, 6));
    put(tail(letter, 0));
  }
  return text;
}

char32_t raised(char32_t letter) { return partner(kRaised, letter); }
char32_t lowered(char32_t letter) { return partner(kLowered, letter); }
char32_t accent(char32_t letter) { return partner(kAccents, letter); }
char32_t closing(char32_t opening) { return partner(kFences, opening); }

bool is_word_letter(char32_t letter) {
  return (letter >= U'a' && letter <= U'z') || (letter >= U'A' && letter <= U'Z');
}

bool is_identifier(char32_t letter) {
  const bool is_latin = is_word_letter(letter) || (letter >= 0xC0 && letter <= 0x24F);
  const bool is_greek = letter >= 0x370 && letter <= 0x3FF && letter != U'Σ';
  const bool is_letterlike = (letter >= 0x2100 && letter <= 0x214F) || letter == U'ϕ';
  return (is_latin && letter != U'×') || is_greek || is_letterlike || letter == U'∇' ||
         letter == U'∂' || letter == U'∞';
}

bool is_function(std::u32string_view word) { return std::ranges::count(kFunctions, word) > 0; }

}  // namespace isoline::reports
