//! Textures of many files, a unit square of s and t each.

/// The marks in a file's name that stand for a tile.
const MARKS: [&str; 6] = ["<UDIM>", "%(UDIM)d", "<u>", "<v>", "<U>", "<V>"];

/// Does a name stand for a file a tile?
pub fn is_tiled(name: &str) -> bool {
    MARKS.iter().any(|mark| name.contains(mark)) || name.contains("<uvtile>")
}

/// The file of the tile that (s, t) is in: `<UDIM>` is 1001 + u + 10 v with u and v whole parts of s and t, `<u>` and `<v>` are `u` and `v` with
/// these, `<U>` and `<V>` the same from 1 on. Nothing for tiles that have no number.
pub fn tile_name(name: &str, s: f32, t: f32) -> Option<String> {
    let tile = |x: f32| (0.0..1000.0).contains(&x).then_some(x as u32);
    let (u, v) = (tile(s)?, tile(t)?);
    let number = (1001 + u + 10 * v).to_string();
    if u > 9 && (name.contains("UDIM") || name.contains("uvtile")) {
        return None;
    }
    let name = name.replace("<UDIM>", &number).replace("%(UDIM)d", &number);
    let name = name.replace("<u>", &format!("u{u}")).replace("<v>", &format!("v{v}"));
    let name = name.replace("<U>", &format!("u{}", u + 1)).replace("<V>", &format!("v{}", v + 1));
    Some(name.replace("<uvtile>", &format!("u{}_v{}", u + 1, v + 1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_have_their_numbers() {
        assert_eq!(tile_name("a.<UDIM>.exr", 0.5, 0.5).as_deref(), Some("a.1001.exr"));
        assert_eq!(tile_name("a.<UDIM>.exr", 2.5, 1.0).as_deref(), Some("a.1013.exr"));
        assert_eq!(tile_name("a_<u>_<v>.png", 3.0, 12.0).as_deref(), Some("a_u3_v12.png"));
        assert_eq!(tile_name("a_<U>_<V>.png", 3.0, 12.0).as_deref(), Some("a_u4_v13.png"));
        assert_eq!(tile_name("a.<UDIM>.exr", 10.5, 0.5), None);
        assert_eq!(tile_name("a.<UDIM>.exr", -0.5, 0.5), None);
        assert!(is_tiled("x<UDIM>.tx") && !is_tiled("x.tx"));
    }
}
