//! The points that are shaded: a unit square at z = 1 that faces along z, as OSL's testshade has it.

use super::options::Options;
use crate::exec::Points;
use crate::lanes;
use glam::Vec3;

/// Fills points `first..first + len` of the grid, row by row. What is the same all over the grid is left as it is in points that have been
/// filled before.
pub fn fill(options: &Options, ray_type: i32, first: usize, len: usize, points: &mut Points) {
    if points.len != len {
        points.resize(len);
        fill_steady(options, ray_type, points);
    }
    let width = options.res[0] as usize;
    let mut lane = 0;
    while lane < len {
        let (x, y) = ((first + lane) % width, (first + lane) / width);
        let row = lane..lane + (width - x).min(len - lane);
        coordinates(Axis::of(options, 0), x as u32, &mut points.u[row.clone()]);
        let mut v = [0.0];
        coordinates(Axis::of(options, 1), y as u32, &mut v);
        points.v[row.clone()].fill(v[0]);
        lane = row.end;
    }
    points.p.x.copy_from_slice(&points.u);
    points.p.y.copy_from_slice(&points.v);
    for (lane, index) in points.index.iter_mut().enumerate() {
        *index = (first + lane) as i32;
    }
    if options.vary.contains(&true) {
        fill_varying(options, points);
    }
}

/// What is the same all over the grid.
fn fill_steady(options: &Options, ray_type: i32, points: &mut Points) {
    let [width, height] = options.res;
    let step = |axis: usize| {
        let cells = if options.center { options.res[axis] } else { options.res[axis].saturating_sub(1).max(1) };
        options.scale[axis] / cells as f32
    };
    let span = |axis: usize, cells: u32| options.scale[axis] / cells.saturating_sub(1).max(1) as f32;
    let (dx, dy) = (Vec3::new(span(0, width), 0.0, 0.0), Vec3::new(0.0, span(1, height), 0.0));
    for lane in 0..points.len {
        (points.dudx[lane], points.dudy[lane]) = (step(0), 0.0);
        (points.dvdx[lane], points.dvdy[lane]) = (0.0, step(1));
        points.p.set(lane, Vec3::Z);
        points.dpdx.set(lane, dx);
        points.dpdy.set(lane, dy);
        points.dpdu.set(lane, Vec3::X);
        points.dpdv.set(lane, Vec3::Y);
        points.n.set(lane, Vec3::Z);
        points.ng.set(lane, Vec3::Z);
        points.surface_area[lane] = 1.0;
        points.ray_type[lane] = ray_type;
    }
}

/// The derivatives of `--vary_*`.
fn fill_varying(options: &Options, points: &mut Points) {
    for lane in 0..points.len {
        let (u, v) = (points.u[lane], points.v[lane]);
        if options.vary[0] {
            points.dpdx.set(lane, Vec3::new(1.0 - u, 1.0 - v, u * 0.5));
            points.dpdy.set(lane, Vec3::new(1.0 - v, 1.0 - u, v * 0.5));
        }
        if options.vary[1] {
            (points.dudx[lane], points.dudy[lane]) = (1.0 - u, u);
        }
        if options.vary[2] {
            (points.dvdx[lane], points.dvdy[lane]) = (1.0 - v, v);
        }
    }
}

/// How places lie along u or v: at the corners of the grid from 0 to 1, or at its cells' centers.
#[derive(Clone, Copy)]
struct Axis {
    cells: u32,
    center: bool,
    scale: f32,
    offset: f32,
}

impl Axis {
    fn of(options: &Options, axis: usize) -> Self {
        let (cells, scale, offset) = (options.res[axis], options.scale[axis], options.offset[axis]);
        Axis { cells, center: options.center, scale, offset }
    }
}

lanes! {
    /// The coordinates of places from one on.
    fn coordinates(axis: Axis, first: u32, out: &mut [f32]) {
        let Axis { cells, center, scale, offset } = axis;
        for (i, out) in out.iter_mut().enumerate() {
            let at = (first + i as u32) as f32;
            *out = match (center, cells) {
                (true, _) => scale * (at + 0.5) / cells as f32 + offset,
                (false, 1) => scale * 0.5 + offset,
                (false, _) => scale * (at / (cells - 1) as f32) + offset,
            };
        }
    }
}
