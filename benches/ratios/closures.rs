//! Evaluation and sampling of single lobes, and of sheen over diffuse.

use super::Table;
use super::hand::{self, Batch, Columns, N, World, at, columns, cut, directions, numbers, views};
use glam::Vec3;
use velour::bsdf::fresnel::Dielectric;
use velour::bsdf::microfacet::{Beckmann, Ggx, Microfacet};
use velour::bsdf::sheen::{EXACT, Sheen};
use velour::bsdf::{Scatter, burley, eon, lambert, oren_nayar, params, velvet};
use velour::closure::{Evaluation, Samples};
use velour::lanes;
use velour::math::columns::Column3;
use velour::math::frame::Frame;

/// Both rows of one lobe.
fn lobe<M: Scatter>(table: &Table, name: &str, closure: &str, model: M) {
    let (evaluation, sampling) = (format!("evaluate {name}"), format!("sample {name}"));
    if !table.wants(&evaluation) && !table.wants(&sampling) {
        return;
    }
    let mut batch = Batch::new(&format!("surface s() {{ Ci = {closure}; }}"));
    let (wo, wi, xi) = (batch.wo.clone(), directions(2), numbers(3));
    let world = World::new(model, &wo);
    let (mut color, mut pdf) = (Column3::zeros(N), vec![0.0; N]);
    let by_hand = |color: &mut Column3, pdf: &mut [f32]| {
        let to = [&mut color.x[..], &mut color.y[..], &mut color.z[..]];
        hand::evaluate(model, std::hint::black_box(&world), columns(&wi), to, pdf);
    };
    by_hand(&mut color, &mut pdf);
    let error = batch.differs(&wi, &color.x, &pdf);
    assert!(error < 1e-3, "the limit of {name} is another function: {error}");
    let mut out = Evaluation::default();
    table.time(
        &evaluation,
        (&mut || batch.lobes.evaluate(std::hint::black_box(&wi), &mut out), N),
        (&mut || by_hand(&mut color, &mut pdf), N),
        "<= 1.5",
    );
    let (mut samples, mut to, mut weight) = (Samples::default(), Column3::zeros(N), vec![0.0; N]);
    let frame = std::hint::black_box(Frame::from_normal(Vec3::Z));
    table.time(
        &sampling,
        (&mut || batch.lobes.sample(std::hint::black_box(&xi), &mut samples), N),
        (
            &mut || {
                let to = [&mut to.x[..], &mut to.y[..], &mut to.z[..]];
                hand::sample(model, frame, &world.view, columns(&wo), columns(&xi), to, &mut weight, &mut pdf);
            },
            N,
        ),
        "",
    );
}

lanes! {
    /// Figure 1 of the paper as one loop: sheen over Lambert, layering `min`, one frame and one roughness.
    fn cloth(
        sheen: Sheen<EXACT, true>,
        view: &[Vec<f32>; 5],
        alpha_o: &[f32],
        wo: Columns<'_>,
        wi: Columns<'_>,
        f_cos: &mut [f32],
        pdf: &mut [f32],
    ) {
        let n = f_cos.len();
        let (alpha_o, wo, wi, pdf) = (&alpha_o[..n], cut(wo, n), cut(wi, n), &mut pdf[..n]);
        let (a, b, c, d, e) = (&view[0][..n], &view[1][..n], &view[2][..n], &view[3][..n], &view[4][..n]);
        for i in 0..n {
            let (o, l) = (at(wo, i), at(wi, i));
            let value = sheen.eval_from(o, [a[i], b[i], c[i], d[i], e[i]], l);
            let alpha_i = 1.0 - 0.8 * sheen.albedo(l.z);
            let diffuse = l.z.max(0.0) * std::f32::consts::FRAC_1_PI;
            f_cos[i] = 0.8 * value.f_cos + diffuse * alpha_i.min(alpha_o[i]);
            pdf[i] = 0.3 * value.pdf + 0.7 * diffuse;
        }
    }
}

fn layered(table: &Table) {
    let mut batch = Batch::new("surface s() { Ci = sheen(diffuse(N), N, color(0.8), 0.3); }");
    let sheen = Sheen::<EXACT, true>::prepare(params([0.3]));
    let (wo, wi) = (batch.wo.clone(), directions(2));
    let view = views(sheen, &wo);
    let alpha_o: Vec<f32> = wo.z.iter().map(|&c| 1.0 - 0.8 * sheen.albedo(c)).collect();
    let (mut f_cos, mut pdf) = (vec![0.0; N], vec![0.0; N]);
    let mut out = Evaluation::default();
    batch.lobes.evaluate(&wi, &mut out);
    cloth(sheen, &view, &alpha_o, columns(&wo), columns(&wi), &mut f_cos, &mut pdf);
    assert!(
        out.f_cos.x.iter().zip(&f_cos).all(|(a, b)| (a - b).abs() < 1e-4),
        "the limit of cloth is another function"
    );
    table.time(
        "evaluate sheen over diffuse",
        (&mut || batch.lobes.evaluate(std::hint::black_box(&wi), &mut out), N),
        (&mut || cloth(sheen, &view, &alpha_o, columns(&wo), columns(&wi), &mut f_cos, &mut pdf), N),
        "<= 1.5",
    );
}

/// Prints the rows.
pub fn rows(table: &Table) {
    table.head("closures", "by hand");
    layered(table);
    lobe(table, "diffuse", "diffuse(N)", lambert::Lambert::prepare(params([])));
    lobe(table, "oren_nayar", "oren_nayar(N, 0.4)", oren_nayar::OrenNayar::prepare(params([0.4])));
    lobe(table, "burley", "burley_diffuse_bsdf(N, color(1), 0.4)", burley::Burley::prepare(params([0.4])));
    let eon = eon::Eon::prepare(params([0.4, 1.0, 1.0, 1.0]));
    lobe(table, "eon", "oren_nayar_diffuse_bsdf(N, color(1), 0.4, \"energy_compensation\", 1)", eon);
    lobe(table, "velvet", "ashikhmin_velvet(N, 0.4)", velvet::form_2000::Velvet2000::prepare(params([0.4])));
    let of_2007 = velvet::Velvet::prepare(params([0.4]));
    lobe(table, "velvet of 2007", "ashikhmin_velvet(N, 0.4, \"form\", \"2007\")", of_2007);
    lobe(table, "sheen", "sheen_bsdf(N, color(1), 0.3)", Sheen::<EXACT, true>::prepare(params([0.3])));
    let widths = params([0.3, 0.3, 1.5]);
    let ggx = Microfacet::<Ggx, Dielectric, false>::prepare(widths);
    lobe(table, "ggx", "microfacet(\"ggx\", N, N, 0.3, 0.3, 1.5, 0)", ggx);
    let beckmann = Microfacet::<Beckmann, Dielectric, false>::prepare(widths);
    lobe(table, "beckmann", "microfacet(\"beckmann\", N, N, 0.3, 0.3, 1.5, 0)", beckmann);
}
