//! Statements of a library that can be read.

use std::collections::HashSet;
use std::fmt::Write;

use crate::asset::notes::Notes;
use crate::asset::statements::{Statement, Statements};
use crate::text;

/// Statements that name pictures, beside those that begin with `map_`.
const PICTURES: [&str; 3] = ["disp", "decal", "refl"];

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
/// Beginning of a library that Blender wrote.
const BLENDER: &[u8] = b"# Blender";

/// The statements of a library that `tobj` can read (it refuses the whole library, or panics, at others), each
/// material named by its number.
#[derive(Default)]
pub struct Screened {
    /// Text for `tobj`.
    pub text: String,
    /// The materials' own names.
    pub names: Vec<String>,
    /// True if Blender wrote the library.
    pub is_of_blender: bool,
    /// Values of statements of pictures that are not read.
    pub unread: HashSet<String>,
}

impl Screened {
    pub fn read(bytes: &[u8], notes: &mut Notes) -> std::io::Result<Self> {
        let text = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
        let mut screened = Self { is_of_blender: text.starts_with(BLENDER), ..Self::default() };
        let mut statements = Statements::new(bytes);
        while let Some(statement) = statements.next()? {
            screened.add(&statement, notes);
        }
        Ok(screened)
    }

    fn add(&mut self, statement: &Statement, notes: &mut Notes) {
        let Statement { line, keyword, name } = *statement;
        if keyword == "newmtl" {
            if name.is_empty() {
                notes.add("materials without a name cannot be used, in line", line.to_string());
            }
            let _ = writeln!(self.text, "newmtl {}", self.names.len());
            self.names.push(name.to_owned());
            return;
        }
        let Some(material) = self.names.last() else {
            notes.add("statements before the first `newmtl` are left out, in line", line.to_string());
            return;
        };
        let is_nothing = || statement.values().parse() == Ok(0.0);
        let keyword = canonical(keyword, self.is_of_blender);
        let values = match keyword {
            "aniso" | "anisor" if is_nothing() => return,
            "Tf" if self.is_of_blender => first::<f32>(statement.values()),
            "Ka" | "Kd" | "Ks" | "Ke" => colour(statement.values()),
            "Ns" | "Ni" | "d" | "Pr" | "Pm" | "Ps" | "Pc" | "Pcr" => first::<f32>(statement.values()),
            "illum" => first::<u8>(statement.values()),
            "map_Kd" | "map_Ke" | "map_d" | "map_Pr" | "map_Pm" | "map_Bump" | "norm" => picture(name),
            "map_Ks" if self.is_of_blender => picture(name),
            _ => {
                if keyword.starts_with("map_") || PICTURES.contains(&keyword) {
                    self.unread.insert(name.to_owned());
                }
                notes.add(format!("`{}` is ignored, in material", text::quoted(keyword)), material);
                return;
            }
        };
        match values {
            Some(values) => {
                // Writing to a string cannot fail.
                let _ = writeln!(self.text, "{keyword} {values}");
            }
            None => {
                let kind = "statements that cannot be read are left out, in line";
                let text = format!("{} {name}", statement.keyword);
                notes.add(kind, format!("{line}: `{}`", text.trim_end()));
            }
        }
    }
}

/// One keyword for those that mean the same. Blender writes pictures of its own roughness and metal, unless it is asked for
/// the statements that others have for them, as if they were of shininess and of reflections.
fn canonical(keyword: &str, is_of_blender: bool) -> &str {
    match keyword {
        "map_bump" | "bump" => "map_Bump",
        "map_norm" | "map_Norm" => "norm",
        "map_Ns" if is_of_blender => "map_Pr",
        "map_refl" if is_of_blender => "map_Pm",
        other => other,
    }
}

/// Three numbers; one means grey, spectral and CIE XYZ colours are none.
fn colour(values: &str) -> Option<String> {
    let numbers: Vec<&str> =
        values.split_whitespace().take_while(|word| word.parse::<f32>().is_ok()).take(3).collect();
    match numbers.as_slice() {
        [grey] if values.split_whitespace().nth(1).is_none() => Some(format!("{grey} {grey} {grey}")),
        [_, _, _] => Some(numbers.join(" ")),
        _ => None,
    }
}

/// The name of a picture, if there is one.
fn picture(name: &str) -> Option<String> {
    Some(name.to_owned()).filter(|name| !name.is_empty())
}

/// The first word, if it is a number of this type.
fn first<T: std::str::FromStr>(values: &str) -> Option<String> {
    let word = values.split_whitespace().next()?;
    word.parse::<T>().is_ok().then(|| word.to_owned())
}
