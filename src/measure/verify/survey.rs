//! A survey of a shader: thousands of places, views, kinds of rays and footprints at once, each sampled a little, to find those
//! that deserve a closer look.
//!
//! A shader that gains light on a checkerboard, in a thin band of u or of the view, or for one kind of ray only, looks right from
//! nine places and eleven cosines. Here each lane of a batch has a place of its own on a sequence that fills all of them evenly;
//! what seems to send out more than arrives, or is no number, becomes a variant that the laws are applied to in full.

use super::direction::View;
use super::tree::Spot;
use crate::closure::{Lobes, Samples, Settings};
use crate::exec::{Group, MAX_LANES, Machine, Points, Report};
use crate::math::columns::Column3;
use glam::Vec3;

/// Samples a place.
const ROUNDS: usize = 64;
/// A mean weight beyond 1 by this and by so many of its standard errors is looked at again.
const EXCESS: f64 = 2e-3;
const ERRORS: f64 = 3.5;
/// How many places of one group are looked at again.
const MOST: usize = 3;
/// The kinds of rays, those that scatter more often first.
const RAY_TYPES: [i32; 6] = [1, 4, 8, 16, 32, 2];
/// Footprints of a pixel on the surface.
const WIDTHS: [f32; 3] = [0.0, 1e-3, 0.05];

/// A place and view that something seems wrong at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Suspect {
    /// Where.
    pub spot: Spot,
    /// From where.
    pub view: View,
    /// By how much it seems to gain; infinite when something is no number.
    pub excess: f64,
}

/// The `index`-th place and view of a sequence that fills all of them evenly.
///
/// Source: the additive recurrence of Roberts 2018, in four dimensions.
fn place(index: usize) -> (Spot, View) {
    // The powers of the inverse of the root of x^5 = x + 1.
    const STEPS: [f64; 4] =
        [0.856_674_883_854_502_9, 0.733_891_856_627_126_1, 0.628_706_722_147_405_6, 0.538_597_256_998_356_6];
    let [u, v, c, azimuth] = STEPS.map(|step| (0.5 + index as f64 * step).fract());
    // Every eighth view lies near the horizon.
    let cos = if index % 8 == 7 { c * c * c } else { c };
    let spot = Spot {
        uv: [u as f32, v as f32],
        back: index % 5 == 4,
        ray_type: if index.is_multiple_of(3) { RAY_TYPES[index / 3 % RAY_TYPES.len()] } else { 1 },
        width: WIDTHS[index / 2 % WIDTHS.len()],
    };
    (spot, View { cos: cos.max(1e-4), azimuth: azimuth * std::f64::consts::TAU })
}

/// Why a group cannot be run, if that shows at the first places and views.
pub fn cannot_run(group: &Group) -> Option<Report> {
    let (mut machine, mut points) = (Machine::new(), Points::new(MAX_LANES));
    for lane in 0..MAX_LANES {
        let (spot, view) = place(lane);
        spot.point(view.wo(), &mut points, lane);
    }
    machine.shade(group, &points);
    machine.take_reports().into_iter().find(Report::is_fatal)
}

/// What a batch of places has sent out.
struct Sums {
    sum: Vec<[f64; 3]>,
    squares: Vec<[f64; 3]>,
}

/// Looks at so many places of a group; gives the worst that seem to gain, and the first that is no number.
pub fn survey(group: &Group, settings: Settings, places: usize) -> Vec<Suspect> {
    if !group.can_scatter() {
        return Vec::new();
    }
    let (mut machine, mut lobes) = (Machine::new(), Lobes::new(settings));
    let (mut points, mut wo) = (Points::default(), Column3::default());
    let (mut gaining, mut broken) = (Vec::new(), None);
    for first in (0..places).step_by(MAX_LANES) {
        let here: Vec<(Spot, View)> = (first..places.min(first + MAX_LANES)).map(place).collect();
        points.resize(here.len());
        wo.resize(here.len());
        for (lane, (spot, view)) in here.iter().enumerate() {
            wo.set(lane, view.wo());
            spot.point(view.wo(), &mut points, lane);
        }
        let tree = machine.shade(group, &points);
        lobes.flatten_sides(group.library(), tree, &wo, &points.ng, &points.backfacing);
        let wrong = lobes.dropped().iter().map(|dropped| dropped.lane as usize).next();
        let reports = machine.take_reports();
        let fatal = reports.iter().any(Report::is_fatal);
        let reported = reports.into_iter().find(Report::is_wrong);
        if let (Some(lane), None) = (wrong.or(reported.map(|report| report.lane)), broken) {
            broken = here.get(lane).map(|&(spot, view)| Suspect { spot, view, excess: f64::INFINITY });
        }
        if fatal {
            break;
        }
        let sums = sample(&mut lobes, here.len());
        for (lane, &(spot, view)) in here.iter().enumerate() {
            let excess = sums.excess(lane);
            if excess > 0.0 {
                gaining.push(Suspect { spot, view, excess });
            }
        }
    }
    gaining.sort_by(|a, b| b.excess.total_cmp(&a.excess));
    gaining.truncate(MOST);
    let middle = |suspect: Suspect| Suspect { spot: Spot::MIDDLE, ..suspect };
    if let Some(worst) = gaining.first().map(|&worst| middle(worst)) {
        // What gains everywhere is told of the middle alone.
        points.resize(1);
        worst.spot.point(worst.view.wo(), &mut points, 0);
        let tree = machine.shade(group, &points);
        let wo = Column3::splat(worst.view.wo(), 1);
        lobes.flatten_sides(group.library(), tree, &wo, &points.ng, &points.backfacing);
        if sample(&mut lobes, 1).excess(0) > 0.0 {
            gaining = vec![worst];
        }
    }
    gaining.extend(broken);
    gaining
}

/// Samples every lane of a batch.
fn sample(lobes: &mut Lobes, lanes: usize) -> Sums {
    let mut out = Sums { sum: vec![[0.0; 3]; lanes], squares: vec![[0.0; 3]; lanes] };
    let (mut xi, mut samples) = (Column3::zeros(lanes), Samples::default());
    for round in 0..ROUNDS {
        for lane in 0..lanes {
            // The same even sequence in every lane, shifted by another amount.
            let at = |step: f64, shift: f64| {
                ((0.5 + round as f64 * step + lane as f64 * shift).fract() as f32).min(0.999_999_94)
            };
            let numbers = [(0.819_172_5, 0.618_034), (0.671_043_6, 0.414_213_6), (0.549_700_5, 0.732_050_8)];
            xi.set(lane, Vec3::from_array(numbers.map(|(step, shift)| at(step, shift))));
        }
        lobes.sample(&xi, &mut samples);
        for lane in 0..lanes {
            for (c, weight) in samples.weight.get(lane).to_array().into_iter().enumerate() {
                let weight = f64::from(weight);
                out.sum[lane][c] += weight;
                out.squares[lane][c] += weight * weight;
            }
        }
    }
    out
}

impl Sums {
    /// By how much a lane's mean weight is surely beyond 1, in the component where it is most so; negative when it is not.
    fn excess(&self, lane: usize) -> f64 {
        let n = ROUNDS as f64;
        let of = |c: usize| {
            let mean = self.sum[lane][c] / n;
            let error = ((self.squares[lane][c] / n - mean * mean).max(0.0) / n).sqrt();
            mean - 1.0 - EXCESS - ERRORS * error
        };
        of(0).max(of(1)).max(of(2))
    }
}
