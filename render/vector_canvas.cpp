// SPDX-License-Identifier: GPL-3.0-or-later
// The only file that knows cairo.
#include "render/vector_canvas.h"

#include <cairo-ft.h>
#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <ft2build.h>
#include FT_FREETYPE_H

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "base/at.h"
#include "base/output_file.h"
#include "render/mesh.h"
#include "render/text.h"

namespace pinchlab {

namespace {

struct Free {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* context) const { cairo_destroy(context); }
  void operator()(cairo_font_face_t* face) const { cairo_font_face_destroy(face); }
  void operator()(FT_Library library) const { FT_Done_FreeType(library); }
};
template <typename Type>
using Owned = std::unique_ptr<Type, Free>;

cairo_status_t append(void* text, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

/// The font of labels, kept for the process: cairo holds on to the face as long as it likes.
cairo_font_face_t* font_face() {
  static const Owned<cairo_font_face_t> face = [] {
    FT_Library library = nullptr;
    FT_Face font = nullptr;
    const std::string file = font_file();
    if (FT_Init_FreeType(&library) != 0 || FT_New_Face(library, file.c_str(), 0, &font) != 0) {
      throw std::runtime_error(file + ": not a font that FreeType can read");
    }
    return Owned<cairo_font_face_t>(
        cairo_ft_font_face_create_for_ft_face(font, FT_LOAD_NO_HINTING));
  }();
  return face.get();
}

/// Draws pictures into a cairo context whose unit is the pixel of a canvas.
class Pen {
 public:
  Pen(cairo_t* cairo, const Fit& fit) : cairo_(cairo), fit_(fit) {}

  void draw(const Picture& picture) {
    for (const Picture::Item& item : picture.order) {
      switch (item.kind) {
        case Picture::Kind::stroke:
          draw(picture.strokes[item.index]);
          break;
        case Picture::Kind::strip:
          draw(picture.strips[item.index], picture.points);
          break;
        case Picture::Kind::patch:
          draw(picture.patches[item.index], picture.corners);
          break;
        case Picture::Kind::label:
          draw(picture.labels[item.index]);
          break;
      }
    }
  }

  void text(const Vec2& centre, double em, const std::string& text, Colour colour) {
    cairo_set_font_face(cairo_, font_face());
    cairo_set_font_size(cairo_, em);
    cairo_text_extents_t capital, extents;
    cairo_text_extents(cairo_, "H", &capital);
    cairo_text_extents(cairo_, text.c_str(), &extents);
    set(colour);
    cairo_move_to(cairo_, centre.x() - 0.5 * extents.x_advance, centre.y() + 0.5 * capital.height);
    cairo_show_text(cairo_, text.c_str());
  }

 private:
  void set(Colour c) {
    cairo_set_source_rgba(cairo_, c.red / 255.0, c.green / 255.0, c.blue / 255.0, c.alpha / 255.0);
  }

  void draw(const Stroke& stroke) {
    const Vec2 a = fit_.point(stroke.a), b = fit_.point(stroke.b);
    const double outer = fit_.scale * stroke.half_width;
    const double inner = std::max(0.0, outer - fit_.scale * stroke.edge_width);
    const Colour edge = outer > inner ? stroke.edge : Colour{0, 0, 0, 0};
    if (a != b) {
      cairo_set_line_cap(cairo_, CAIRO_LINE_CAP_ROUND);
      for (const auto& [half, colour] : {std::pair(outer, edge), {inner, stroke.fill}}) {
        if (colour.alpha == 0 || half <= 0.0) continue;
        set(colour);
        cairo_set_line_width(cairo_, 2.0 * half);
        cairo_move_to(cairo_, a.x(), a.y());
        cairo_line_to(cairo_, b.x(), b.y());
        cairo_stroke(cairo_);
      }
      return;
    }
    constexpr double turn = 2.0 * std::numbers::pi;
    if (stroke.fill.alpha > 0 && inner > 0.0) {
      set(stroke.fill);
      cairo_arc(cairo_, a.x(), a.y(), inner, 0.0, turn);
      cairo_fill(cairo_);
    }
    if (edge.alpha > 0) {
      set(edge);
      cairo_set_line_width(cairo_, outer - inner);
      cairo_arc(cairo_, a.x(), a.y(), 0.5 * (outer + inner), 0.0, turn);
      cairo_stroke(cairo_);
    }
  }

  /// Adds a piece of a strip from one share of it to another (0..1) to the path.
  void add_piece(const Piece& piece, double from, double to) {
    const Vec2 start = piece.middle - 0.5 * piece.length * piece.along;
    if (piece.radius == 0.0) {
      const Vec2 a = start + from * piece.length * piece.along;
      const Vec2 b = start + to * piece.length * piece.along;
      cairo_line_to(cairo_, a.x(), a.y());
      cairo_line_to(cairo_, b.x(), b.y());
      return;
    }
    const Vec2 right(-piece.along.y(), piece.along.x());
    const bool turns_right = piece.turn < 0.0;
    const Vec2 outwards = turns_right ? Vec2(-right) : right;
    const Vec2 origin = piece.middle - piece.radius * std::cos(0.5 * piece.turn) * outwards;
    const double middle = std::atan2(outwards.y(), outwards.x());
    // Left turns go against cairo's angles, which grow clockwise as y points down.
    const double first = middle + piece.turn * (0.5 - from),
                 last = middle + piece.turn * (0.5 - to);
    (turns_right ? cairo_arc : cairo_arc_negative)(cairo_, origin.x(), origin.y(), piece.radius,
                                                   first, last);
  }

  /// Where each run of a strip begins and the last one ends: pieces that do not cover one another,
  /// drawn at once, as their directions stay within a right angle.
  static std::vector<std::size_t> runs_of(const std::vector<Piece>& pieces) {
    constexpr double widest = 0.5 * std::numbers::pi;  // rad
    std::vector<std::size_t> begins = {0};
    double heading = 0.0, low = 0.0, high = 0.0;  // rad, from where the run begins
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      heading += pieces[i].turn;
      low = std::min(low, heading);
      high = std::max(high, heading);
      if (high - low <= widest || i == 0) continue;
      begins.push_back(i);
      heading = pieces[i].turn;
      low = std::min(0.0, heading);
      high = std::max(0.0, heading);
    }
    begins.push_back(pieces.size());
    return begins;
  }

  struct Start {
    std::size_t piece;
    double share;  // of it, that is left out
  };

  /// So far (px) before a run: between the two, viewers would show a line. What is on top begins
  /// first, to cover the half-covered pixels where the other begins.
  static Start before(const std::vector<Piece>& pieces, std::size_t run, double distance) {
    Start start{run, 0.0};
    while (distance > 0.0 && start.piece > 0) {
      const double length = pieces[--start.piece].length;
      start.share = length > distance ? 1.0 - distance / length : 0.0;
      distance -= length;
    }
    return start;
  }

  void draw(const Strip& strip, const std::vector<StripPoint>& points) {
    if (strip.count < 2) return;
    const StripPoint* const first = points.data() + strip.first;
    std::vector<Piece> pieces;
    for (std::size_t i = 0; i + 1 < strip.count; ++i) {
      pieces.emplace_back(fit_.point(first[i].position), fit_.point(first[i + 1].position),
                          Fit::vector(first[i].tangent), Fit::vector(first[i + 1].tangent));
    }
    const double outer = fit_.scale * strip.half_width;
    const double inner = std::max(0.0, outer - fit_.scale * strip.edge_width);
    const Colour edge = outer > inner ? strip.edge : Colour{0, 0, 0, 0};
    cairo_set_line_cap(cairo_, CAIRO_LINE_CAP_BUTT);
    cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_ROUND);
    const std::vector<std::size_t> begins = runs_of(pieces);
    for (std::size_t run = 0; run + 1 < begins.size(); ++run) {
      double overlap = 0.0;  // px
      for (const auto& [half, colour] : {std::pair(outer, edge), {inner, strip.fill}}) {
        if (colour.alpha == 0 || half <= 0.0) continue;
        set(colour);
        cairo_set_line_width(cairo_, 2.0 * half);
        cairo_new_path(cairo_);
        const Start start = before(pieces, begins[run], overlap += 1.0);
        for (std::size_t i = start.piece; i < begins[run + 1]; ++i)
          add_piece(pieces[i], i == start.piece ? start.share : 0.0, 1.0);
        cairo_stroke(cairo_);
      }
      if (strip.mark_length > 0.0)
        draw_marks(strip, first, pieces, before(pieces, begins[run], overlap + 1.0),
                   begins[run + 1]);
    }
  }

