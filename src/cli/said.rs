//! What shaders have said in a render.

use super::failure::Failure;
use super::speak::{say, tell};
use crate::exec::{Report, ReportKind};
use crate::limits::{PRINTED, PRINTED_BYTES};
use crate::render::Renderer;

/// Prints what shaders say at a pixel, with the name of the layer before the first word of each.
pub fn debug_pixel(renderer: &Renderer, [x, y]: [u32; 2]) -> Result<(), Failure> {
    let [width, height] = renderer.settings().whole_frame().size;
    if x >= width || y >= height {
        return Err(Failure::Usage(format!("error: there is no pixel {x} {y} in a picture of {width} x {height}")));
    }
    let (mut layer, reports) = (None, renderer.pixel_reports(x, y));
    if reports.is_empty() {
        tell(&format!("no shader says anything at pixel {x} {y}\n"));
    }
    for report in reports {
        if layer.as_ref() != Some(&report.place.layer) {
            tell(&format!("layer {} (shader {})\n", report.place.layer, report.place.shader));
            layer = Some(report.place.layer.clone());
        }
        pass_on(&[report]);
    }
    Ok(())
}

/// Passes on what shaders said.
pub fn pass_on(reports: &[Report]) {
    let mut bytes = 0;
    let mut fits = |report: &&Report| {
        bytes += report.text.len();
        bytes <= PRINTED_BYTES
    };
    let told = reports.iter().take(PRINTED).take_while(&mut fits).count();
    for report in &reports[..told] {
        match &report.kind {
            ReportKind::Output => say(&report.text),
            ReportKind::File(_) => tell(&report.to_string()),
            ReportKind::Warning | ReportKind::Error | ReportKind::Mistake(_) | ReportKind::Fatal => {
                tell(&format!("{report}\n"));
            }
        }
    }
    if reports.len() > told {
        // How many there would be depends on the threads, each of which stops counting.
        tell("and more, which are left out\n");
    }
}
