// Bitmaps of Windows, version 3: a head, a table of colours, a byte a cell.
#include "reports/page/fields_html.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reports/formats/escape.h"
#include "reports/page/chart_data.h"
#include "reports/page/kinds.h"
#include "reports/page/page.h"
#include "reports/sections/words.h"

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

// The fields of a problem on a grid: y*, x*, and for one method of each kind x and what is missing,
// as pictures that stand without scripts; and as data, from which a reader chooses the step.

namespace {

// "source ∇²y, 1/cell²"
std::string named(const Quantity& quantity) {
  return quantity.unit.empty() ? quantity.name : quantity.name + ", " + quantity.unit;
}

// Of x, and where it is a history of all that follows from it.
std::string named(const FoundFields& all) {
  return all.is_history() ? all.x.name + " → " + named(all.y) : named(all.x);
}

// What the pictures show.
struct Labels {
  std::string x, truth, rest;
};
Labels labels_of(const FoundFields& all) {
  return all.is_history() ? Labels{"x → y", "x* → y*", "x − x* → y − y*"}
                          : Labels{"x", "x*", "x − x*"};
}

std::string head_of(const FoundFields& all) {
  const FieldFrames& frames = all.frames();
  return bitmap_head(frames.shape[1], frames.shape[2],
                     all.is_history() ? FirstRow::bottom : FirstRow::top);
}

std::string short_figure(Real value) { return figure(std::stod(fmt::format("{:.3g}", value))); }

std::string picture(const FoundFields& all, const std::string& cells, const std::string& label,
                    const std::string& alt) {
  const FieldFrames& frames = all.frames();
  return fmt::format(
      "<div class=\"picture{}\"><img src=\"data:image/bmp;base64,{}{}\" width={} height={} "
      "alt=\"{}\"><span>{}</span></div>",
      all.is_history() ? " history" : "", head_of(all), cells, frames.shape[2], frames.shape[1],
      html_text(alt), label);
}

std::string cells_of(const FoundFields& all, std::span<const float> values, Real scale) {
  return bitmap_cells(bytes_of(values, scale), all.frames().shape[2]);
}

std::vector<float> difference(std::span<const float> a, std::span<const float> b) {
  std::vector<float> out(a.begin(), a.end());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] -= b[i];
  return out;
}

std::string range_of(std::span<const float> values) {
  const auto [low, high] = std::ranges::minmax(values);
  return fmt::format("from {} to {}", short_figure(low), short_figure(high));
}

// "= 0.66": what ‖x − x*‖ is, in ‖x*‖. Below the last digits of single precision nothing is said.
std::string apart_text(const FoundField& found, std::size_t i) {
  constexpr Real kResolved = 1e-7;
  if (found.apart.empty()) return "";
  return found.apart[i] < kResolved ? "< 1e-7" : "= " + short_figure(found.apart[i]);
}

std::string given_html(const FoundFields& all) {
  const FieldFrames& frames = all.frames();
  const std::string truth = labels_of(all).truth;
  std::string pictures =
      picture(all, cells_of(all, frames.target(), all.y_scale), "y*",
              fmt::format("y*: {}, {}", named(all.y), range_of(frames.target())));
  if (frames.has_truth())
    pictures += picture(all, cells_of(all, frames.truth(), all.x_scale), truth,
                        fmt::format("{}: {}, {}", truth, named(all), range_of(frames.truth())));
  return fmt::format(
      "<figure class=given><div class=two>{}</div><figcaption><b>What is given{}.</b> {}{}; its colours "
      "end at ±{}.</figcaption></figure>",
      pictures, frames.has_truth() ? ", and what is sought" : "",
      html_text("y* is the " + named(all.y)), all.is_history() ? ", the highest row alone" : "",
      short_figure(all.y_scale));
}

