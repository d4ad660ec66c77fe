//! Textures from text to number: what shaders get of them, against closed forms, brute force, and files of every kind.

use std::sync::Arc;
use velour::compile::compile;
use velour::exec::{Host, Machine, Points, Values};
use velour::texture::{Interpolation, Level, Lookup, Texels, Texture, Wrap, values};

/// A texture whose texel at the middle of (s, t) is `f(s, t)`.
fn painted(width: usize, height: usize, channels: usize, f: impl Fn(f32, f32, usize) -> f32) -> Texture {
    let at = |i: usize, n: usize| (i as f32 + 0.5) / n as f32;
    let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let rows = rows.flat_map(|(x, y)| (0..channels).map(move |c| (x, y, c)));
    let values = rows.map(|(x, y, c)| f(at(x, width), at(y, height), c)).collect();
    Texture::of_rows(width, height, channels, &Texels::Floats(values))
}

fn clamped() -> Lookup {
    Lookup { wrap: [Some(Wrap::Clamp); 2], ..Lookup::default() }
}

#[test]
fn a_constant_is_a_constant_to_the_last_bit() {
    let texture = painted(37, 19, 3, |_, _, c| [0.1, 0.7, 1.0 / 3.0][c]);
    for i in 0..500 {
        let (s, t) = ((i * 37 % 101) as f32 / 100.0, (i * 53 % 97) as f32 / 96.0);
        let long = 2.0f32.powi(i % 12 - 10);
        for slopes in [[0.0; 4], [long, 0.0, 0.0, 0.01], [long, long, -long * 0.1, long * 0.1]] {
            for interpolation in
                [Interpolation::Closest, Interpolation::Linear, Interpolation::Cubic, Interpolation::Smart]
            {
                let sample = texture.lookup(s, t, slopes, &Lookup { interpolation, ..clamped() });
                assert_eq!(sample.value[..3], [0.1, 0.7, 1.0 / 3.0], "{s} {t} {slopes:?} {interpolation:?}");
                assert_eq!((sample.ds[0], sample.dt[1]), (0.0, 0.0));
            }
        }
    }
}

#[test]
fn a_ramp_is_its_coordinate_and_its_slopes_are_one() {
    let texture = painted(64, 64, 2, |s, t, c| if c == 0 { s } else { t });
    for interpolation in [Interpolation::Linear, Interpolation::Cubic] {
        for i in 0..200 {
            let (s, t) = (0.1 + 0.8 * (i * 37 % 101) as f32 / 101.0, 0.1 + 0.8 * (i * 53 % 97) as f32 / 97.0);
            let sample = texture.lookup(s, t, [0.0; 4], &Lookup { interpolation, ..clamped() });
            assert!(
                (sample.value[0] - s).abs() < 1e-6 && (sample.value[1] - t).abs() < 1e-6,
                "{s} {t} {:?}",
                sample.value
            );
            assert!((sample.ds[0] - 1.0).abs() < 1e-4 && sample.ds[1].abs() < 1e-4, "{:?}", sample.ds);
            assert!((sample.dt[1] - 1.0).abs() < 1e-4 && sample.dt[0].abs() < 1e-4, "{:?}", sample.dt);
        }
    }
}

