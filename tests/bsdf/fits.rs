//! The albedo polynomials made anew by quadrature, and the shadowing series by its closed form.

use velour::bsdf::sheen::albedo::MIN_FITTED_ROUGHNESS;
use velour::bsdf::sheen::fits::{
    ALBEDO_ASHIKHMIN, ALBEDO_EXACT, ALBEDO_EXACT_LONG, ALBEDO_EXACT_SOFT, ALBEDO_EXACT_SOFT_LONG, ALBEDO_PUBLISHED,
    ALBEDO_PUBLISHED_SOFT, SERIES, SERIES_COLUMNS, SHADOWING_SERIES,
};
use velour::bsdf::sheen::reference::{self, Model};

/// The first coefficients of the albedo, integrated numerically at the Chebyshev nodes of both axes: the least squares on them.
fn fit(model: Model, soft: bool, rows: usize, columns: usize) -> Vec<Vec<f32>> {
    const NODES: [usize; 2] = [24, 16];
    let node = |k: usize, n: usize| (std::f64::consts::PI * (k as f64 + 0.5) / n as f64).cos();
    let mut values = vec![vec![0.0; NODES[1]]; NODES[0]];
    for (i, row) in values.iter_mut().enumerate() {
        let t = MIN_T + (1.0 - MIN_T) * 0.5 * (1.0 + node(i, NODES[0]));
        for (j, value) in row.iter_mut().enumerate() {
            let s = 0.5 * (1.0 + node(j, NODES[1]));
            let r = ((1.0 - s) * f64::from(MIN_FITTED_ROUGHNESS).ln()).exp();
            *value = reference::albedo(model, soft, t * t * t, r, 32);
        }
    }
    let along = |k: usize, m: usize, n: usize| (std::f64::consts::PI * k as f64 * (m as f64 + 0.5) / n as f64).cos();
    let share = |k: usize, n: usize| if k == 0 { 1.0 / n as f64 } else { 2.0 / n as f64 };
    let coefficient = |a: usize, b: usize| {
        let mut sum = 0.0;
        for (i, row) in values.iter().enumerate() {
            for (j, value) in row.iter().enumerate() {
                sum += value * along(a, i, NODES[0]) * along(b, j, NODES[1]);
            }
        }
        (sum * share(a, NODES[0]) * share(b, NODES[1])) as f32
    };
    (0..rows).map(|a| (0..columns).map(|b| coefficient(a, b)).collect()).collect()
}

const MIN_T: f64 = 0.046_415_888_336_127_79;

/// Holds the constants against the fit, or prints it when VELOUR_PRINT_FITS is set.
fn compare<const ROWS: usize, const COLUMNS: usize>(
    name: &str,
    model: Model,
    soft: bool,
    constants: &[[f32; COLUMNS]; ROWS],
) {
    let fitted = fit(model, soft, ROWS, COLUMNS);
    if std::env::var_os("VELOUR_PRINT_FITS").is_some() {
        println!("{name} {fitted:?}");
        return;
    }
    for (row, expected) in fitted.iter().zip(constants) {
        for (a, b) in row.iter().zip(expected) {
            assert!((a - b).abs() < 2e-6, "{name}: {a} {b}");
        }
    }
}

#[test]
fn constants_are_what_quadrature_gives() {
    compare("ALBEDO_EXACT", Model::Exact, false, &ALBEDO_EXACT);
    compare("ALBEDO_EXACT_SOFT", Model::Exact, true, &ALBEDO_EXACT_SOFT);
    compare("ALBEDO_PUBLISHED_SOFT", Model::Published, true, &ALBEDO_PUBLISHED_SOFT);
    compare("ALBEDO_PUBLISHED", Model::Published, false, &ALBEDO_PUBLISHED);
    compare("ALBEDO_EXACT_SOFT_LONG", Model::Exact, true, &ALBEDO_EXACT_SOFT_LONG);
    compare("ALBEDO_EXACT_LONG", Model::Exact, false, &ALBEDO_EXACT_LONG);
    compare("ALBEDO_ASHIKHMIN", Model::Ashikhmin, false, &ALBEDO_ASHIKHMIN);
}

#[test]
fn the_shadowing_series_interpolates_the_closed_form() {
    let node = |k: usize, n: usize| (std::f64::consts::PI * (k as f64 + 0.5) / n as f64).cos();
    let rows: [[f64; SERIES_COLUMNS]; SERIES] = std::array::from_fn(|i| {
        let v = 0.5 * (1.0 + node(i, SERIES));
        std::array::from_fn(|j| {
            let n = 100f64.powf(0.5 * (1.0 + node(j, SERIES_COLUMNS)));
            let q = 0.25 * (n - 3.5);
            let u = v / (1.0 + q - q * v);
            (reference::exact_f((1.0 - u).sqrt(), n).powi(2) - 1.0) / (u * 0.5 * n)
        })
    });
    let along = |k: usize, m: usize, n: usize| (std::f64::consts::PI * k as f64 * (m as f64 + 0.5) / n as f64).cos();
    let share = |k: usize, n: usize| if k == 0 { 1.0 / n as f64 } else { 2.0 / n as f64 };
    for (a, constants) in SHADOWING_SERIES.iter().enumerate() {
        for (b, constant) in constants.iter().enumerate() {
            let mut sum = 0.0;
            for (i, row) in rows.iter().enumerate() {
                for (j, value) in row.iter().enumerate() {
                    sum += value * along(a, i, SERIES) * along(b, j, SERIES_COLUMNS);
                }
            }
            let sum = sum * share(a, SERIES) * share(b, SERIES_COLUMNS);
            assert!((sum - f64::from(*constant)).abs() < 2e-7, "{a} {b}: {sum} {constant}");
        }
    }
}