std::string found_html(const Comparison& c, const FoundFields& all, const FoundField& found) {
  const std::size_t last = found.frames.iterations.size() - 1;
  const std::string name = shown_spec(c.optimizers[found.optimizer].brief);
  const std::span<const float> x = found.frames.x(last);
  const Labels labels = labels_of(all);
  std::string pictures =
      picture(all, cells_of(all, x, all.x_scale), labels.x,
              fmt::format("{} of {}: {}, {}", labels.x, name, named(all), range_of(x)));
  std::string apart;
  if (!found.apart.empty()) {
    const std::vector<float> rest = difference(x, found.frames.truth());
    pictures += picture(all, cells_of(all, rest, all.x_scale), labels.rest,
                        fmt::format("{} of {}, {}", labels.rest, name, range_of(rest)));
    apart = fmt::format(", <span class=norm>‖x − x*‖ <output class=apart>{}</output> ‖x*‖</span>",
                        html_text(apart_text(found, last)));
  }
  return fmt::format(
      "<figure data-s={}><div class=two>{}</div><figcaption>{}<b>{}</b>{} {}: iteration <output "
      "class=at>{}</output>{}</figcaption></figure>",
      found.optimizer, pictures, swatch(), html_text(name),
      marks_html(c.optimizers[found.optimizer]),
      html_text(kind_title(c.optimizers[found.optimizer].mathematics())),
      found.frames.iterations[last], apart);
}

// The colours from −scale to scale, in a row.
std::string key_html(const FoundFields& all) {
  constexpr Index kColours = 129;  // bytes 64 to 192: half of them, as far as colours go
  std::string bytes;
  for (Index i = 0; i < kColours; ++i) bytes += static_cast<char>(64 + i);
  return fmt::format(
      "<p class=field-key><span>−{0}</span><img src=\"data:image/bmp;base64,{1}{2}\" width={3} "
      "height=1 alt=\"from blue over white, which is 0, to orange\"><span>{0}</span> {4}. {5} have "
      "this one scale; what lies beyond has the colour of its end.{6}</p>",
      short_figure(all.x_scale), bitmap_head(1, kColours), bitmap_cells(bytes, kColours), kColours,
      html_text(named(all)), all.is_history() ? "All pictures" : "x, x* and x − x*",
      all.is_history()
          ? fmt::format(" Across is the place and upward the time: the lowest row is x, "
                        "at 0, the highest y, at {}.",
                        short_figure(all.time))
          : "");
}

std::string reading_of(const Comparison& c, const FoundFields& all) {
  const std::string sample =
      all.is_learned ? fmt::format("the first sample of the validation, seed {}", all.seed)
                     : fmt::format("seed {}", all.seed);
  std::string text = fmt::format("The best method of each kind, on {}.", sample);
  if (!all.frames().has_truth()) return text;
  const auto end = [](const FoundField& found) { return found.apart.back(); };
  const auto [least, most] = std::ranges::minmax_element(all.found, {}, end);
  const auto words = [&](const auto& at) {
    return fmt::format("{}, ‖x − x*‖ {} ‖x*‖", shown_spec(c.optimizers[at->optimizer].brief),
                       apart_text(*at, at->apart.size() - 1));
  };
  text += fmt::format(" In the end the x nearest to x* is that of {}", words(least));
  if (least != most) text += fmt::format("; the farthest is that of {}", words(most));
  return text + ".";
}

}  // namespace

std::string fields_html(const Comparison& c, const FoundFields& all) {
  std::string figures = given_html(all);
  for (const FoundField& found : all.found) figures += found_html(c, all, found);
  return fmt::format(
      "<div class=fields><h4>Fields</h4><p class=reading>{}</p><div class=steps></div>{}<div "
      "class=field-cards>{}</div></div>",
      html_text(reading_of(c, all)), key_html(all), figures);
}

std::string fields_json(const FoundFields& all) {
  const auto one = [&](const FoundField& found) {
    std::vector<std::size_t> frames;
    for (std::size_t i = 0; i < found.frames.iterations.size(); ++i) frames.push_back(i);
    const auto cells = [&](std::size_t i) {
      return '"' + cells_of(all, found.frames.x(i), all.x_scale) + '"';
    };
    return fmt::format(
        "{{\"s\":{},\"iterations\":{},\"apart\":{},\"x\":{}}}", found.optimizer,
        list(frames, [&](std::size_t i) { return std::to_string(found.frames.iterations[i]); }),
        list(frames, [&](std::size_t i) { return json_quoted(apart_text(found, i)); }),
        list(frames, cells));
  };
  const FieldFrames& frames = all.frames();
  const Labels labels = labels_of(all);
  return fmt::format("{{\"head\":\"{}\",\"labels\":[{},{}],\"truth\":\"{}\",\"found\":{}}}",
                     head_of(all), json_quoted(labels.x), json_quoted(labels.rest),
                     frames.has_truth() ? cells_of(all, frames.truth(), all.x_scale) : "",
                     list(all.found, one));
}

}  // namespace isoline::reports