  /// A mark on several pieces of a run is one path.
  void draw_marks(const Strip& strip, const StripPoint* points, const std::vector<Piece>& pieces,
                  const Start& start, std::size_t end) {
    set(strip.mark);
    const double inner = fit_.scale * std::max(0.0, strip.half_width - strip.edge_width);
    cairo_set_line_width(cairo_, 2.0 * inner);
    const double spacing = strip.mark_spacing, half = 0.5 * strip.mark_length;
    bool goes_on = false;  // a mark, on to the next piece
    for (std::size_t i = start.piece; i < end; ++i) {
      const double low = points[i].material, high = points[i + 1].material;
      if (high <= low || pieces[i].length == 0.0) continue;
      const double begin = i == start.piece ? start.share : 0.0;
      const double seen = low + begin * (high - low);
      for (double mark = std::ceil((seen - half) / spacing) * spacing; mark - half < high;
           mark += spacing) {
        const double from = std::clamp((mark - half - low) / (high - low), begin, 1.0);
        const double to = std::clamp((mark + half - low) / (high - low), begin, 1.0);
        if (goes_on && from > 0.0) cairo_stroke(cairo_);
        if (!goes_on || from > 0.0) cairo_new_path(cairo_);
        add_piece(pieces[i], from, to);
        goes_on = to == 1.0;
        if (!goes_on) cairo_stroke(cairo_);
      }
    }
    if (goes_on) cairo_stroke(cairo_);
  }

