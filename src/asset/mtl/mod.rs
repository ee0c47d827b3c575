//! Material libraries of OBJ files, parsed by `tobj` statement by statement as far as each can be read.

mod bump;
mod convert;
mod map_statement;
mod metallic_roughness;
mod names;
mod screened;

use std::collections::{HashMap, HashSet};
use std::io::Cursor;
use std::path::{Path, PathBuf};

use super::files::Files;
use super::notes::Notes;
use super::textures::TextureTable;
use crate::shade::{Material, Texture};
use convert::{Converter, MadePictures};
use map_statement::MapStatement;
use names::{find, library_names, without_comment};
use screened::Screened;

/// The materials of all libraries of a file.
#[derive(Default)]
pub(super) struct Libraries {
    /// The nearest materials that the tracer has.
    pub materials: Vec<Material>,
    /// Features approximated or ignored, one line each.
    pub warnings: Vec<String>,
    /// Index of each material, by its name; the last one of several.
    names: HashMap<String, usize>,
    /// Index of each material, by its name without what may be a comment; the first one of several.
    short_names: HashMap<String, usize>,
    /// Libraries that were read.
    read: HashSet<PathBuf>,
    pictures: TextureTable<PathBuf>,
    made: MadePictures,
}

impl Libraries {
    /// Reads the libraries that a `mtllib` statement names; one that cannot be read goes to `notes`.
    pub fn read(&mut self, names: &str, folder: &Path, files: &Files, notes: &mut Notes) {
        if names.is_empty() {
            notes.add("material libraries that cannot be read are left out", "`mtllib` without a name");
        }
        for name in library_names(names, folder) {
            let path = find(folder, name);
            // One file may have many names.
            if !self.read.insert(std::fs::canonicalize(&path).unwrap_or_else(|_| path.clone())) {
                continue;
            }
            if let Err(error) = self.read_file(&path, files) {
                notes.add("material libraries that cannot be read are left out", format!("{name} ({error})"));
            }
        }
    }

    /// Takes the materials, and the textures that their maps number.
    pub fn take(&mut self) -> (Vec<Material>, Vec<Texture>) {
        (std::mem::take(&mut self.materials), std::mem::take(&mut self.pictures).into_textures())
    }

    /// True if a material has textures.
    pub fn has_textures(&self) -> bool {
        self.materials.iter().any(|material| material.textures().next().is_some())
    }

    /// The material of a name.
    pub fn find(&self, name: &str) -> Option<usize> {
        let short = without_comment(name);
        let found = self.names.get(name).or_else(|| self.short_names.get(name));
        found.or_else(|| self.names.get(short)).copied()
    }

    fn read_file(&mut self, path: &Path, files: &Files) -> std::io::Result<()> {
        let bytes = files.read(path)?;
        let mut notes = Notes::default();
        let library = Screened::read(&bytes, &mut notes)?;
        let (parsed, _) =
            tobj::load_mtl_buf(&mut Cursor::new(library.text)).map_err(std::io::Error::other)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        library.unread.iter().for_each(|map| files.mention(&folder.join(MapStatement::of(map).name)));
        for (material, name) in parsed.iter().zip(library.names) {
            let mut converter = Converter {
                name: &name,
                is_of_blender: library.is_of_blender,
                folder,
                files,
                pictures: &mut self.pictures,
                made: &mut self.made,
                notes: &mut notes,
            };
            let material = converter.convert(material);
            let index = self.materials.len();
            self.materials.push(material);
            self.short_names.entry(without_comment(&name).to_owned()).or_insert(index);
            if self.names.insert(name.clone(), index).is_some() {
                notes.add("materials that are defined again: the last definition counts", name);
            }
        }
        self.warnings.extend(notes.into_lines(&path.display().to_string()));
        Ok(())
    }
}

#[cfg(test)]
mod tests;