#[test]
fn columns_are_looked_up_as_single_places_are() {
    // Neither multiples of a block of texels, nor of the places that are worked out together.
    const N: usize = 61;
    let number = |i: usize, k: usize| ((i * 7919 + k * 104_729) % 1009) as f32 / 1009.0;
    for (case, wrap) in [Wrap::Black, Wrap::Clamp, Wrap::Periodic, Wrap::Mirror].into_iter().enumerate() {
        let texture = painted(45, 19, 3, |s, t, c| (s * 7.0 + t * 3.0 + c as f32).sin());
        for interpolation in [Interpolation::Closest, Interpolation::Linear, Interpolation::Cubic, Interpolation::Smart]
        {
            // Points, one ellipse for all, and one for each of them, short and long.
            for (length, count) in [(0.0, 1), (0.3, 1), (0.05, N), (0.6, N)] {
                let how = Lookup { interpolation, wrap: [Some(wrap); 2], fill: 0.5, ..Lookup::default() };
                let place = |i: usize, k: usize| if i == 17 { f32::NAN } else { 3.0 * number(i, k + case) - 1.0 };
                let slope = |i: usize, k: usize| length * number(i, k) * number(i + 1, k);
                let columns: [Vec<f32>; 6] = std::array::from_fn(|k| match k {
                    0 | 1 => (0..N).map(|i| place(i, k)).collect(),
                    _ => (0..count).map(|i| slope(i, k)).collect(),
                });
                let lit: Vec<i32> = (0..N).map(|i| i32::from(i % 5 != 3)).collect();
                let mut out = vec![vec![7.0; N]; 4];
                values(&texture, &columns.each_ref().map(|column| &column[..]), &how, &lit, &mut out);
                for i in 0..N {
                    let at = |k: usize| columns[k][i.min(columns[k].len() - 1)];
                    let one = texture.value(at(0), at(1), [at(2), at(3), at(4), at(5)], &how);
                    let wanted = if lit[i] == 0 { [7.0; 4] } else { one };
                    let got = [out[0][i], out[1][i], out[2][i], out[3][i]];
                    assert_eq!(
                        got.map(f32::to_bits),
                        wanted.map(f32::to_bits),
                        "{wrap:?} {interpolation:?} {length} {i}"
                    );
                }
            }
        }
    }
}

/// The contrast that look-ups with these slopes leave of stripes.
fn contrast(texture: &Texture, slopes: [f32; 4], how: &Lookup) -> f32 {
    let values = (0..400).map(|i| texture.lookup(0.3 + i as f32 * 1e-3, 0.5, slopes, how).value[0]);
    let (low, high) = values.fold((f32::MAX, f32::MIN), |(low, high), v| (low.min(v), high.max(v)));
    high - low
}

#[test]
fn stripes_along_a_long_ellipse_keep_their_contrast() {
    let turns = std::f32::consts::TAU * 32.0;
    let texture = painted(512, 512, 1, |s, _, _| 0.5 + 0.5 * (turns * s).cos());
    // Sixteen texels long along the stripes, one across.
    let along = [1.0 / 512.0, 0.0, 0.0, 16.0 / 512.0];
    let round = [16.0 / 512.0, 0.0, 0.0, 16.0 / 512.0];
    let (kept, control) = (contrast(&texture, along, &clamped()), contrast(&texture, round, &clamped()));
    assert!(kept > 0.9, "{kept}");
    assert!(control < 0.05, "{control}");
}

/// The mean under a Gaussian over the ellipse of a pixel, texel by texel in f64; its width is that of a bilinear hat over the half axes.
fn brute(texture: &Texture, s: f32, t: f32, [dsdx, dtdx, dsdy, dtdy]: [f32; 4]) -> f64 {
    let [w, h] = texture.size();
    let (a, b, c, d) = (f64::from(dsdx), f64::from(dsdy), f64::from(dtdx), f64::from(dtdy));
    let det = a * d - b * c;
    let (mut sum, mut total) = (0.0, 0.0);
    for y in 0..h {
        for x in 0..w {
            let (u, v) = ((x as f64 + 0.5) / w as f64 - f64::from(s), (y as f64 + 0.5) / h as f64 - f64::from(t));
            let (p, q) = ((d * u - b * v) / det, (a * v - c * u) / det);
            let weight = (-0.5 * (p * p + q * q) / 0.2).exp();
            let mut texel = [0.0; 4];
            texture.level(0).read(x, y, 0, &mut texel);
            sum += weight * f64::from(texel[0]);
            total += weight;
        }
    }
    sum / total
}

