//! Drawing: a figure as SVG, and as PNG from the same strokes.
//!
//! Decision (2026-11-22): `plotters` draws with an embedded font (Noto Sans of the crate `notosans`), because a PNG must look
//! the same on a machine without fonts, instead of `resvg`, which needs a font file just the same and ten times the code.
//! Axes and labels are placed here, because its meshes leave a logarithmic axis of one decade without numbers. A PNG is
//! drawn at twice its size and averaged, because its strokes are not smoothed.

use super::axis::Axis;
use super::figure::{Figure, Join, Point};
use super::labels::{Frame, Layout};
use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Polygon, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    Color, FontStyle, FontTransform, IntoFont, RGBColor, ShapeStyle, TextStyle, WHITE, register_font,
};

/// Width and height of a figure, in points of SVG.
const SIZE: [f64; 2] = [860.0, 560.0];
/// Pixels of a PNG for a point of SVG.
const PNG_SCALE: f64 = 1.5;
/// How many pixels of each side are averaged to one.
const OVERSAMPLING: u32 = 2;
/// What the plot leaves free: left, top, right, bottom.
const MARGINS: [f64; 4] = [88.0, 54.0, 24.0, 64.0];

/// The room at the right for the names of many lines.
const KEY: f64 = 262.0;
/// More groups than this are named at the right.
const MANY: usize = 6;

const INK: RGBColor = RGBColor(40, 40, 40);
const PALE: RGBColor = RGBColor(228, 228, 228);
/// Colors that eyes of all kinds tell apart. Source: Okabe and Ito 2008.
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];

/// The figure as the text of an SVG file.
pub fn svg(figure: &Figure) -> Result<String, String> {
    let mut text = String::new();
    {
        let size = (SIZE[0] as u32, SIZE[1] as u32);
        let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
        Sheet::new(root, 1.0)?.draw(figure)?;
    }
    Ok(text)
}

/// The figure as pixels: width, height, and three bytes a pixel.
pub fn pixels(figure: &Figure) -> Result<(u32, u32, Vec<u8>), String> {
    let scale = PNG_SCALE * f64::from(OVERSAMPLING);
    let (width, height) = ((SIZE[0] * PNG_SCALE) as u32, (SIZE[1] * PNG_SCALE) as u32);
    let (wide, high) = (width * OVERSAMPLING, height * OVERSAMPLING);
    let mut fine = vec![255u8; 3 * wide as usize * high as usize];
    {
        let root = BitMapBackend::with_buffer(&mut fine, (wide, high)).into_drawing_area();
        Sheet::new(root, scale)?.draw(figure)?;
    }
    let mut out = Vec::with_capacity(3 * width as usize * height as usize);
    for y in 0..height {
        for x in 0..width {
            for channel in 0..3 {
                let mut sum = 0;
                for k in 0..OVERSAMPLING * OVERSAMPLING {
                    let (fx, fy) = (x * OVERSAMPLING + k % OVERSAMPLING, y * OVERSAMPLING + k / OVERSAMPLING);
                    sum += u32::from(fine[3 * (fy as usize * wide as usize + fx as usize) + channel]);
                }
                out.push((sum / (OVERSAMPLING * OVERSAMPLING)) as u8);
            }
        }
    }
    Ok((width, height, out))
}

/// A sheet to draw on, in points of SVG whatever the resolution.
struct Sheet<B: DrawingBackend> {
    root: DrawingArea<B, Shift>,
    scale: f64,
}

type Drawn = Result<(), String>;

