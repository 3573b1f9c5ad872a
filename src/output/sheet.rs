//! Pictures side by side, with captions and legends.

use super::heat::Scale;
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// One of the pictures of a [`sheet`].
#[derive(Debug, Clone)]
pub struct Panel {
    /// A line above it.
    pub caption: String,
    /// sRGB RGBA, 4 bytes a pixel, rows from top to bottom.
    pub rgba8: Vec<u8>,
    /// The scale of its colours, below it, and what they measure.
    pub legend: Option<(Scale, String)>,
}

const PAPER: [u8; 4] = [255; 4];
pub(super) const INK: [u8; 4] = [32, 34, 38, 255];
/// Pixels round each picture.
const MARGIN: usize = 12;
const LINE: usize = 16;
/// Height of a legend: bar, ticks' labels, what they measure.
const LEGEND: usize = BAR + 6 + 2 * LINE;
const BAR: usize = 14;

/// A picture of panels in rows of two, all of the same size in pixels, and its own size. Texts that do not fit end earlier.
pub fn sheet(size: [u32; 2], panels: &[Panel]) -> ([u32; 2], Vec<u8>) {
    let [width, height] = size.map(|n| n as usize);
    let columns = panels.len().min(2);
    let rows: Vec<&[Panel]> = panels.chunks(2).collect();
    let row_height = |row: &&[Panel]| {
        let legend = if row.iter().any(|panel| panel.legend.is_some()) { MARGIN / 2 + LEGEND } else { 0 };
        LINE + MARGIN / 2 + height + legend + MARGIN
    };
    let total = [columns * (width + MARGIN) + MARGIN, MARGIN + rows.iter().map(row_height).sum::<usize>()];
    let mut page = Page { width: total[0], pixels: vec![PAPER; total[0] * total[1]] };
    let mut y = MARGIN;
    for row in rows {
        for (column, panel) in row.iter().enumerate() {
            let x = MARGIN + column * (width + MARGIN);
            page.text([x, y], width, &panel.caption);
            page.picture([x, y + LINE + MARGIN / 2], width, &panel.rgba8);
            if let Some((scale, what)) = &panel.legend {
                page.legend([x, y + LINE + MARGIN + height], width, scale, what);
            }
        }
        y += row_height(&row);
    }
    (total.map(|n| n as u32), page.pixels.into_flattened())
}

/// Draws a legend into the lower left corner of a picture (sRGB RGBA, 4 bytes a pixel), where there is room for one.
pub fn draw_legend(size: [u32; 2], rgba8: &mut Vec<u8>, scale: &Scale, what: &str) {
    /// Widest legend.
    const WIDEST: usize = 420;
    let [width, height] = size.map(|n| n as usize);
    let bar = width.saturating_sub(4 * MARGIN).min(WIDEST);
    let box_height = LEGEND + MARGIN;
    if bar < WIDEST / 4 || height < 2 * box_height {
        return;
    }
    let mut page = Page { width, pixels: rgba8.as_chunks().0.to_vec() };
    let [x, y] = [MARGIN, height - box_height - MARGIN / 2];
    for row in y..y + box_height {
        page.pixels[row * width + x..row * width + x + bar + 2 * MARGIN].fill(PAPER);
    }
    page.legend([x + MARGIN, y + MARGIN / 2], bar, scale, what);
    *rgba8 = page.pixels.into_flattened();
}

/// Writes one line into pixels in rows of `width`; what is outside is left out.
pub(super) fn write_text(pixels: &mut [[u8; 4]], width: usize, [x, y]: [usize; 2], text: &str, ink: [u8; 4]) {
    let advance = get_raster_width(FontWeight::Regular, RasterHeight::Size16);
    for (i, c) in text.chars().enumerate() {
        let Some(glyph) = get_raster(c, FontWeight::Regular, RasterHeight::Size16) else { continue };
        for (row, line) in glyph.rows().enumerate() {
            for (column, &cover) in line.iter().enumerate() {
                let across = x + i * advance + column;
                let Some(pixel) = pixels.get_mut((y + row) * width + across).filter(|_| across < width) else {
                    continue;
                };
                for (channel, ink) in pixel.iter_mut().zip(ink) {
                    let mixed = u16::from(*channel) * (255 - u16::from(cover)) + u16::from(ink) * u16::from(cover);
                    *channel = (mixed / 255) as u8;
                }
            }
        }
    }
}