#[test]
fn oblique_ellipses_are_filtered_as_brute_force_filters_them() {
    let texture = painted(128, 128, 1, |s, t, _| {
        let checks = ((s * 16.0).floor() + (t * 16.0).floor()) as i32 % 2;
        if checks == 0 { 0.2 } else { 0.8 }
    });
    let (mut error, mut control, mut count) = (0.0, 0.0, 0);
    for i in 0..120 {
        let (s, t) = (0.3 + 0.4 * (i * 37 % 101) as f32 / 101.0, 0.3 + 0.4 * (i * 53 % 97) as f32 / 97.0);
        let (sin, cos) = (i as f32 * 0.7).sin_cos();
        let (long, short) = (0.06, 0.012);
        let slopes = [long * cos, long * sin, -short * sin, short * cos];
        let truth = brute(&texture, s, t, slopes);
        let of = |slopes| f64::from(texture.lookup(s, t, slopes, &clamped()).value[0]);
        error += (of(slopes) - truth).powi(2);
        // One probe that covers the long axis, as trilinear filtering takes it.
        control += (of([long, 0.0, 0.0, long]) - truth).powi(2);
        count += 1;
    }
    let rms = |sum: f64| (sum / f64::from(count)).sqrt();
    assert!(rms(error) < 0.02, "{}", rms(error));
    assert!(rms(control) > 3.0 * rms(error), "{} {}", rms(control), rms(error));
}

#[test]
fn a_small_footprint_touches_only_the_levels_it_needs() {
    let texture = painted(1024, 1024, 1, |s, t, _| s * t);
    assert_eq!(texture.resident().0, 1);
    texture.lookup(0.5, 0.5, [1.0 / 1024.0, 0.0, 0.0, 1.0 / 1024.0], &clamped());
    assert_eq!(texture.resident().0, 1, "a pixel of one texel reads the finest level alone");
    texture.lookup(0.5, 0.5, [4.0 / 1024.0, 0.0, 0.0, 4.0 / 1024.0], &clamped());
    assert_eq!(texture.resident().0, 3);
}

/// A host of one texture under the name "t", which is 2 wide and 1 high: red and alpha of .25, then green and alpha of 1.
struct OneTexture;

impl Host for OneTexture {
    fn texture(&self, name: &str) -> Result<Arc<Texture>, String> {
        let rows = Texels::Floats(vec![1.0, 0.0, 0.0, 0.25, 0.0, 1.0, 0.0, 1.0]);
        let level = Level::of_rows(2, 1, 4, &rows);
        match name {
            "t" | "t1001" => Ok(Arc::new(Texture::of_levels(vec![level], 4))),
            _ => Err(format!("no {name}")),
        }
    }
}

/// What a body prints at (u, v), and what goes wrong.
fn printed(body: &str, uv: [f32; 2]) -> String {
    let shader = compile(&format!("shader s(output color c = 0) {{ {body} }}")).unwrap();
    let group = shader.group().keep_outputs().build().unwrap();
    let mut machine = Machine::with_host(Arc::new(OneTexture));
    let mut points = Points::new(1);
    (points.u[0], points.v[0]) = (uv[0], uv[1]);
    (points.dudx[0], points.dvdy[0]) = (0.5, 0.5);
    machine.shade(&group, &points);
    assert!(matches!(machine.output(&group, "c").map(|c| c.lane(0)), Some(Values::Floats(_))));
    machine.take_reports().iter().map(|report| format!("{}|", report.text.trim_end())).collect()
}