fn text_of(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// Makes the embedded font the one that `plotters` calls "sans-serif".
pub fn register_fonts() -> Drawn {
    register_font("sans-serif", FontStyle::Normal, notosans::REGULAR_TTF)
        .and_then(|()| register_font("sans-serif", FontStyle::Bold, notosans::BOLD_TTF))
        .map_err(|_| "the embedded font cannot be read".to_owned())
}

impl<B: DrawingBackend> Sheet<B> {
    fn new(root: DrawingArea<B, Shift>, scale: f64) -> Result<Self, String> {
        register_fonts()?;
        root.fill(&WHITE).map_err(text_of)?;
        Ok(Sheet { root, scale })
    }

    fn draw(&self, figure: &Figure) -> Drawn {
        let plot = Plot::new(figure);
        self.axes(&plot, figure)?;
        for (index, group) in figure.groups().into_iter().enumerate() {
            self.curve(&plot, figure, group, COLORS[index % COLORS.len()])?;
        }
        for point in figure.points.iter().filter(|_| figure.join != Join::Curves) {
            self.marker(plot.at(point), plot.index(figure, point), point.front || figure.join == Join::Lines)?;
        }
        self.legend(figure, &plot)?;
        self.labels(&plot, figure)?;
        self.root.present().map_err(text_of)
    }

    fn pixel(&self, at: [f64; 2]) -> (i32, i32) {
        ((at[0] * self.scale).round() as i32, (at[1] * self.scale).round() as i32)
    }

    fn stroke(&self, color: RGBColor, width: f64) -> ShapeStyle {
        color.stroke_width((width * self.scale).round().max(1.0) as u32)
    }

    fn line(&self, path: &[[f64; 2]], color: RGBColor, width: f64) -> Drawn {
        let path: Vec<(i32, i32)> = path.iter().map(|at| self.pixel(*at)).collect();
        self.root.draw(&PathElement::new(path, self.stroke(color, width))).map_err(text_of)
    }

    fn style(&self, size: f64, color: RGBColor, bold: bool) -> TextStyle<'static> {
        let style = if bold { FontStyle::Bold } else { FontStyle::Normal };
        ("sans-serif", size * self.scale, style).into_font().color(&color)
    }

    fn write(&self, text: &str, at: [f64; 2], style: &TextStyle) -> Drawn {
        self.root.draw(&Text::new(text.to_owned(), self.pixel(at), style.clone())).map_err(text_of)
    }

    /// Width and height of a text.
    fn size(&self, text: &str, style: &TextStyle) -> Result<[f64; 2], String> {
        let (width, height) = self.root.estimate_text_size(text, style).map_err(text_of)?;
        Ok([f64::from(width) / self.scale, f64::from(height) / self.scale])
    }

    fn axes(&self, plot: &Plot, figure: &Figure) -> Drawn {
        let [left, top, right, bottom] = plot.area;
        let below = self.style(12.0, INK, false).pos(Pos::new(HPos::Center, VPos::Top));
        for (value, text) in plot.x.ticks() {
            let x = left + plot.x.place(value) * (right - left);
            let end = if text.is_empty() { bottom - 4.0 } else { top };
            self.line(&[[x, end], [x, bottom]], if text.is_empty() { INK } else { PALE }, 1.0)?;
            self.write(&text, [x, bottom + 7.0], &below)?;
        }
        let beside = self.style(12.0, INK, false).pos(Pos::new(HPos::Right, VPos::Center));
        for (value, text) in plot.y.ticks() {
            let y = bottom - plot.y.place(value) * (bottom - top);
            let end = if text.is_empty() { left + 4.0 } else { right };
            self.line(&[[left, y], [end, y]], if text.is_empty() { INK } else { PALE }, 1.0)?;
            self.write(&text, [left - 7.0, y], &beside)?;
        }
        self.line(&[[left, top], [left, bottom], [right, bottom]], INK, 1.2)?;
        let title = self.style(16.0, INK, true).pos(Pos::new(HPos::Left, VPos::Center));
        self.write(&figure.title, [left, 24.0], &title)?;
        let name = self.style(13.0, INK, false).pos(Pos::new(HPos::Center, VPos::Center));
        self.write(&figure.cost, [0.5 * (left + right), bottom + 42.0], &name)?;
        let upright = self.style(13.0, INK, false).transform(FontTransform::Rotate270);
        let upright = upright.pos(Pos::new(HPos::Center, VPos::Center));
        self.write(&figure.error, [22.0, 0.5 * (top + bottom)], &upright)
    }

    /// The front of a group as steps, or its points joined by a line.
    fn curve(&self, plot: &Plot, figure: &Figure, group: &str, color: RGBColor) -> Drawn {
        match plot.path(figure, group) {
            path if path.len() > 1 => self.line(&path, color, 1.8),
            _ => Ok(()),
        }
    }

    /// The mark of a group: filled on the front, hollow off it.
    fn marker(&self, at: [f64; 2], group: usize, filled: bool) -> Drawn {
        let color = COLORS[group % COLORS.len()];
        let corners = |list: &[[f64; 2]]| -> Vec<(i32, i32)> {
            list.iter().map(|c| self.pixel([at[0] + 5.0 * c[0], at[1] + 5.0 * c[1]])).collect()
        };
        let shape: &[[f64; 2]] = match group % 4 {
            1 => &[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]],
            2 => &[[0.0, -1.2], [1.1, 0.8], [-1.1, 0.8]],
            3 => &[[0.0, -1.25], [1.25, 0.0], [0.0, 1.25], [-1.25, 0.0]],
            _ => {
                let radius = (5.0 * self.scale) as i32;
                let inside = if filled { color } else { WHITE };
                self.root.draw(&Circle::new(self.pixel(at), radius, inside.filled())).map_err(text_of)?;
                return self.root.draw(&Circle::new(self.pixel(at), radius, self.stroke(color, 1.8))).map_err(text_of);
            }
        };
        let inside = if filled { color } else { WHITE };
        self.root.draw(&Polygon::new(corners(shape), inside.filled())).map_err(text_of)?;
        let mut outline = corners(shape);
        outline.push(outline[0]);
        self.root.draw(&PathElement::new(outline, self.stroke(color, 1.8))).map_err(text_of)
    }

    /// The names of the groups over the plot. Many lines are named at their ends instead.
    fn legend(&self, figure: &Figure, plot: &Plot) -> Drawn {
        let style = self.style(12.0, INK, false).pos(Pos::new(HPos::Left, VPos::Center));
        let groups = figure.groups();
        if groups.len() > MANY {
            return self.key(figure, plot);
        }
        if groups.len() < 2 {
            return Ok(());
        }
        let mut x = plot.area[0];
        for (index, group) in groups.iter().enumerate() {
            self.marker([x + 6.0, 44.0], index, true)?;
            self.write(group, [x + 16.0, 45.0], &style)?;
            x += 34.0 + self.size(group, &style)?[0];
        }
        Ok(())
    }

    /// The names of many lines at the right of the plot, in the order in which the lines end.
    fn key(&self, figure: &Figure, plot: &Plot) -> Drawn {
        let style = self.style(11.5, INK, false).pos(Pos::new(HPos::Left, VPos::Center));
        let mut ends: Vec<&Point> = figure.points.iter().filter(|p| !p.method.is_empty()).collect();
        ends.sort_by(|a, b| (b.error * b.cost).total_cmp(&(a.error * a.cost)));
        let [_, top, right, _] = plot.area;
        for (row, point) in ends.into_iter().enumerate() {
            let y = top + 12.0 + 22.0 * row as f64;
            self.marker([right + 18.0, y], plot.index(figure, point), true)?;
            self.write(&point.method, [right + 30.0, y + 1.0], &style)?;
        }
        Ok(())
    }

    fn labels(&self, plot: &Plot, figure: &Figure) -> Drawn {
        let around = |at: [f64; 2], d: f64| [at[0] - d, at[1] - d, at[0] + d, at[1] + d];
        let mut taken: Vec<Frame> = figure.points.iter().map(|p| around(plot.at(p), 6.0)).collect();
        for group in figure.groups() {
            for pair in plot.path(figure, group).windows(2) {
                let steps = ((pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]) / 6.0).ceil().max(1.0);
                for k in 0..=steps as usize {
                    let t = k as f64 / steps;
                    let at = [0, 1].map(|axis| pair[0][axis] + t * (pair[1][axis] - pair[0][axis]));
                    taken.push(around(at, 2.0));
                }
            }
        }
        if figure.groups().len() > MANY {
            return Ok(());
        }
        let mut layout = Layout::new(plot.area, taken);
        for point in figure.points.iter().filter(|p| !p.method.is_empty()) {
            let index = plot.index(figure, point);
            let color = darker(COLORS[index % COLORS.len()]);
            let style = self.style(11.5, color, point.front && figure.join == Join::Front);
            let [width, height] = self.size(&point.method, &style)?;
            let at = plot.at(point);
            let frame = layout.place(at, [width + 2.0, height.max(13.0)], 9.0);
            let middle = [0.5 * (frame[0] + frame[2]), 0.5 * (frame[1] + frame[3])];
            let nearest = [at[0].clamp(frame[0], frame[2]), at[1].clamp(frame[1], frame[3])];
            if (nearest[0] - at[0]).hypot(nearest[1] - at[1]) > 13.0 {
                self.line(&[at, nearest], color, 0.6)?;
            }
            self.write(&point.method, middle, &style.pos(Pos::new(HPos::Center, VPos::Center)))?;
        }
        Ok(())
    }
}

