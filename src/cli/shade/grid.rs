//! The points that are shaded: a unit square at z = 1 that faces along z, as OSL's testshade has it.

use super::options::Options;
use crate::exec::Points;
use glam::Vec3;

/// Fills points `first..first + len` of the grid, row by row.
pub fn fill(options: &Options, ray_type: i32, first: usize, len: usize, points: &mut Points) {
    points.resize(len);
    let [width, height] = options.res;
    for lane in 0..len {
        let at = first + lane;
        let place = [(at % width as usize) as u32, (at / width as usize) as u32];
        let [u, v] = std::array::from_fn(|axis| coordinate(options, axis, place[axis]));
        let step = |axis: usize| {
            let cells = if options.center { options.res[axis] } else { options.res[axis].saturating_sub(1).max(1) };
            options.scale[axis] / cells as f32
        };
        let span = |axis: usize, cells: u32| options.scale[axis] / cells.saturating_sub(1).max(1) as f32;
        (points.u[lane], points.v[lane]) = (u, v);
        (points.dudx[lane], points.dudy[lane]) = if options.vary[1] { (1.0 - u, u) } else { (step(0), 0.0) };
        (points.dvdx[lane], points.dvdy[lane]) = if options.vary[2] { (1.0 - v, v) } else { (0.0, step(1)) };
        points.p.set(lane, Vec3::new(u, v, 1.0));
        let [dx, dy] = if options.vary[0] {
            [Vec3::new(1.0 - u, 1.0 - v, u * 0.5), Vec3::new(1.0 - v, 1.0 - u, v * 0.5)]
        } else {
            [Vec3::new(span(0, width), 0.0, 0.0), Vec3::new(0.0, span(1, height), 0.0)]
        };
        points.dpdx.set(lane, dx);
        points.dpdy.set(lane, dy);
        points.dpdu.set(lane, Vec3::X);
        points.dpdv.set(lane, Vec3::Y);
        points.n.set(lane, Vec3::Z);
        points.ng.set(lane, Vec3::Z);
        points.surface_area[lane] = 1.0;
        points.ray_type[lane] = ray_type;
        points.index[lane] = at as i32;
    }
}

/// u or v: at the corners of the grid from 0 to 1, or at its cells' centers.
fn coordinate(options: &Options, axis: usize, at: u32) -> f32 {
    let (cells, scale, offset) = (options.res[axis], options.scale[axis], options.offset[axis]);
    if options.center {
        return scale * (at as f32 + 0.5) / cells as f32 + offset;
    }
    let place = if cells == 1 { 0.5 } else { at as f32 / (cells - 1) as f32 };
    scale * place + offset
}
