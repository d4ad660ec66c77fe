//! Shaders and scenes kept in the binary, so that they are found wherever velour is installed.

/// What goes before the name of a shader that must be the binary's own.
pub(super) const BINARY: &str = "velour:";

/// File name and text of each, in the order of their names; a file of the same name in a scene's folders wins.
pub const SHIPPED: [(&str, &str); 12] = [
    ("cloth.osl", include_str!("../../shaders/cloth.osl")),
    ("curtain.osl", include_str!("../../shaders/curtain.osl")),
    ("emitter.osl", include_str!("../../shaders/emitter.osl")),
    ("envmap.osl", include_str!("../../shaders/envmap.osl")),
    ("form.osl", include_str!("../../shaders/form.osl")),
    ("layers.osl", include_str!("../../shaders/layers.osl")),
    ("matte.osl", include_str!("../../shaders/matte.osl")),
    ("models.osl", include_str!("../../shaders/models.osl")),
    ("shown.osl", include_str!("../../shaders/shown.osl")),
    ("sky.osl", include_str!("../../shaders/sky.osl")),
    ("velvet.osl", include_str!("../../shaders/velvet.osl")),
    ("weave.osl", include_str!("../../shaders/weave.osl")),
];

/// File name and text of each scene; a file of the same name goes before it.
pub const SHIPPED_SCENES: [(&str, &str); 11] = [
    ("curtain.xml", include_str!("../../shaders/scenes/curtain.xml")),
    ("figure1.xml", include_str!("../../shaders/scenes/figure1.xml")),
    ("figure3-back.xml", include_str!("../../shaders/scenes/figure3-back.xml")),
    ("figure3.xml", include_str!("../../shaders/scenes/figure3.xml")),
    ("figure4.xml", include_str!("../../shaders/scenes/figure4.xml")),
    ("lamps.xml", include_str!("../../shaders/scenes/lamps.xml")),
    ("layers.xml", include_str!("../../shaders/scenes/layers.xml")),
    ("million.xml", include_str!("../../shaders/scenes/million.xml")),
    ("models.xml", include_str!("../../shaders/scenes/models.xml")),
    ("spheres.xml", include_str!("../../shaders/scenes/spheres.xml")),
    ("still.xml", include_str!("../../shaders/scenes/still.xml")),
];

/// File name and text of a scene that is asked for by its bare name: `figure1` or `figure1.xml`.
pub(super) fn shipped_scene(name: &str) -> Option<(&'static str, String)> {
    let (file, text) = scene_of(name)?;
    // In their folder, their shaders are one above; in the binary, they are beside.
    Some((file, text.replace("shader ../", "shader ")))
}

/// Is there a scene of this bare name in the binary?
pub(super) fn is_shipped_scene(name: &str) -> bool {
    scene_of(name).is_some()
}

fn scene_of(name: &str) -> Option<(&'static str, &'static str)> {
    let name = name.strip_suffix(".xml").unwrap_or(name);
    SHIPPED_SCENES.into_iter().find(|(file, _)| file.strip_suffix(".xml") == Some(name))
}

/// Is there a shader of this name in the binary?
pub fn is_shipped_shader(name: &str) -> bool {
    shipped_shader(name).is_some()
}

/// File name and text of a shader that is asked for by its bare name or by `velour:NAME`.
pub fn shipped_shader(name: &str) -> Option<(&'static str, &'static str)> {
    shipped(name.strip_prefix(BINARY).unwrap_or(name))
}

/// File name and text of a shader that is asked for by its bare name: `cloth`, `cloth.osl` or `cloth.oso`.
pub(super) fn shipped(name: &str) -> Option<(&'static str, &'static str)> {
    let name = name.strip_suffix(".osl").or(name.strip_suffix(".oso")).unwrap_or(name);
    SHIPPED.into_iter().find(|(file, _)| file.strip_suffix(".osl") == Some(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn names(folder: &str, extension: &str) -> Vec<String> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        let mut names: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|path| path.extension().is_some_and(|e| e == extension))
            .map(|path| path.file_name().unwrap().to_string_lossy().into_owned())
            .filter(|name| name != "stdosl.osl")
            .collect();
        names.sort();
        names
    }

    #[test]
    fn what_is_in_the_folders_is_shipped() {
        assert_eq!(names("shaders", "osl"), SHIPPED.map(|(name, _)| name));
        assert_eq!(names("shaders/scenes", "xml"), SHIPPED_SCENES.map(|(name, _)| name));
        assert!(SHIPPED_SCENES.iter().all(|(name, _)| !shipped_scene(name).unwrap().1.contains("../")));
        assert_eq!(shipped("cloth.osl"), shipped("cloth"));
        assert_eq!(shipped("../cloth"), None);
    }
}