/// Text needs more contrast than marks do.
fn darker(color: RGBColor) -> RGBColor {
    let dark = |c: u8| (f32::from(c) * 0.72) as u8;
    RGBColor(dark(color.0), dark(color.1), dark(color.2))
}

/// Where the points of a figure lie.
struct Plot {
    area: Frame,
    x: Axis,
    y: Axis,
}

impl Plot {
    fn new(figure: &Figure) -> Self {
        let right = if figure.groups().len() > MANY { KEY } else { MARGINS[2] };
        let area = [MARGINS[0], MARGINS[1], SIZE[0] - right, SIZE[1] - MARGINS[3]];
        let axis = if figure.join == Join::Curves { Axis::from_zero } else { Axis::around };
        let numbers = |of: fn(&Point) -> f64| figure.points.iter().map(of).collect::<Vec<f64>>();
        let (x, y) = (axis(&numbers(|p| p.cost)), axis(&numbers(|p| p.error)));
        Plot { area, x, y }
    }

    fn at(&self, point: &Point) -> [f64; 2] {
        let [left, top, right, bottom] = self.area;
        [left + self.x.place(point.cost) * (right - left), bottom - self.y.place(point.error) * (bottom - top)]
    }

    fn index(&self, figure: &Figure, point: &Point) -> usize {
        figure.groups().iter().position(|group| *group == point.group).unwrap_or(0)
    }

    fn path(&self, figure: &Figure, group: &str) -> Vec<[f64; 2]> {
        if figure.join != Join::Front {
            return figure.points.iter().filter(|p| p.group == group).map(|p| self.at(p)).collect();
        }
        let mut path: Vec<[f64; 2]> = Vec::new();
        for point in figure.front(group) {
            let at = self.at(point);
            if let Some(last) = path.last().copied() {
                path.push([at[0], last[1]]);
            }
            path.push(at);
        }
        path
    }
}
