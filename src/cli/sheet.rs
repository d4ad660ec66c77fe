//! Contact sheets: a picture for each value of a parameter, or of two, side by side with labels, over one hierarchy.

use super::failure::Failure;
use super::keep::Signals;
use super::label::{label, label_height};
use super::subject::Subject;
use crate::limits::{CELLS, PIXELS};
use crate::render::{About, Image, Renderer, Settings, Silent};
use crate::scene::{GroupCompiler, GroupSpec, Scene, ShaderFiles};
use indicatif::ProgressBar;

/// The side of a cell, as a share of that of a picture alone: ten cells then have 1.6 times its pixels.
const SHARE: f32 = 0.4;

/// Values of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The parameter, as it is called on the command line.
    pub name: String,
    /// Its values, as text.
    pub values: Vec<String>,
}

impl Sweep {
    /// Reads `FROM:TO:N`, where `FROM` and `TO` are numbers, or as many numbers with commas between.
    pub fn read(name: &str, text: &str) -> Result<Self, String> {
        let wrong =
            |what: &str| format!("a sweep is FROM:TO:N, such as 0.1:1:10 or 1,0,0:0,0,1:5, not `{text}`; {what}");
        let [from, to, count] = <[&str; 3]>::try_from(text.split(':').collect::<Vec<_>>())
            .map_err(|_| wrong("it has three parts with colons between"))?;
        let numbers = |text: &str| -> Result<Vec<f64>, String> {
            let numbers = text.split(',').map(|part| part.trim().parse::<f64>().ok().filter(|x| x.is_finite()));
            numbers.collect::<Option<Vec<f64>>>().ok_or_else(|| wrong("FROM and TO are numbers"))
        };
        let (from, to) = (numbers(from)?, numbers(to)?);
        let count: usize = count.trim().parse().map_err(|_| wrong("N is a whole number"))?;
        if from.len() != to.len() {
            return Err(wrong("FROM and TO have as many numbers"));
        }
        if !(1..=CELLS).contains(&count) {
            return Err(wrong(&format!("N is between 1 and {CELLS}")));
        }
        let value = |i: usize| {
            let share = i as f64 / (count.max(2) - 1) as f64;
            let numbers = from.iter().zip(&to).map(|(a, b)| number(a + (b - a) * share));
            numbers.collect::<Vec<_>>().join(",")
        };
        Ok(Sweep { name: name.to_owned(), values: (0..count).map(value).collect() })
    }
}

/// A number in at most four digits that count, so that it and its label are the same.
fn number(x: f64) -> String {
    let digits = 4 - (x.abs().log10().floor() as i32 + 1).clamp(-10, 4);
    let text = format!("{x:.*}", digits as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A sheet that is to be made: across and down.
pub struct Sheet<'a> {
    /// What is shown.
    pub subject: Subject<'a>,
    /// Values that are the same in all cells, by paths.
    pub fixed: Vec<(String, String)>,
    /// One sweep, whose cells go on in the next row, or two, the second of which goes down.
    pub sweeps: Vec<Sweep>,
}

impl Sheet<'_> {
    /// Columns and rows: of one sweep about as many of both, without a hole where that can be.
    fn grid(&self) -> [usize; 2] {
        match &self.sweeps[..] {
            [across, down] => [across.values.len(), down.values.len()],
            sweeps => {
                let count = sweeps.first().map_or(1, |sweep| sweep.values.len());
                let least = (1..=count).find(|n| n * n >= count).unwrap_or(1);
                let whole = (least..2 * least).find(|n| count.is_multiple_of(*n));
                let columns = whole.unwrap_or(least);
                [columns, count.div_ceil(columns)]
            }
        }
    }

    /// The values of a cell, and its label.
    fn cell(&self, number: usize) -> (Vec<(String, String)>, String) {
        let [columns, _] = self.grid();
        let index = |sweep: usize| match (self.sweeps.len(), sweep) {
            (2, 0) => number % columns,
            (2, _) => number / columns,
            _ => number,
        };
        let chosen = self.sweeps.iter().enumerate().map(|(k, sweep)| (&sweep.name, &sweep.values[index(k)]));
        let (mut values, mut words) = (self.fixed.clone(), Vec::new());
        for (name, value) in chosen {
            values.push((self.subject.param(name), value.clone()));
            words.push(format!("{name} {value}"));
        }
        (values, words.join("   "))
    }

    /// How many cells it has.
    pub fn cells(&self) -> usize {
        self.sweeps.iter().map(|sweep| sweep.values.len()).product()
    }

    /// The settings of a cell: smaller than a picture, unless a size was asked for.
    pub fn settings(&self, settings: &Settings, sized: bool) -> Settings {
        let side = |n: u32| if sized { n } else { ((n as f32 * SHARE).round() as u32).max(1) };
        Settings { width: side(settings.width), height: side(settings.height), ..settings.clone() }
    }

    /// The values of the first cell, by which the scene is loaded.
    pub fn first(&self) -> Vec<(String, String)> {
        self.cell(0).0
    }

    /// Renders all cells, the first of them with `renderer`, which was made of `scene` for it; cells that a signal leaves out are black.
    pub fn render(
        &self,
        mut renderer: Renderer,
        scene: &Scene,
        shaders: &mut ShaderFiles,
        signals: &Signals,
    ) -> Result<Image, Failure> {
        let Settings { width, height, .. } = *renderer.settings();
        let ([columns, rows], band) = (self.grid(), label_height(width));
        let mut sheet = Image {
            width: columns as u32 * width,
            height: rows as u32 * (height + band),
            channels: if renderer.settings().alpha { 4 } else { 3 },
            pixels: Vec::new(),
            about: renderer.about(),
        };
        check_size(&sheet)?;
        sheet.pixels = vec![0.0; sheet.width as usize * sheet.height as usize * sheet.channels];
        let bar = ProgressBar::new(self.cells() as u64);
        for number in 0..self.cells() {
            let (values, words) = self.cell(number);
            if number > 0 {
                shaders.set_params(values);
                renderer = match changed(renderer, scene, shaders) {
                    Err(_) if signals.asked().is_some() => break,
                    next => next?,
                };
            }
            renderer.finish(&Silent).map_err(Failure::of_render)?;
            let place = [(number % columns) as u32 * width, (number / columns) as u32 * (height + band)];
            paste(&mut sheet, &renderer.picture(), place);
            let words = label(&words, [width, band], sheet.channels).map_err(Failure::Usage)?;
            paste(&mut sheet, &words, [place[0], place[1] + height]);
            add(&mut sheet.about, &renderer.about());
            bar.inc(1);
            if signals.asked().is_some() {
                break;
            }
        }
        bar.finish_and_clear();
        Ok(sheet)
    }
}

