// Reads a formula: atoms, accents, scripts, fences, roots, functions and prose.
#include <fmt/format.h>

#include "reports/html/mathml_letters.h"
#include "reports/html/mathml_pieces.h"
#include "reports/text.h"

namespace isoline::reports {
namespace {

using Kind = Piece::Kind;

std::string shown(char32_t letter) { return html_text(utf8_of({&letter, 1})); }

bool is_digit(char32_t letter) { return letter >= U'0' && letter <= U'9'; }

class Parser {
 public:
  explicit Parser(std::string_view formula) : letters_(letters_of(formula)) {}

  Pieces sequence(char32_t end) {
    Pieces pieces;
    while (at_ < letters_.size()) {
      int blanks = 0;
      for (; at_ < letters_.size() && letters_[at_] == U' '; ++at_) ++blanks;
      if (at_ == letters_.size() || (end != 0 && letters_[at_] == end)) break;
      pieces.push_back(piece());
      pieces.back().blanks = blanks;
    }
    return with_words(std::move(pieces));
  }

 private:
  char32_t peek() const { return at_ < letters_.size() ? letters_[at_] : 0; }

  Piece piece() {
    Piece atom = this->atom();
    if (atom.kind != Kind::operand) return atom;
    for (char32_t mark = accent(peek()); mark != 0; mark = accent(peek())) {
      ++at_;
      atom.ml = fmt::format("<mover accent=true>{}<mo stretchy=false>{}</mo></mover>", atom.ml,
                            shown(mark));
      atom.inner.clear();
    }
    return scripted(std::move(atom));
  }

  Piece atom() {
    const char32_t letter = peek();
    if (is_word_letter(letter)) return word();
    if (is_digit(letter)) return {.ml = tagged("mn", number()), .inner = ""};
    if (closing(letter) != 0) return group();
    ++at_;
    if (letter == U'√') return root();
    if (letter == U'½') return {.ml = "<mfrac><mn>1</mn><mn>2</mn></mfrac>", .inner = ""};
    if (is_identifier(letter)) return {.ml = tagged("mi", shown(letter)), .inner = ""};
    if (letter == U'/') return {.kind = Kind::slash, .ml = "<mo>/</mo>", .inner = ""};
    const bool is_comma = letter == U',' || letter == U';';
    return {.kind = is_comma ? Kind::comma : Kind::sign,
            .ml = tagged("mo", shown(letter)),
            .inner = ""};
  }

  std::string number() {
    std::u32string digits;
    while (is_digit(peek()) ||
           (peek() == U'.' && at_ + 1 < letters_.size() && is_digit(letters_[at_ + 1])))
      digits += letters_[at_++];
    return utf8_of(digits);
  }

  // One letter is an identifier; more of them are a function's name or prose.
  Piece word() {
    std::u32string letters;
    const auto goes_on = [this] {
      const bool is_hyphen =
          peek() == U'-' && at_ + 1 < letters_.size() && is_word_letter(letters_[at_ + 1]);
      return is_word_letter(peek()) || is_hyphen;
    };
    while (goes_on()) letters += letters_[at_++];
    const std::string text = html_text(utf8_of(letters));
    if (letters.size() == 1) return {.ml = tagged("mi", text), .inner = ""};
    if (is_function(letters)) return {.ml = tagged("mi", text), .inner = "", .is_function = true};
    return {.kind = Kind::word, .ml = text, .inner = ""};
  }

  Piece group() {
    const char32_t opening = letters_[at_++], end = closing(opening);
    const std::string content = set_row(sequence(end));
    if (peek() != end)  // never closed: it stands as it is
      return {.kind = Kind::sign, .ml = tagged("mo", shown(opening)) + content, .inner = ""};
    ++at_;
    const bool is_tall = content.find("<mfrac") != std::string::npos;
    const auto fence = [is_tall](char32_t letter, const char* form) {
      return fmt::format("<mo form={} stretchy={}>{}</mo>", form, is_tall, shown(letter));
    };
    return {.ml = tagged("mrow", fence(opening, "prefix") + content + fence(end, "postfix")),
            .inner = opening == U'(' ? tagged("mrow", content) : ""};
  }

  Piece root() {
    const Piece under = piece();
    return {.ml = tagged("msqrt", under.inner.empty() ? under.ml : under.inner), .inner = ""};
  }

  // ² and ⁻¹, ^ before a group or an atom, * and ' at once behind; ₁ and _ likewise.
  Piece scripted(Piece body) {
    const std::string below = script(lowered, U'_');
    const std::string above = script(raised, U'^');
    if (below.empty() && above.empty()) return body;
    const char* tag = below.empty() ? "msup" : above.empty() ? "msub" : "msubsup";
    body.ml = tagged(tag, body.ml + below + above);
    body.inner.clear();
    return body;
  }

  std::string script(char32_t (*plain)(char32_t), char32_t mark) {
    std::string content;
    for (char32_t letter = plain(peek()); letter != 0; letter = plain(peek())) {
      ++at_;
      const char* tag = is_digit(letter) ? "mn" : is_word_letter(letter) ? "mi" : "mo";
      content += tagged(tag, shown(letter));
    }
    const bool takes_marks = mark == U'^';
    while (takes_marks && (peek() == U'*' || peek() == U'\''))
      content += tagged("mo", letters_[at_++] == U'*' ? "*" : "′");
    if (peek() == mark && at_ + 1 < letters_.size()) {
      ++at_;
      const Piece named = atom();
      content += named.inner.empty() ? named.ml : named.inner;
    }
    return content.empty() ? "" : tagged("mrow", content);
  }

  // "a" and commas between words are prose, and so is "min of …".
  static Pieces with_words(Pieces pieces) {
    const auto is_word = [&](std::size_t i) {
      return i < pieces.size() && pieces[i].kind == Kind::word;
    };
    for (std::size_t i = pieces.size(); i-- > 0;) {
      const bool follows = i > 0 && is_word(i - 1) && pieces[i].blanks > 0;
      const bool leads = is_word(i + 1) && pieces[i + 1].blanks > 0;
      if (pieces[i].ml == "<mi>a</mi>" && (follows || leads))
        pieces[i] = {Kind::word, "a", "", pieces[i].blanks, false};
      else if (pieces[i].is_function && leads)
        pieces[i] = {Kind::word, pieces[i].ml.substr(4, pieces[i].ml.size() - 9), "",
                     pieces[i].blanks, false};
      else if (pieces[i].kind == Kind::comma && i > 0 && is_word(i - 1) && is_word(i + 1))
        pieces[i].kind = Kind::word, pieces[i].ml = ",";
    }
    return pieces;
  }

  std::u32string letters_;
  std::size_t at_ = 0;
};

}  // namespace

Pieces pieces_of(std::string_view formula) { return Parser(formula).sequence(0); }

}  // namespace isoline::reports
