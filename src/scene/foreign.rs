//! Files that are no scenes here, by extension, and how a scene is made of them.

use std::path::Path;

const BLENDER: &str =
    "open it in Blender, choose File › Export › glTF 2.0, format glTF Binary (.glb), and give that";
const IMPORT: &str = "import it in Blender (File › Import, or drop it into the window; some formats need an extension), \
                      choose File › Export › glTF 2.0 (.glb), and give that";
const PICTURE: &str = "a scene is a .toml, .gltf, .glb or .obj file; a picture can be the sky of one, \
                       `[environment] image = ...`, and two are compared with `warpfront compare`";
const DESCRIPTION: &str =
    "export the geometry as glTF (.glb) or OBJ and write a scene file (.toml) that names it";
const ARCHIVE: &str = "unpack it, and give the .toml, .gltf, .glb or .obj file";

/// Extensions of known files, their kind, and what to do with them.
const KNOWN: &[(&str, &str, &str)] = &[
    ("blend blend1 blend2", "a Blender file", BLENDER),
    ("fbx", "an FBX file", IMPORT),
    ("usd usda usdc usdz", "a USD file", IMPORT),
    ("dae", "a COLLADA file", IMPORT),
    ("stl", "an STL file", IMPORT),
    ("ply", "a PLY file", IMPORT),
    ("abc", "an Alembic file", IMPORT),
    ("3ds", "a 3DS file", IMPORT),
    ("x3d wrl", "an X3D or VRML file", IMPORT),
    ("vrm", "a VRM file", "it is glTF Binary: rename it to .glb"),
    (
        "max",
        "a 3ds Max file",
        "in 3ds Max choose File › Export › glTF (.glb), or export FBX and turn that into glTF in Blender",
    ),
    ("ma mb", "a Maya file", "export FBX or USD from Maya and turn that into glTF (.glb) in Blender"),
    ("c4d", "a Cinema 4D file", "in Cinema 4D choose File › Export › glTF (.glb)"),
    ("hip hipnc hiplc", "a Houdini file", "export glTF (.glb) with Houdini's glTF ROP"),
    ("skp", "a SketchUp file", "in SketchUp choose File › Export › 3D Model, glTF Binary (.glb)"),
    ("lwo lws", "a LightWave file", "export FBX from LightWave and turn that into glTF (.glb) in Blender"),
    ("ztl zpr", "a ZBrush file", "export OBJ from ZBrush"),
    ("step stp iges igs", "a CAD file", "export it from the CAD program as glTF (.glb) or OBJ"),
    ("3dm", "a Rhino file", "in Rhino choose File › Export, glTF Binary (.glb)"),
    ("pbrt", "a scene of pbrt", DESCRIPTION),
    ("xml", "an XML file, such as Mitsuba's scenes", DESCRIPTION),
    ("txt", "a text file", "if it is a scene file or a model, end its name in .toml, .gltf, .glb or .obj"),
    ("mtl", "a material library", "give the .obj file that names it"),
    ("bin", "a buffer of a glTF file", "give the .gltf file that names it"),
    ("exr hdr png jpg jpeg tif tiff webp bmp gif", "a picture", PICTURE),
    ("zip gz tgz tar 7z rar xz zst", "an archive", ARCHIVE),
];

/// Kind of the file at `path` if it is known, and how to make a scene of it.
pub(super) fn known(path: &Path) -> Option<(&'static str, &'static str)> {
    let extension = path.extension()?.to_str()?.to_lowercase();
    let (_, what, remedy) =
        KNOWN.iter().find(|(names, ..)| names.split(' ').any(|name| name == extension))?;
    Some((what, remedy))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_are_known_in_capitals_too() {
        let (what, remedy) = known(Path::new("a/ROOM.Blend")).unwrap();
        assert!(what.contains("Blender") && remedy.contains("glTF"));
        assert_eq!(known(Path::new("room.toml")), None);
        assert_eq!(known(Path::new("blend")), None);
    }
}