  void draw(const Patch& patch, const std::vector<Vec2>& corners) {
    set(patch.fill);
    cairo_new_path(cairo_);
    for (std::size_t i = 0; i < patch.count; ++i) {
      const Vec2 corner = fit_.point(corners[patch.first + i]);
      cairo_line_to(cairo_, corner.x(), corner.y());
    }
    cairo_fill(cairo_);
  }

  void draw(const Label& label) {
    text(fit_.point(label.centre), fit_.scale * label.height, label.text, label.colour);
  }

  cairo_t* cairo_;
  Fit fit_;
};

/// Where the frames lie on the page, as in contact_sheet.
struct Layout {
  int columns = 1, gap = 0, text = 0, strip = 0;
  int page_width = 0, page_height = 0;
  Layout(int width, int height, int count, int wanted_columns) {
    if (count == 1) {
      page_width = width;
      page_height = height;
      return;
    }
    columns =
        wanted_columns > 0
            ? wanted_columns
            : static_cast<int>(std::ceil(std::sqrt(static_cast<double>(count) * height / width)));
    columns = std::min(columns, count);
    const int rows = (count + columns - 1) / columns;
    gap = std::max(4, width / 60);
    text = std::max(12, width / 24);
    strip = 2 * text;
    page_width = gap + columns * (width + gap);
    page_height = gap + rows * (height + strip);
  }
};

}  // namespace

void write_vector(const std::string& path, VectorFormat format, int width, int height,
                  const std::vector<VectorFrame>& frames, int columns, const Theme& theme) {
  if (frames.empty()) throw std::invalid_argument(path + ": a picture needs at least one frame");
  const int count = static_cast<int>(frames.size());
  const Layout page(width, height, count, columns);
  OutputFile out(path);
  std::string text;
  Owned<cairo_surface_t> surface(
      format == VectorFormat::svg
          ? cairo_svg_surface_create_for_stream(append, &text, page.page_width, page.page_height)
          : cairo_pdf_surface_create_for_stream(append, &text, page.page_width, page.page_height));
  if (format == VectorFormat::pdf) {  // no date of making: the same picture gives the same bytes
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE,
                                   "2000-01-01T00:00:00Z");
  } else {
    cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_PX);
  }
  Owned<cairo_t> cairo(cairo_create(surface.get()));
  const auto paint = [&cairo](const Colour& paper) {
    if (paper.alpha == 0) return;
    cairo_set_source_rgba(cairo.get(), paper.red / 255.0, paper.green / 255.0, paper.blue / 255.0,
                          paper.alpha / 255.0);
    cairo_paint(cairo.get());
  };
  if (count > 1 && theme.background.alpha == 255) paint(theme.background);  // under the labels
  std::vector<std::string> labels;
  for (const VectorFrame& frame : frames) labels.push_back(frame.label);
  const double em = count > 1 ? Font().fitting(labels, page.text, width) : 0.0;  // of the labels
  for (int i = 0; i < count; ++i) {
    const VectorFrame& frame = at(frames, i);
    const int column = i % page.columns, row = i / page.columns;
    const double left = page.gap + column * (width + page.gap);
    const double top = page.gap + row * (height + page.strip);
    cairo_save(cairo.get());
    cairo_translate(cairo.get(), left, top);
    cairo_rectangle(cairo.get(), 0.0, 0.0, width, height);
    cairo_clip(cairo.get());
    paint(frame.picture.background);
    const Fit fit(frame.picture.view, 0, width, height);
    Pen(cairo.get(), fit).draw(frame.picture);
    cairo_restore(cairo.get());
    if (count > 1) {
      Pen(cairo.get(), fit)
          .text({left + 0.5 * width, top + height + 0.5 * page.strip}, em, frame.label, theme.ink);
    }
  }
  cairo.reset();
  cairo_surface_finish(surface.get());
  if (const cairo_status_t status = cairo_surface_status(surface.get());
      status != CAIRO_STATUS_SUCCESS) {
    throw std::runtime_error(
        fmt::format("{}: cannot be drawn: {}", path, cairo_status_to_string(status)));
  }
  out.write(text);
  out.finish();
}

}  // namespace pinchlab
