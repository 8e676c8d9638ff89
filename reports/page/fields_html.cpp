// Fields of a problem on a grid: y*, x*, and x and x − x* of one method of each kind, with one byte
// per cell. The scripts paint them, and the reader selects the step.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ranges>

#include "core/seeds.h"
#include "reports/formats/formats.h"
#include "reports/page/page.h"
#include "reports/sections/words.h"

namespace isoline::reports {

std::string field_bytes(const std::vector<float>& values, Real scale) {
  constexpr int kZero = 128, kMost = 127;  // the byte of 0, and steps to either side
  std::string bytes;
  for (const float value : values) {
    const Real share = scale > 0 ? std::clamp(Real{value} / (2 * scale), -1.0, 1.0) : 0;
    bytes += static_cast<char>(kZero + std::lround(kMost * share));
  }
  return bytes;
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

// The bytes as letters from U+0001 to U+00FF: compressed, they are shorter than radix 64.
std::string letters_of(std::string_view bytes) {
  constexpr unsigned kAscii = 0x80, kLead = 0xC0, kRest = 0x3F, kBits = 6;  // of UTF-8
  std::string text;
  for (const unsigned char byte : bytes) {
    if (byte >= kAscii) text += static_cast<char>(kLead | byte >> kBits);
    text += static_cast<char>(byte < kAscii ? byte : kAscii | (byte & kRest));
  }
  return text;
}

std::string canvas_html(std::string_view bytes, Index rows, Index columns, std::string_view ramp,
                        std::string_view words) {
  const std::string cells = bytes.empty() ? "" : fmt::format(" data-cells=\"{}\"", radix64(bytes));
  return fmt::format(
      "<canvas width={} height={} role=img aria-label=\"{}\" data-ramp={}{}></canvas>", columns,
      rows, html_text(words), ramp, cells);
}

namespace {

// "source ∇²y, 1/cell²"
std::string quantity_name(const Quantity& quantity) {
  return quantity.unit.empty() ? quantity.name : quantity.name + ", " + quantity.unit;
}
// For x, and for all that follows from it if it is a history.
std::string quantity_name(const FoundFields& all) {
  return all.is_history() ? all.x.name + " to " + quantity_name(all.y) : quantity_name(all.x);
}

// The captions of the snapshots.
struct Labels {
  std::string x = "x", truth = "x*", rest = "x − x*";
};
Labels labels_of(const FoundFields& all) {
  return all.is_history() ? Labels{"x to y", "x* to y*", "x − x* to y − y*"} : Labels{};
}

std::string short_figure(Real value) { return figure(std::stod(fmt::format("{:.3g}", value))); }

// Rows from the top; of a history the last, y, is the highest.
std::string cells_of(const FoundFields& all, std::span<const float> values, Real scale) {
  const auto columns = static_cast<std::ptrdiff_t>(all.frames().shape[2]);
  std::vector<float> cells(values.begin(), values.end());
  if (all.is_history()) {
    std::ranges::reverse(cells);
    for (auto row = cells.begin(); row != cells.end(); row += columns)
      std::reverse(row, row + columns);
  }
  return field_bytes(cells, scale);
}

// The data have the cells of x, x* and x − x*.
std::string picture(const FoundFields& all, std::span<const float> values, const std::string& label,
                    const std::string& words, const std::string& cells = "") {
  const FieldFrames& frames = all.frames();
  const auto [low, high] = std::ranges::minmax(values);
  return fmt::format(
      "<div class=\"picture{}\">{}<span>{}</span></div>", all.is_history() ? " history" : "",
      canvas_html(cells, frames.shape[1], frames.shape[2], "diverging",
                  fmt::format("{}, from {} to {}", words, short_figure(low), short_figure(high))),
      label);
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
  std::string pictures = picture(all, frames.target(), "y*", "y*: " + quantity_name(all.y),
                                 cells_of(all, frames.target(), all.y_scale));
  if (frames.has_truth())
    pictures += picture(all, frames.truth(), truth, truth + ": " + quantity_name(all));
  return fmt::format(
      "<figure class=given><div class=two>{}</div><figcaption><b>The data{}.</b> {}{}; the colour "
      "scale runs from −{} to {}.</figcaption></figure>",
      pictures, frames.has_truth() ? ", and the true x" : "",
      html_text("y* is the " + quantity_name(all.y)),
      all.is_history() ? " (top row of the image)" : "", short_figure(all.y_scale),
      short_figure(all.y_scale));
}

std::string found_html(const Comparison& c, const FoundFields& all, const FoundField& found) {
  const std::size_t last = found.frames.iterations.size() - 1;
  const OptimizerAxis& axis = c.optimizers[found.optimizer];
  const std::string name = shown_spec(axis.brief);
  const std::span<const float> x = found.frames.x(last);
  const Labels labels = labels_of(all);
  std::string pictures =
      picture(all, x, labels.x, fmt::format("{} of {}: {}", labels.x, name, quantity_name(all)));
  std::string apart;
  if (!found.apart.empty()) {
    std::vector<float> rest(x.begin(), x.end());
    for (std::size_t i = 0; i < rest.size(); ++i) rest[i] -= found.frames.truth()[i];
    pictures += picture(all, rest, labels.rest, fmt::format("{} of {}", labels.rest, name));
    apart = fmt::format(", <span class=norm>‖x − x*‖ <output class=apart>{}</output> ‖x*‖</span>",
                        html_text(apart_text(found, last)));
  }
  return fmt::format(
      "<figure data-s={}><div class=two>{}</div><figcaption>{}<b>{}</b>{} {}: iteration <output "
      "class=at>{}</output>{}</figcaption></figure>",
      found.optimizer, pictures, swatch(axis.method), html_text(name), marks_html(axis),
      html_text(kind_title(axis.mathematics())), found.frames.iterations[last], apart);
}

// The colours from −scale to scale, in a row.
std::string key_html(const FoundFields& all) {
  std::string bytes;  // 64 to 192: half of them, as far as colours go
  for (int byte = 64; byte <= 192; ++byte) bytes += static_cast<char>(byte);
  return fmt::format(
      "<p class=field-key><span>−{0}</span>{1}<span>{0}</span> {2}. {3} share this scale; values "
      "beyond it have the colour of its end.{4}</p>",
      short_figure(all.x_scale),
      canvas_html(bytes, 1, static_cast<Index>(bytes.size()), "diverging",
                  "from blue over white, which is 0, to orange"),
      html_text(quantity_name(all)), all.is_history() ? "All images" : "x, x* and x − x*",
      all.is_history()
          ? fmt::format(" The horizontal axis is space and the vertical axis is time: the "
                        "bottom row is x at time 0, and the top row is y at time {}.",
                        short_figure(all.time))
          : "");
}

std::string fields_reading(const Comparison& c, const FoundFields& all) {
  const std::string seed = fmt::format("seed {}", seed_text(all.seed));
  const std::string sample = all.is_learned ? "the first validation sample, " + seed : seed;
  std::string text = fmt::format("The best method of each kind, on {}.", sample);
  if (!all.frames().has_truth()) return text;
  const auto end = [](const FoundField& found) { return found.apart.back(); };
  const auto [least, most] = std::ranges::minmax_element(all.found, {}, end);
  const auto words = [&](const auto& at) {
    return fmt::format("{}, ‖x − x*‖ {} ‖x*‖", shown_spec(c.optimizers[at->optimizer].brief),
                       apart_text(*at, at->apart.size() - 1));
  };
  text += fmt::format(" At the end, x is nearest to x* for {}", words(least));
  if (least != most) text += fmt::format(" and farthest from it for {}", words(most));
  return text + ".";
}

}  // namespace

std::string fields_html(const Comparison& c, const FoundFields& all) {
  std::string figures = given_html(all);
  for (const FoundField& found : all.found) figures += found_html(c, all, found);
  return fmt::format(
      "<div class=fields><h4>Fields</h4><p class=reading>{}</p><div class=steps></div>{}<div "
      "class=field-cards>{}</div></div>",
      html_text(fields_reading(c, all)), key_html(all), figures);
}

std::string fields_json(const FoundFields& all) {
  const auto found_json = [&](const FoundField& one) {
    const auto of_each = [&](auto item) {
      return json_list(std::views::iota(std::size_t{0}, one.frames.iterations.size()), item);
    };
    return fmt::format(
        "{{\"s\":{},\"iterations\":{},\"apart\":{},\"x\":{}}}", one.optimizer,
        of_each([&](std::size_t i) { return std::to_string(one.frames.iterations[i]); }),
        of_each([&](std::size_t i) { return json_quoted(apart_text(one, i)); }),
        of_each([&](std::size_t i) {
          return json_quoted(letters_of(cells_of(all, one.frames.x(i), all.x_scale)));
        }));
  };
  const FieldFrames& frames = all.frames();
  const Labels labels = labels_of(all);
  return fmt::format(
      "{{\"labels\":[{},{}],\"truth\":{},\"found\":{}}}", json_quoted(labels.x),
      json_quoted(labels.rest),
      json_quoted(frames.has_truth() ? letters_of(cells_of(all, frames.truth(), all.x_scale)) : ""),
      json_list(all.found, found_json));
}

}  // namespace isoline::reports
