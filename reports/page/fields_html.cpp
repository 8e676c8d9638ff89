// The fields of a problem on a grid: y*, x*, and for one method of each kind x and what is missing,
// as pictures that stand without scripts; and as data, from which a reader chooses the step.
#include "reports/page/fields_html.h"

#include <fmt/format.h>

#include <algorithm>

#include "reports/formats/escape.h"
#include "reports/page/bitmap.h"
#include "reports/page/compact_json.h"
#include "reports/page/kinds.h"
#include "reports/page/page.h"
#include "reports/sections/words.h"

namespace isoline::reports {
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