/// The renderer with what `shaders` make of the scene's groups now; its hierarchy stays, unless other surfaces are moved.
fn changed(mut renderer: Renderer, scene: &Scene, shaders: &ShaderFiles) -> Result<Renderer, Failure> {
    let compile = |spec: &GroupSpec| shaders.compile(spec).map_err(Failure::of_scene);
    let (mut materials, mut surfaces, mut moves) = (renderer.scene().materials.clone(), Vec::new(), false);
    for (number, material) in materials.iter_mut().enumerate() {
        if let Some(spec) = material.displacement_spec.as_ref().filter(|spec| shaders.sets(spec)) {
            material.displacement = Some(compile(spec)?);
            moves = true;
        }
        if shaders.sets(&material.surface_spec) {
            material.surface = compile(&material.surface_spec)?;
            surfaces.push((number, material.surface.clone()));
        }
    }
    if moves {
        let scene = Scene { materials, ..scene.clone() };
        return renderer.anew(&scene).map_err(Failure::of_render);
    }
    renderer.set_materials(surfaces).map_err(Failure::of_render)?;
    Ok(renderer)
}

/// Says how large the sheet would be, when that is too large.
fn check_size(sheet: &Image) -> Result<(), Failure> {
    if u64::from(sheet.width) * u64::from(sheet.height) <= PIXELS {
        return Ok(());
    }
    let Image { width, height, .. } = *sheet;
    let text = format!("error: a sheet of {width} x {height} pixels is too large; {PIXELS} pixels are the most");
    Err(Failure::Usage(format!("{text}\n  help: ask for smaller cells with --res, or for fewer")))
}

/// Counts another cell to what is known of the sheet.
fn add(sheet: &mut About, cell: &About) {
    sheet.paths += cell.paths;
    sheet.rays += cell.rays;
    sheet.seconds_tracing += cell.seconds_tracing;
    sheet.taken = [sheet.taken[0].min(cell.taken[0]), sheet.taken[1].max(cell.taken[1])];
    sheet.reports.extend(cell.reports.iter().cloned());
}

/// Puts a picture of as many channels onto the sheet.
fn paste(sheet: &mut Image, picture: &Image, [x, y]: [u32; 2]) {
    let (row, across) = (picture.width as usize * picture.channels, sheet.width as usize * sheet.channels);
    for (line, from) in picture.pixels.chunks_exact(row).enumerate() {
        let start = (y as usize + line) * across + x as usize * sheet.channels;
        sheet.pixels[start..start + row].copy_from_slice(from);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sweep_has_its_ends_and_even_steps() {
        let values = |text| Sweep::read("x", text).map(|sweep| sweep.values);
        assert_eq!(values("0.1:0.5:5").unwrap(), ["0.1", "0.2", "0.3", "0.4", "0.5"]);
        assert_eq!(values("1,0,0:0,0,1:3").unwrap(), ["1,0,0", "0.5,0,0.5", "0,0,1"]);
        assert_eq!(values("3:9:7").unwrap(), ["3", "4", "5", "6", "7", "8", "9"]);
        assert_eq!(values("-1e-5:1000000:2").unwrap(), ["-0.00001", "1000000"]);
        assert_eq!(values("0.25:1:1").unwrap(), ["0.25"]);
        assert_eq!(values("0.06:1:10").unwrap()[1], "0.1644");
        assert_eq!(values("0:0:2").unwrap(), ["0", "0"]);
        for wrong in ["", "1:2", "1:2:3:4", "a:2:3", "1:2:0", "1:2:x", "1,2:3:4", "nan:1:2", "0:1:100000"] {
            assert!(values(wrong).unwrap_err().contains("FROM:TO:N"), "{wrong}");
        }
    }

    #[test]
    fn one_sweep_makes_a_grid_without_holes_where_it_can() {
        let grid = |counts: &[usize]| {
            let sweep = |count: &usize| Sweep { name: "x".to_owned(), values: vec![String::new(); *count] };
            let subject = Subject { argument: "a.xml", search: &[] };
            Sheet { subject, fixed: Vec::new(), sweeps: counts.iter().map(sweep).collect() }.grid()
        };
        assert_eq!(grid(&[10]), [5, 2]);
        assert_eq!(grid(&[1]), [1, 1]);
        assert_eq!(grid(&[7]), [3, 3]);
        assert_eq!(grid(&[16]), [4, 4]);
        assert_eq!(grid(&[4, 6]), [4, 6]);
    }
}