#[test]
fn options_of_texture_mean_what_they_say() {
    for (body, text) in [
        (r#"color k = texture("t", .25, .5, 0, 0, 0, 0, "interp", "closest"); printf("%g", k);"#, "1 0 0|"),
        (
            r#"float a; color k = texture("t", .25, .5, 0,0,0,0, "interp", "closest", "alpha", a); printf("%g", a);"#,
            "0.25|",
        ),
        (r#"float k = texture("t", .75, .5, 0,0,0,0, "interp", "closest", "firstchannel", 1); printf("%g", k);"#, "1|"),
        (
            r#"float k = texture("t", 1.75, .5, 0,0,0,0, "interp", "closest", "firstchannel", 1, "swrap", "periodic"); printf("%g", k);"#,
            "1|",
        ),
        (r#"color k = texture("t", 1.75, .5, 0,0,0,0, "interp", "closest"); printf("%g", k);"#, "0 0 0|"),
        (
            r#"color k = texture("t", .75, .5, 0,0,0,0, "firstchannel", 2, "fill", .5, "interp", "closest"); printf("%g", k);"#,
            "0 1 0.5|",
        ),
        (
            r#"color k = texture("t", .5, .5, 0,0,0,0, "interp", "linear", "wrap", "clamp"); printf("%g", k);"#,
            "0.5 0.5 0|",
        ),
        (r#"color k = texture("gone", u, v, "missingcolor", color(1,2,3)); printf("%g", k);"#, "1 2 3|"),
        (
            r#"float a; float k = texture("gone", u, v, "missingalpha", .5, "alpha", a); printf("%g %g", k, a);"#,
            "0 0.5|",
        ),
        (r#"string e; float k = texture("gone", u, v, "errormessage", e); printf("%g %s", k, e);"#, "0 no gone|"),
        (r#"float k = texture("gone", u, v); printf("%g", k);"#, "no gone|0|"),
        (r#"float k = texture("t<UDIM>", .25, .5, 0,0,0,0, "interp", "closest"); printf("%g", k);"#, "1|"),
        (r#"int n; printf("%d %d", gettextureinfo("t", "channels", n), n);"#, "1 4|"),
        (r#"int r[2]; gettextureinfo("t", "resolution", r); printf("%d %d", r[0], r[1]);"#, "2 1|"),
        (r#"int e = 7; printf("%d %d", gettextureinfo("gone", "exists", e), e);"#, "1 0|"),
        (r#"int e = 7; printf("%d %d", gettextureinfo("gone", "channels", e), e);"#, "no gone|0 7|"),
    ] {
        assert_eq!(printed(body, [0.5, 0.5]), text, "{body}");
    }
}

#[test]
fn results_change_with_what_their_coordinates_do() {
    // Along s the red falls from 1 to 0 between the texels, by 2 a unit of s; u moves by a half a pixel.
    let body = r#"color k = texture("t", u, v, 0, 0, 0, 0, "interp", "linear", "wrap", "clamp"); printf("%g %g", Dx(k), Dy(k));"#;
    assert_eq!(printed(body, [0.5, 0.5]), "0 0 0 0 0 0|", "given slopes of zero are the derivatives");
    let body =
        r#"color k = texture("t", u * .1 + .45, v, "interp", "linear", "wrap", "clamp"); printf("%.3g", Dx(k));"#;
    assert_eq!(printed(body, [0.5, 0.5]), "-0.1 0.1 0|");
}

/// An uncompressed TIFF of bytes, by its tags beside the usual ones: number and value.
fn tiff(width: u32, height: u32, channels: u32, more: &[(u16, u32)], bytes: &[u8]) -> Vec<u8> {
    let mut tags = vec![
        (256, width),
        (257, height),
        (258, 8),
        (259, 1),
        (262, if channels == 3 { 2 } else { 1 }),
        (277, channels),
    ];
    let planar = more.contains(&(284, 2));
    tags.extend_from_slice(more);
    let planes = if planar { channels } else { 1 };
    let (counts, start) = (planes as usize, 8 + 2 + 12 * (tags.len() as u32 + 3) + 4);
    let data = start + if counts > 1 { 8 * planes } else { 0 };
    let each = bytes.len() as u32 / planes;
    tags.extend([
        (273, if counts > 1 { start } else { data }),
        (278, height),
        (279, if counts > 1 { start + 4 * planes } else { each }),
    ]);
    tags.sort_unstable();
    let mut out = b"II*\0\x08\0\0\0".to_vec();
    out.extend((tags.len() as u16).to_le_bytes());
    for (tag, value) in tags {
        let count = if matches!(tag, 273 | 279) { planes } else { 1 };
        out.extend(tag.to_le_bytes().into_iter().chain(4u16.to_le_bytes()));
        out.extend(count.to_le_bytes().into_iter().chain(value.to_le_bytes()));
    }
    out.extend([0; 4]);
    if counts > 1 {
        (0..planes).for_each(|plane| out.extend((data + plane * each).to_le_bytes()));
        (0..planes).for_each(|_| out.extend(each.to_le_bytes()));
    }
    out.extend(bytes);
    out
}

fn read_back(name: &str, bytes: &[u8]) -> Result<Texture, velour::texture::TextureError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    velour::texture::read(&path, 1 << 30)
}

#[test]
fn planes_of_a_tiff_are_its_channels() {
    let (width, height) = (5u32, 3u32);
    let number = |x: u32, y: u32, c: u32| (40 * c + 7 * y + x) as u8;
    let cells = || (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)));
    for channels in [1, 2, 3, 4, 6] {
        let planes: Vec<u8> = (0..channels).flat_map(|c| cells().map(move |(x, y)| number(x, y, c))).collect();
        let woven: Vec<u8> = cells().flat_map(|(x, y)| (0..channels).map(move |c| number(x, y, c))).collect();
        for (planar, bytes) in [(2, &planes), (1, &woven)] {
            let texture = read_back("t.tif", &tiff(width, height, channels, &[(284, planar)], bytes)).unwrap();
            assert_eq!(texture.channels(), channels as usize, "{planar}");
            for (x, y) in cells() {
                for first in 0..channels {
                    let how = Lookup { interpolation: Interpolation::Closest, first, ..clamped() };
                    let (s, t) = ((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
                    let value = texture.value(s, t, [0.0; 4], &how)[0];
                    assert_eq!(value, f32::from(number(x, y, first)) / 255.0, "{channels} {planar} {x} {y} {first}");
                }
            }
        }
    }
}

#[test]
fn what_a_decoder_would_misread_is_refused() {
    let wide = read_back("t.tif", &tiff(2, 2, 6, &[(284, 1), (317, 2)], &[7; 24]));
    assert!(wide.unwrap_err().to_string().contains("a predictor over 6 channels"));
    let mut bits = tiff(8, 1, 1, &[], &[0x5a]);
    let at = bits.windows(2).position(|tag| tag == 258u16.to_le_bytes()).unwrap();
    bits[at + 8] = 1;
    assert!(read_back("t.tif", &bits).unwrap_err().to_string().contains("1 bits a channel"));
    // A small file that says it is large.
    for samples in [4, 4000] {
        let large = read_back("t.tif", &tiff(30_000, 30_000, samples, &[(284, 1)], &[0]));
        assert!(large.unwrap_err().to_string().contains("MB, and textures may have"), "{samples}");
    }
}

/// A file may go on after its picture with what is no level of it: a mask of bits, or another picture.
#[test]
fn pages_that_are_no_level_do_not_spoil_a_file() {
    for (side, bits) in [(4u32, 1u8), (4, 8), (2, 1), (30_000, 1)] {
        let mut pages = tiff(4, 4, 1, &[], &[7; 16]);
        let (start, mut more) = (pages.len() as u32, tiff(side, side, 1, &[], &[9; 16]));
        // The first page leads to the second, whose data lies further on.
        let tags = usize::from(pages[8]);
        pages[10 + 12 * tags..][..4].copy_from_slice(&(start + 8).to_le_bytes());
        for tag in more[10..10 + 12 * tags].chunks_exact_mut(12) {
            let value = u32::from_le_bytes(tag[8..].try_into().unwrap());
            let moved = match u16::from_le_bytes([tag[0], tag[1]]) {
                273 => value + start,
                258 => u32::from(bits),
                _ => value,
            };
            tag[8..].copy_from_slice(&moved.to_le_bytes());
        }
        let texture = read_back("t.tif", &[pages, more].concat()).unwrap_or_else(|e| panic!("{side} {bits}: {e}"));
        assert_eq!((texture.size(), texture.resident().0), ([4, 4], 1), "{side} {bits}");
    }
}

/// s and t span what is displayed, of which the data may be a part.
#[test]
fn the_data_of_an_exr_may_be_a_part_of_it() {
    use exr::prelude::*;
    let layer = Layer::new(
        (4, 2),
        LayerAttributes::default().with_position(Vec2(3, 1)),
        Encoding::UNCOMPRESSED,
        SpecificChannels::rgb(|at: Vec2<usize>| (0.1 * at.0 as f32, 0.5 + 0.1 * at.1 as f32, 1.0f32)),
    );
    let attributes = ImageAttributes::new(IntegerBounds::new((0, 0), (10, 5)));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.exr");
    Image::new(attributes, layer).write().to_file(&path).unwrap();
    let texture = velour::texture::read(&path, 1 << 30).unwrap();
    assert_eq!((texture.size(), texture.about().data), ([10, 5], Some([3, 1, 6, 2])));
    let at = |x: f32, y: f32| {
        let how = Lookup { interpolation: Interpolation::Closest, ..clamped() };
        texture.value((x + 0.5) / 10.0, (y + 0.5) / 5.0, [0.0; 4], &how)
    };
    assert_eq!((at(2.0, 1.0)[2], at(3.0, 0.0)[2], at(7.0, 1.0)[2]), (0.0, 0.0, 0.0));
    assert_eq!((at(3.0, 1.0)[..3].to_vec(), at(6.0, 2.0)[..3].to_vec()), (vec![0.0, 0.5, 1.0], vec![0.3, 0.6, 1.0]));
}

/// A host of one texture of any name.
struct Holding(Arc<Texture>);

impl Host for Holding {
    fn texture(&self, _name: &str) -> Result<Arc<Texture>, String> {
        Ok(self.0.clone())
    }
}

/// Look-ups of all lanes at once are those of each lane alone, which an option that varies asks for.
#[test]
fn batches_give_the_bits_of_single_look_ups() {
    let texture = Arc::new(painted(13, 9, 3, |s, t, c| s * t + 0.3 * c as f32 - 0.2 * s));
    let options = r#""wrap", "mirror", "firstchannel", first, "fill", .25, "alpha", a"#;
    let call = |width: &str| {
        format!(
            r#"shader s(int first = 0, output color c = 0, output float a = 0) {{
            float wide = {width};
            if (u > .2) c = texture("t", 3 * u - 1, 2 * v, .1 * u, .02, .01, .2 * v, "width", wide, {options}); }}"#
        )
    };
    for first in 0..4 {
        let answers = ["1", "1 + 0 * floor(u)"].map(|width| {
            let shader = compile(&call(width)).unwrap();
            let group = shader.group().bind("first", velour::ir::lower::Binding::Numbers(vec![f64::from(first)]));
            let group = group.unoptimized().keep_outputs().build().unwrap();
            let mut machine = Machine::with_host(Arc::new(Holding(texture.clone())));
            let mut points = Points::new(64);
            for lane in 0..64 {
                (points.u[lane], points.v[lane]) = (lane as f32 / 63.0, (lane * 29 % 64) as f32 / 63.0);
            }
            machine.shade(&group, &points);
            let of = |name: &str, lane: usize| format!("{:?}", machine.output(&group, name).unwrap().lane(lane));
            (0..64).map(|lane| of("c", lane) + &of("a", lane)).collect::<Vec<_>>()
        });
        assert_eq!(answers[0], answers[1], "{first}");
        assert!(answers[0][10] != answers[0][40], "{:?}", answers[0]);
    }
}

#[test]
fn blurred_texels_show_no_plaid() {
    // Bilinear texels have kinks at their middles, which the second difference finds.
    let texture = painted(64, 64, 1, |s, t, _| ((s * 64.0) as i32 * 37 % 17) as f32 / 16.0 + 0.3 * t);
    let kink = |interpolation: Interpolation| {
        let how = Lookup { interpolation, blur: [0.2; 2], ..clamped() };
        let values: Vec<f32> =
            (0..400).map(|i| texture.value(0.2 + i as f32 * 1.5e-3, 0.5, [2e-3, 0.0, 0.0, 2e-3], &how)[0]).collect();
        values.windows(3).map(|v| (v[0] - 2.0 * v[1] + v[2]).abs()).fold(0.0, f32::max)
    };
    let (smart, linear) = (kink(Interpolation::Smart), kink(Interpolation::Linear));
    assert!(smart < 0.2 * linear, "{smart} {linear}");
}

#[test]
fn an_ellipse_that_is_too_long_is_made_shorter_and_wider() {
    // Stripes a thirtieth as wide as the ellipse is long: wider alone would leave nothing of them, as the control at the limit has it.
    let texture = painted(256, 256, 1, |s, _, _| if (s * 128.0) as i32 % 2 == 0 { 1.0 } else { 0.0 });
    let of = |short: f32| contrast(&texture, [short, 0.0, 0.0, 0.5], &clamped());
    let limit = 0.5 / 32.0;
    assert!(of(1e-4) > 2.0 * of(limit), "{} {}", of(1e-4), of(limit));
}

/// What a shader of one statement prints that asks about a file.
fn told_of(file: &str, bytes: &[u8], body: &str) -> String {
    struct Files(velour::texture::TextureFiles);
    impl Host for Files {
        fn texture(&self, name: &str) -> Result<Arc<Texture>, String> {
            self.0.get(name).map_err(|error| error.to_string())
        }
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(file), bytes).unwrap();
    let host = Files(velour::texture::TextureFiles::new(vec![folder.path().to_owned()]));
    let group = compile(&format!("shader s() {{ {body} }}")).unwrap().group().build().unwrap();
    let mut machine = Machine::with_host(Arc::new(host));
    machine.shade(&group, &Points::single(velour::glam::Vec3::Z));
    machine.take_reports().iter().map(|report| format!("{report}|")).collect()
}

#[test]
fn a_file_says_when_it_was_made_and_what_color_it_has() {
    use tiff::encoder::{TiffEncoder, colortype::RGBA8};
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    let mut image = encoder.new_image::<RGBA8>(2, 1).unwrap();
    image.encoder().write_tag(tiff::tags::Tag::DateTime, "2026:11:29 12:00:00").unwrap();
    let words = "oiio:ConstantColor=0.25,0.5,0.75,0.5 oiio:AverageColor=0.125,0.5,0.75,0.5";
    image.encoder().write_tag(tiff::tags::Tag::ImageDescription, words).unwrap();
    image.write_data(&[64, 128, 192, 255, 64, 128, 192, 255]).unwrap();
    let bytes = bytes.into_inner();
    for (body, says) in [
        (r#"string d; printf("%d %s", gettextureinfo("a.tif", "DateTime", d), d);"#, "1 2026:11:29 12:00:00|"),
        (r#"color c; printf("%d %g", gettextureinfo("a.tif", "averagecolor", c), c);"#, "1 0.125 0.5 0.75|"),
        (r#"color c; printf("%d %g", gettextureinfo("a.tif", "constantcolor", c), c);"#, "1 0.25 0.5 0.75|"),
        (r#"float a; printf("%d %g", gettextureinfo("a.tif", "constantalpha", a), a);"#, "1 0.5|"),
        (r#"string d = "-"; printf("%d %s", gettextureinfo("a.tif", "Nothing", d), d);"#, "0 -|"),
    ] {
        assert_eq!(told_of("a.tif", &bytes, body), says, "{body}");
    }
    let gone = told_of("a.tif", &bytes, r#"int n; printf("%d", gettextureinfo("gone.tif", "channels", n));"#);
    assert!(gone.contains("gone.tif"), "{gone}");
    let gone = told_of("a.tif", &bytes, r#"int n; printf("%d", gettextureinfo("gone.tif", "exists", n));"#);
    assert_eq!(gone, "1|");
    // Of many tiles the one at the place, or any where no place is given.
    for (place, says) in [("", "1 2|"), (".5, .5,", "1 2|"), ("1.5, .5,", "0 0|")] {
        let body = format!(
            r#"int r[2]; int ok = gettextureinfo("a.<UDIM>.tif", {place} "resolution", r); printf("%d %d", ok, r[0]);"#
        );
        assert_eq!(told_of("a.1001.tif", &bytes, &body), says, "{place}");
    }
}