/// The longest beginning of a text that fits into so many characters, whole clauses if possible, else whole words, and no open
/// parenthesis.
fn fitting(text: &str, most: usize) -> &str {
    if text.chars().count() <= most {
        return text;
    }
    let mut best = ("", false);
    for (end, _) in text.match_indices(' ') {
        let part = &text[..end];
        let is_open = part.matches('(').count() > part.matches(')').count();
        let trimmed = part.trim_end_matches([',', ';', ':']);
        let is_clause = trimmed.len() < part.len() || text[end..].starts_with(" (");
        if !is_open && trimmed.chars().count() <= most && (is_clause || !best.1) {
            best = (trimmed, is_clause);
        }
    }
    best.0
}

struct Page {
    width: usize,
    pixels: Vec<[u8; 4]>,
}

impl Page {
    fn picture(&mut self, [x, y]: [usize; 2], width: usize, rgba8: &[u8]) {
        let (pixels, _) = rgba8.as_chunks();
        for (row, source) in pixels.chunks_exact(width).enumerate() {
            let start = (y + row) * self.width + x;
            self.pixels[start..start + width].copy_from_slice(source);
        }
    }

    /// Writes one line, as much of it as `width` pixels hold.
    fn text(&mut self, at: [usize; 2], width: usize, text: &str) {
        let advance = get_raster_width(FontWeight::Regular, RasterHeight::Size16);
        write_text(&mut self.pixels, self.width, at, fitting(text, width / advance), INK);
    }

    /// A bar with the colours of a scale, its ticks, and what it measures.
    fn legend(&mut self, [x, y]: [usize; 2], width: usize, scale: &Scale, what: &str) {
        for column in 0..width {
            let [r, g, b] = scale.colour_at(column as f32 / (width - 1).max(1) as f32);
            for row in y..y + BAR {
                self.pixels[row * self.width + x + column] = [r, g, b, 255];
            }
        }
        let advance = get_raster_width(FontWeight::Regular, RasterHeight::Size16);
        // Where the last label ends.
        let mut free = 0;
        for (value, label) in scale.ticks() {
            let at = (scale.place(value) * (width - 1) as f32).round() as usize;
            for row in y + BAR - 4..y + BAR + 3 {
                self.pixels[row * self.width + x + at] = INK;
            }
            let long = label.len() * advance;
            // In the middle below its tick, but inside the panel.
            let left = at.saturating_sub(long / 2).min(width.saturating_sub(long));
            if left >= free && long <= width {
                self.text([x + left, y + BAR + 4], long, &label);
                free = left + long + advance / 2;
            }
        }
        self.text([x, y + BAR + 6 + LINE], width, what);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_cut_between_clauses_and_words() {
        let text = "car: 350 over their limits, 9 of the worst 20 in the picture (hollow: hidden)";
        for (most, expected) in [
            (100, text),
            (70, "car: 350 over their limits, 9 of the worst 20 in the picture"),
            (40, "car: 350 over their limits"),
            (10, "car"),
            (2, ""),
        ] {
            assert_eq!(fitting(text, most), expected);
        }
        assert_eq!(fitting("Times the limit (0.001 units, 2 %)", 20), "Times the limit");
        assert_eq!(fitting("two words", 5), "two");
    }

    #[test]
    fn panels_stand_where_they_belong() {
        let red = [200u8, 10, 20, 255].repeat(64 * 40);
        let panel = |legend| Panel { caption: "a caption that is cut off".into(), rgba8: red.clone(), legend };
        let scale = Scale::logarithmic(1e-4, 1.0);
        let panels = [panel(None), panel(None), panel(Some((scale, "degrees".into())))];
        let ([width, height], pixels) = sheet([64, 40], &panels);
        assert_eq!([width, height], [2 * 76 + 12, 12 + 2 * (16 + 6 + 40 + 12) + 6 + LEGEND as u32]);
        assert_eq!(pixels.len(), 4 * (width * height) as usize);
        let count = |colour: [u8; 4]| pixels.as_chunks::<4>().0.iter().filter(|&&pixel| pixel == colour).count();
        assert_eq!(count([200, 10, 20, 255]), 3 * 64 * 40);
        // A panel as narrow as one pixel, which no caption fits, is no reason to fail.
        let dot = Panel { caption: "x".into(), rgba8: vec![0, 0, 0, 255], legend: Some((scale, String::new())) };
        assert_eq!(sheet([1, 1], &[dot]).0[0], 25);
    }
}
