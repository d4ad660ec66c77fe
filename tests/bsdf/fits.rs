//! The long albedo polynomials made anew by quadrature, and the shadowing series by its closed form.

use velour::bsdf::sheen::albedo::MIN_FITTED_ROUGHNESS;
use velour::bsdf::sheen::fits::{
    ALBEDO_ASHIKHMIN, ALBEDO_EXACT_LONG, ALBEDO_EXACT_SOFT_LONG, ALBEDO_PUBLISHED, ALBEDO_PUBLISHED_SOFT, CURVE,
    CURVE_COLUMNS, CurveFit, SERIES, SERIES_COLUMNS, SHADOWING_SERIES,
};
use velour::bsdf::sheen::reference::{self, Model};

/// Interpolates the albedo, integrated numerically, at the Chebyshev nodes of both axes.
fn fit(model: Model, soft: bool, steps: usize) -> CurveFit {
    let node = |k: usize, n: usize| (std::f64::consts::PI * (k as f64 + 0.5) / n as f64).cos();
    let rows: [[f64; CURVE_COLUMNS]; CURVE] = std::array::from_fn(|i| {
        let t = MIN_T + (1.0 - MIN_T) * 0.5 * (1.0 + node(i, CURVE));
        std::array::from_fn(|j| {
            let s = 0.5 * (1.0 + node(j, CURVE_COLUMNS));
            let r = ((1.0 - s) * f64::from(MIN_FITTED_ROUGHNESS).ln()).exp();
            reference::albedo(model, soft, t * t * t, r, steps)
        })
    });
    let along = |k: usize, m: usize, n: usize| (std::f64::consts::PI * k as f64 * (m as f64 + 0.5) / n as f64).cos();
    let share = |k: usize, n: usize| if k == 0 { 1.0 / n as f64 } else { 2.0 / n as f64 };
    std::array::from_fn(|a| {
        std::array::from_fn(|b| {
            let mut sum = 0.0;
            for (i, row) in rows.iter().enumerate() {
                for (j, value) in row.iter().enumerate() {
                    sum += value * along(a, i, CURVE) * along(b, j, CURVE_COLUMNS);
                }
            }
            (sum * share(a, CURVE) * share(b, CURVE_COLUMNS)) as f32
        })
    })
}

const MIN_T: f64 = 0.046_415_888_336_127_79;

/// Prints the constants when VELOUR_PRINT_FITS is set.
#[test]
fn constants_are_what_quadrature_gives() {
    let cases = [
        ("ALBEDO_PUBLISHED_SOFT", Model::Published, true, ALBEDO_PUBLISHED_SOFT, 24),
        ("ALBEDO_PUBLISHED", Model::Published, false, ALBEDO_PUBLISHED, 24),
        ("ALBEDO_EXACT_SOFT_LONG", Model::Exact, true, ALBEDO_EXACT_SOFT_LONG, 32),
        ("ALBEDO_EXACT_LONG", Model::Exact, false, ALBEDO_EXACT_LONG, 32),
        ("ALBEDO_ASHIKHMIN", Model::Ashikhmin, false, ALBEDO_ASHIKHMIN, 24),
    ];
    for (name, model, soft, constants, steps) in cases {
        let fitted = fit(model, soft, steps);
        if std::env::var_os("VELOUR_PRINT_FITS").is_some() {
            println!("{name} {fitted:?}");
            continue;
        }
        for (row, expected) in fitted.iter().zip(&constants) {
            for (a, b) in row.iter().zip(expected) {
                assert!((a - b).abs() < 2e-6, "{name}: {a} {b}");
            }
        }
    }
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
