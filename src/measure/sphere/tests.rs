//! Lobes and steps whose integrals are known.

use super::*;

/// A lobe of a width around an axis, normalised on the sphere, cut off below the plane of a normal.
fn lobe(axis: Vec3, width: f64, normal: Vec3) -> impl Fn(Vec3) -> f64 {
    move |w| {
        let d = f64::from((w - axis).length_squared()) / (width * width);
        if w.dot(normal) > 0.0 {
            (-d).exp() / (PI * width * width * (1.0 - (-4.0 / (width * width)).exp()))
        } else {
            0.0
        }
    }
}

/// The direction of a height and an azimuth.
fn polar(z: f64, phi: f64) -> Vec3 {
    let sin = (1.0 - z * z).sqrt();
    Vec3::new((sin * phi.cos()) as f32, (sin * phi.sin()) as f32, z as f32)
}

#[test]
fn narrow_lobes_and_steps_are_integrated() {
    let wo = Vec3::new(0.6, 0.0, 0.8);
    for (axis, width) in [(Vec3::new(-0.6, 0.0, 0.8), 0.02), (Vec3::Z, 0.002), (Vec3::new(0.28, 0.96, 0.0), 0.3)] {
        // A plane through the axis halves the lobe, whatever its width.
        let normal = axis.cross(Vec3::new(0.1, 0.2, 0.9)).normalize();
        for (cut, expected) in [(axis, 1.0), (normal, 0.5)] {
            let f = lobe(axis, width, cut);
            let mut random = Random(7);
            // Scouts reach as far as the samples of such a lobe.
            let near: Vec<Vec3> = (0..2000)
                .map(|_| {
                    let mut offset = || (random.number() - 0.5) * 6.0 * width as f32;
                    (axis + Vec3::new(offset(), offset(), offset())).normalize()
                })
                .collect();
            let cells = Cells::new(Chart::new(wo), near.into_iter().map(|w| (w, f(w))), 100, &mut Random(8));
            let integrals = cells.integrate([2e-5; 4], 400_000, |w, out| {
                for (lane, out) in out.iter_mut().enumerate() {
                    *out = [f(w.get(lane)); 4];
                }
            });
            let (total, error) = (integrals.total()[0], integrals.error[0]);
            assert!((total - expected).abs() < 2e-3_f64.min(error + 1e-4), "{axis} {width}: {total} +- {error}");
        }
    }
}

#[test]
fn a_step_at_one_height_is_found() {
    // It brightens up to the height of -0.5, where it ends; its swaying around the axis adds nothing.
    let lobe = |w: Vec3| {
        let sway = 1.0 + 0.3 * (3.0 * f64::from(w.y).atan2(f64::from(w.x))).cos();
        if w.z < -0.5 { sway * (4.0 * (f64::from(w.z) + 0.5)).exp() } else { 0.0 }
    };
    let expected = 2.0 * PI * (1.0 - (-2.0f64).exp()) / 4.0;
    for seed in 0..40 {
        let mut random = Random(seed);
        let scouts: Vec<Vec3> = (0..4096)
            .map(|_| {
                let z = -0.5 + (1.0 - f64::from(random.number()) * (1.0 - (-2.0f64).exp())).ln() / 4.0;
                polar(z, 2.0 * PI * f64::from(random.number()))
            })
            .collect();
        let wo = Vec3::new(0.661_437_8, 0.0, 0.75);
        let cells = Cells::new(Chart::new(wo), scouts.into_iter().map(|w| (w, lobe(w))), 256, &mut random);
        let integrals = cells.integrate([1e-6; 4], 4_000_000, |w, out| {
            for (lane, out) in out.iter_mut().enumerate() {
                *out = [lobe(w.get(lane)); 4];
            }
        });
        let (total, error) = (integrals.total()[0], integrals.error[0]);
        assert!((total - expected).abs() < error + 1e-5, "{seed}: {total}, not {expected} +- {error}");
        assert!(integrals.directions < 100_000, "{seed}: {}", integrals.directions);
    }
}

#[test]
fn samples_next_to_a_step_do_not_hide_it() {
    let step = |w: Vec3| if w.z < -0.5 { 1.0 } else { 0.0 };
    for seed in 0..20 {
        let mut random = Random(seed);
        let mut near = || polar(-0.5 - 2e-4 * f64::from(random.number()), 6.0 * f64::from(random.number()));
        let scouts: Vec<Vec3> = (0..64).map(|_| near()).collect();
        let chart = Chart::new(Vec3::new(0.661_437_8, 0.0, 0.75));
        let cells = Cells::new(chart, scouts.into_iter().map(|w| (w, step(w))), 1, &mut Random(seed));
        let total = cells.integrate([1e-6; 4], 400_000, |w, out| {
            for (lane, out) in out.iter_mut().enumerate() {
                *out = [step(w.get(lane)); 4];
            }
        });
        assert!((total.total()[0] - PI).abs() < 0.01, "{seed}: {}", total.total()[0]);
    }
}

#[test]
fn the_whole_sphere_is_covered_once() {
    let chart = Chart::new(Vec3::new(0.3, -0.4, 0.866));
    let cells = Cells::new(chart, [(Vec3::Z, 0.0); 64].into_iter(), 8, &mut Random(3));
    let sphere = cells.integrate([1e-3; 4], 0, |_, out| out.fill([1.0; 4])).total()[0];
    assert!((sphere - 4.0 * PI).abs() < 1e-12, "{sphere}");
}
