// The letters of formulas: UTF-8 in and out, and what each letter stands for in a formula.
#pragma once

#include <string>
#include <string_view>

namespace isoline::reports {

std::u32string letters_of(std::string_view utf8);  // ŷ is y and its accent, two letters
std::string utf8_of(std::u32string_view letters);

// The plain letter of a superscript or subscript: '2' of '²', 'i' of 'ᵢ'; 0 where it is none.
char32_t raised(char32_t letter);
char32_t lowered(char32_t letter);

// The mark that a combining letter sets above the one before it: "~" of U+0303; 0 where it is none.
char32_t accent(char32_t letter);

char32_t closing(char32_t opening);  // ')' of '('; the same letter for ‖ and |; 0: it opens nothing
bool is_word_letter(char32_t letter);
bool is_identifier(char32_t letter);  // a letter of any alphabet, ∇ and ∂ among them
bool is_function(std::u32string_view word);

}  // namespace isoline::reports
