//! Shaders kept in the binary, so that a scene finds them wherever velour is installed.

/// File name and text of each, in the order of their names; a file of the same name in a scene's folders wins.
pub const SHIPPED: [(&str, &str); 9] = [
    ("cloth.osl", include_str!("../../shaders/cloth.osl")),
    ("curtain.osl", include_str!("../../shaders/curtain.osl")),
    ("emitter.osl", include_str!("../../shaders/emitter.osl")),
    ("layers.osl", include_str!("../../shaders/layers.osl")),
    ("matte.osl", include_str!("../../shaders/matte.osl")),
    ("models.osl", include_str!("../../shaders/models.osl")),
    ("sky.osl", include_str!("../../shaders/sky.osl")),
    ("velvet.osl", include_str!("../../shaders/velvet.osl")),
    ("weave.osl", include_str!("../../shaders/weave.osl")),
];

/// File name and text of a shader that is asked for by its bare name: `cloth`, `cloth.osl` or `cloth.oso`.
pub(super) fn shipped(name: &str) -> Option<(&'static str, &'static str)> {
    let name = name.strip_suffix(".osl").or(name.strip_suffix(".oso")).unwrap_or(name);
    SHIPPED.into_iter().find(|(file, _)| file.strip_suffix(".osl") == Some(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn every_shader_of_the_folder_is_shipped() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
        let mut names: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|path| path.extension().is_some_and(|e| e == "osl"))
            .map(|path| path.file_name().unwrap().to_string_lossy().into_owned())
            .filter(|name| name != "stdosl.osl")
            .collect();
        names.sort();
        assert_eq!(names, SHIPPED.map(|(name, _)| name));
        assert_eq!(shipped("cloth.osl"), shipped("cloth"));
        assert_eq!(shipped("../cloth"), None);
    }
}
